"""The certificates of a cage and of the motion towards it. All verdicts but the distance are exact.

- `verify`: the `Certificate` of a cage around a fine mesh.
- `LostLoops`: holes that a cage fills, and loops that share one.
- `verify_motion`: the `MotionCertificate` of linear motion between steps.
"""

from .certificate import Certificate, verify
from .lost_loops import LostLoops
from .motion import MotionCertificate, verify_motion

__all__ = ["Certificate", "LostLoops", "MotionCertificate", "verify", "verify_motion"]
