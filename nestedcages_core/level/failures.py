"""Why the cage of a level was rejected."""

from __future__ import annotations

from ..errors import Fault
from .plan import Plan
from .report import JudgedCage
from .tightest_place import too_narrow


def failed(cage: JudgedCage, plan: Plan, wanted: float) -> Fault:
    """Why a cage was rejected; wanted: the first clearance asked for."""
    certificate = cage.certificate
    if certificate.holds and cage.fault is not None:
        return cage.fault
    if not cage.is_only_too_close:
        said = "The cage could not be certified: "
        if plan.side < 0:
            said = (
                "The inner cage could not be certified; in the words of verify(fine, cage), which takes the fine mesh "
                "for the cage: "
            )
        return Fault(said + " ".join(certificate.problems), "certificate.failed", problems=certificate.problems)
    return (None if plan.side < 0 else too_narrow(plan.fine, wanted)) or Fault(
        f"No {'inner ' * (plan.side < 0)}cage with this few vertices was found that keeps the clearance of "
        f"{wanted:.6g}: the best one comes as close as {certificate.clearance:.6g}; ask for less clearance or "
        "use more vertices.",
        "clearance.no_room",
        wanted=wanted,
        largest=certificate.clearance,
    )
