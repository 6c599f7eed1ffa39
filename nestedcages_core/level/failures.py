"""Why the cage of a level was rejected."""

from __future__ import annotations

from ..errors import Fault
from ..verification import Certificate
from .assembly import is_only_too_close
from .plan import Plan
from .tightest_place import too_narrow


def failed(certificate: Certificate, plan: Plan, tried: float, wanted: float) -> Fault:
    """Why a cage was rejected; tried: the last clearance asked for."""
    if not is_only_too_close(certificate, tried):
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


def collides(step: int, plan: Plan) -> Fault:
    """Why a motion was rejected after a step."""
    return Fault(
        f"The motion from step {step} to the next could not be certified free of collisions; "
        f"use more cage vertices{'' if plan.side < 0 else ', or a coarse mesh closer to the fine one'}.",
        "motion.collides",
        step=step,
    )
