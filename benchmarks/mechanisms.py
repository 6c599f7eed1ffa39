"""The mechanisms that the ablation switches off: by settings, or by what takes the place of a name in the core."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from nestedcages_core import (
    IPC,
    ArcLength,
    LineCycles,
    OuterHull,
    SequentialQP,
    Settings,
    Tightening,
    TwoSidedFlow,
)


@dataclass(frozen=True)
class Around:
    """What takes the place of a function, made from it."""

    make: Callable[[Any], Any]


@dataclass(frozen=True)
class Mechanism:
    """What is done without it."""

    room: str
    """Where it is."""
    settings: Callable[[], Settings] = Settings
    """The choices of a run without it."""
    patches: Mapping[str, Any] = field(default_factory=dict)
    """"module:name" or "module:Class.name" in the core, and what takes its place."""


def first(given: Any, *_: Any, **__: Any) -> Any:
    """What came in, unchanged."""
    return given


def nothing(*_: Any, **__: Any) -> None:
    """No result."""


def no_stage(*_: Any, **__: Any) -> Iterator[Any]:
    """A stage that finds nothing."""
    return
    yield


def all_kept(pairs: Any, *_: Any, **__: Any) -> Any:
    """Every pair of a mask."""
    return np.ones(len(pairs), bool)


def with_contacts(*contacts: Any) -> Callable[[], Settings]:
    """The defaults with these contacts in turn."""
    return lambda: Settings(contact=contacts)


MECHANISMS: dict[str, Mechanism] = {
    # where cages begin
    "the hull as fallback": Mechanism("hierarchy", partial(Settings, fallback=None)),
    "untightened cage as last resort": Mechanism(
        "hierarchy",
        patches={"level.assembly:Assembly.untightened": no_stage},
    ),
    "line cycles (places by arc length)": Mechanism("decimation", partial(Settings, decimation=ArcLength())),
    "line cycles (outer hull)": Mechanism("decimation", partial(Settings, decimation=OuterHull())),
    "the curve": Mechanism("decimation", partial(Settings, decimation=LineCycles(on_curve=False))),
    "line cycles: searches through other lines": Mechanism(
        "decimation",
        patches={
            "decimation.line_cycles.loop_search:MAX_ACROSS": 0,
            "decimation.line_cycles.loop_search:MAX_MORE": 0,
        },
    ),
    "line cycles: ways to clear crossings (3 to 1)": Mechanism(
        "decimation", patches={"decimation.line_cycles.method:BIASES": (1.0,)}
    ),
    "line cycles: places (3 to 2 per vertex)": Mechanism(
        "decimation", patches={"decimation.line_cycles.around:PLACES_PER_VERTEX": 2.0}
    ),
    "clearing": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_search:cleared": first},
    ),
    "clearing: small details built over": Mechanism(
        "decimation",
        patches={"decimation.hull.offset:without_small_details": first},
    ),
    "clearing: narrow gaps filled": Mechanism(
        "decimation",
        patches={"decimation.hull.offset:without": first},
    ),
    "filling of gaps like round-off": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_search:without_gaps": first},
    ),
    "details like round-off built over": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_search:without_small_details": first},
    ),
    "room in small holes": Mechanism(
        "decimation",
        patches={"decimation.hull.small_holes:with_room": first},
    ),
    # flow
    "flow: steps with samples at vertices (6 to 1)": Mechanism(
        "flow", partial(Settings, flow=TwoSidedFlow(vertex_limit=1))
    ),
    # contact
    "sequential QPs first (IPC first)": Mechanism("contact", with_contacts(IPC(), SequentialQP())),
    "sequential QPs (IPC only)": Mechanism("contact", with_contacts(IPC())),
    "IPC behind sequential QPs": Mechanism("contact", with_contacts(SequentialQP())),
    "IPC: stiffening": Mechanism("contact", patches={"contact.ipc:MOST_ROUNDS": 0}),
    "pruning of implied constraints": Mechanism(
        "contact",
        patches={"contact.contact_response:not_implied": all_kept, "tightening.quadratic_model:not_implied": all_kept},
    ),
    # tightening
    "escapes from saddles": Mechanism("tightening", patches={"tightening.tightening:negative_curvature": nothing}),
    "widening in small steps": Mechanism(
        "tightening",
        patches={"tightening.reach_clearance:MOST_STEPS": 0},
    ),
    "trials of shortened steps (3 to 1)": Mechanism("tightening", patches={"tightening.trust_region:MAX_ATTEMPTS": 1}),
    "overshoot of restoration": Mechanism(
        "tightening",
        patches={"tightening.reach_clearance:OVERSHOOT": 1.0},
    ),
    "trials, patience and overshoot together": Mechanism(
        "tightening",
        partial(Settings, tightening=Tightening(patience=1)),
        patches={
            "tightening.trust_region:MAX_ATTEMPTS": 1,
            "tightening.reach_clearance:OVERSHOOT": 1.0,
        },
    ),
    "patience (3 quiet steps to 1)": Mechanism("tightening", partial(Settings, tightening=Tightening(patience=1))),
}
"""Name and what is done without it; "(a to b)" where it is not all or nothing."""
