"""Loops too small to be seen, which would cost vertices: parts are left out, holes filled."""

from __future__ import annotations

import numpy as np

from ..geometry.mesh import Mesh

DISPLAYED = 1024
"""Pixels along a drawing that is displayed large: less than a pixel there is not seen."""


def without_specks(mesh: Mesh, least: float) -> tuple[Mesh, list[str]]:
    """A mesh without the loops whose area is below the least, and what lies in them; and that in words.

    The largest loop stays.
    """
    areas = np.abs(mesh.loop_areas)
    small = areas < min(least, float(areas.max()))
    if not small.any():
        return mesh, []
    gone = small.copy()
    for loop in np.argsort(-areas).tolist():  # those around others first
        around = int(mesh.parent_of_loop[loop])
        gone[loop] |= around >= 0 and gone[around]
    parts, holes = (int((small & (mesh.loop_signs == sign)).sum()) for sign in (1, -1))
    counted = ((parts, "part", "left out"), (holes, "hole", "filled"))
    words = [f"{number} {what}{'s' if number > 1 else ''} {done}" for number, what, done in counted if number]
    kept = [ring for ring, is_gone in zip(mesh.rings, gone.tolist(), strict=True) if not is_gone]
    return Mesh.from_loops(kept), [f"smaller than {least:.3g} in area: {', '.join(words)}"]
