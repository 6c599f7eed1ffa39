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
    NestingError,
    OnCurve,
    OuterHull,
    SequentialQP,
    Settings,
    Tightening,
    TwoSidedFlow,
)
from nestedcages_core.decimation.hull.hull_search import RESTART_WEIGHTS
from nestedcages_core.level.attempts import MAX_IPC_PAIRS


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


def counts_kept(hulls: Callable[..., Any]) -> Callable[..., Any]:
    """The hulls with the counts per loop that were asked for, or none."""

    def kept(self: Any, *arguments: Any) -> Any:
        return self._best(*arguments)

    return kept


def no_hulls(*_: Any, **__: Any) -> Iterator[Any]:
    """A search that finds nothing."""
    return []
    yield


def no_stage(*_: Any, **__: Any) -> Iterator[Any]:
    """A stage that finds nothing."""
    return
    yield


def no_level(*_: Any, **__: Any) -> Iterator[Any]:
    """A stage that fails."""
    raise NestingError("It is switched off.")
    yield


def all_kept(pairs: Any, *_: Any, **__: Any) -> Any:
    """Every pair of a mask."""
    return np.ones(len(pairs), bool)


def hulls(restarts: int) -> Callable[[], Settings]:
    """The defaults with so many restarts of the outer hull."""

    def settings() -> Settings:
        hull = OuterHull(restarts=restarts)
        return Settings(decimation=OnCurve(hull), fallback=hull)

    return settings


def with_contacts(*contacts: Any) -> Callable[[], Settings]:
    """The defaults with these contacts in turn."""
    return lambda: Settings(contact=contacts)


MECHANISMS: dict[str, Mechanism] = {
    # where cages begin
    "second start": Mechanism("hierarchy", partial(Settings, starts=1)),
    "second start (2 to 3)": Mechanism("hierarchy", partial(Settings, starts=3)),
    "early stop of losing starts": Mechanism("hierarchy", patches={"level.early_stop:FIRST_LOOK": 10**9}),
    "the hull as fallback": Mechanism("hierarchy", partial(Settings, fallback=None)),
    "untightened cage as last resort": Mechanism(
        "hierarchy",
        patches={"level.builder:LevelBuilder._untightened": no_level},
    ),
    "places on the curve by the hull": Mechanism("decimation", partial(Settings, decimation=ArcLength())),
    "the curve: outer hull alone": Mechanism("decimation", partial(Settings, decimation=OuterHull())),
    "restarts (3 to 1)": Mechanism("decimation", hulls(1)),
    "restarts (3 to 6)": Mechanism("decimation", hulls(6)),
    "endings (5 to 1)": Mechanism(
        "decimation", patches={"decimation.hull.hull_search:ENDING_WEIGHTS": RESTART_WEIGHTS[:1]}
    ),
    "endings (5 to 3)": Mechanism(
        "decimation", patches={"decimation.hull.hull_search:ENDING_WEIGHTS": RESTART_WEIGHTS[:3]}
    ),
    "further restarts for loops": Mechanism(
        "decimation",
        patches={"decimation.hull.hull_search:EXTRA_RESTARTS_PER_LOOP": 0},
    ),
    "rescues": Mechanism(
        "decimation",
        patches={"decimation.hull.hull_search:_rescues": no_hulls},
    ),
    "early end of hopeless hull searches": Mechanism(
        "decimation",
        patches={"decimation.hull.hull_search:HOPELESS_NUMBER": 10**9},
    ),
    "counts shared out again": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_hull:OuterHull.hulls": Around(counts_kept)},
    ),
    "clearing": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_search:cleared": first},
    ),
    "clearing: small details built over": Mechanism(
        "decimation",
        patches={"decimation.hull.clearing:without_small_details": first},
    ),
    "clearing: narrow gaps filled": Mechanism(
        "decimation",
        patches={"decimation.hull.clearing:_without": first},
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
        patches={"decimation.request:with_room": first},
    ),
    # flow
    "flow: steps with samples at vertices (6 to 1)": Mechanism(
        "flow", partial(Settings, flow=TwoSidedFlow(vertex_limit=1))
    ),
    "flow: erosion": Mechanism(
        "flow",
        patches={"flow.two_sided:_Run.erosion": no_stage},
    ),
    "flow: geodesic": Mechanism(
        "flow",
        patches={"flow.two_sided:_Run.geodesic": no_stage},
    ),
    # contact
    "sequential QPs first (IPC first)": Mechanism(
        "contact", with_contacts(IPC(max_pairs=MAX_IPC_PAIRS), SequentialQP())
    ),
    "sequential QPs (IPC only)": Mechanism("contact", with_contacts(IPC())),
    "IPC behind sequential QPs": Mechanism("contact", with_contacts(SequentialQP())),
    "IPC ends in crowds": Mechanism("contact", patches={"level.attempts:MAX_IPC_PAIRS": np.inf}),
    "IPC: stiffening": Mechanism("contact", patches={"contact.ipc:MAX_STIFFENINGS": 0}),
    "IPC: shorter ranges": Mechanism(
        "contact",
        patches={"contact.ipc:MAX_RANGE_REDUCTIONS": 0},
    ),
    "QP: pace per vertex": Mechanism(
        "contact",
        patches={"contact.sequential_qp:PACE_GROWTH": 1.0, "contact.sequential_qp:PACE_REDUCTION": 1.0},
    ),
    "pruning of implied constraints": Mechanism(
        "contact",
        patches={"contact.contact_response:not_implied": all_kept, "tightening.quadratic_model:not_implied": all_kept},
    ),
    # tightening
    "escapes from saddles": Mechanism("tightening", patches={"tightening.tightening:MAX_ESCAPES": 0}),
    "widening in small steps": Mechanism(
        "tightening",
        patches={"tightening.reach_clearance:MAX_STEPS": 0},
    ),
    "trials of shortened steps (3 to 1)": Mechanism("tightening", patches={"tightening.trial:MAX_ATTEMPTS": 1}),
    "overshoot of restoration": Mechanism(
        "tightening",
        patches={"tightening.restore_feasibility:OVERSHOOT": 1.0, "tightening.restore_feasibility:LATE_OVERSHOOT": 1.0},
    ),
    "trials, patience and overshoot together": Mechanism(
        "tightening",
        partial(Settings, tightening=Tightening(patience=1)),
        patches={
            "tightening.trial:MAX_ATTEMPTS": 1,
            "tightening.restore_feasibility:OVERSHOOT": 1.0,
            "tightening.restore_feasibility:LATE_OVERSHOOT": 1.0,
        },
    ),
    "patience (3 quiet steps to 1)": Mechanism("tightening", partial(Settings, tightening=Tightening(patience=1))),
}
"""Name and what is done without it; "(a to b)" where it is not all or nothing."""
