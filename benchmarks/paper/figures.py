"""Our drawings of figures 1 to 5 by the paper's method as written and repaired, by others, and by ours."""

from __future__ import annotations

import numpy as np

from common import Options, table
from nestedcages_core import FlowError, Mesh, as_published, verify
from paper.methods import DESCENT, SIMPLE_2022, WHOLE, figures, measured, of_2022


def written(fine: Mesh, coarse: Mesh) -> str:
    """The method as written, which never returns exactly: the fine mesh ends so many diagonals short."""
    try:
        result = as_published(fine, coarse)
    except FlowError:
        return "flow"
    if not np.isfinite(result.cage.vertices).all():
        return "infinite"
    short = f"{result.short / fine.diagonal:.0e} short"
    certificate = verify(result.cage, fine, 0.0, same_loops=False)
    return f"{100.0 * certificate.excess:.1f} %, {short}" if certificate.holds else f"does not enclose, {short}"


def run(options: Options) -> str:
    drawn = dict(list(figures().items())[: 2 if options.quick else None])
    rows = []
    if not options.quick:
        rows.append(("2022 as written", *(written(*pair) for pair in drawn.values())))
    methods = {**WHOLE} if options.quick else {"2022 repaired": of_2022(DESCENT), **WHOLE}
    for name, settings in methods.items():
        rows.append((name, *(told(settings, *pair) for pair in drawn.values())))
    simple = (told(SIMPLE_2022, fine, len(coarse.vertices)) for fine, coarse in drawn.values())
    rows.append(("simple cages 2022", *simple))
    return f"Excess and CPU seconds, or the stage that fails\n{table(('method', *drawn), rows)}"


def told(settings: object, fine: Mesh, coarse: Mesh | int) -> str:
    one = measured(settings, fine, coarse, 30.0)
    return f"fails: {one.failed}" if one.failed else f"{one.excess:.1f} %, {one.seconds:.2f} s"
