"""The certificates, the only judges of a cage and of the motion towards it; exact in every verdict but the distance.

- `verify`: the `Certificate` of a cage around a fine mesh.
- `verify_motion`: the `MotionCertificate` of linear motion between steps.
"""

from __future__ import annotations

from .certificate import Certificate, verify
from .motion import MotionCertificate, verify_motion

__all__ = ["Certificate", "MotionCertificate", "verify", "verify_motion"]
