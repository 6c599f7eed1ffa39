"""The certificate: the only judge of a cage, exact in every verdict but the distance."""

from __future__ import annotations

from .certificate import Certificate, verify

__all__ = ["Certificate", "verify"]
