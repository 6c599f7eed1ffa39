"""The certificates: the only judges of a cage and of the way to it, exact in every verdict but the distance."""

from __future__ import annotations

from .certificate import Certificate, verify
from .motion import MotionCertificate, verify_motion

__all__ = ["Certificate", "MotionCertificate", "verify", "verify_motion"]
