"""The mechanisms that the ablation switches off: by settings, or by what takes the place of a name in the core."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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
    probes: Mapping[str, Callable[[Sequence[Any], Any], bool]] = field(default_factory=dict)
    """Functions of the core, and whether a call with these arguments and this result uses the mechanism. Cases without
    such a call are as they are; without probes every case counts."""


def first(given: Any, *_: Any, **__: Any) -> Any:
    """What came in, unchanged."""
    return given


def called(*_: Any) -> bool:
    """Used by every call."""
    return True


def found_something(_: Sequence[Any], result: Any) -> bool:
    """Used where something is returned."""
    return result is not None


def holds(_: Sequence[Any], result: Any) -> bool:
    """Used where the answer is yes."""
    return bool(result)


def changed(arguments: Sequence[Any], result: Any) -> bool:
    """Used where the first argument is not returned as it is."""
    return result is not arguments[0]


def fewer_vertices(arguments: Sequence[Any], result: Any) -> bool:
    """Used where the outline that is returned has fewer vertices."""
    return len(result.vertices) < len(arguments[0].vertices)


def several_loops(arguments: Sequence[Any], _: Any) -> bool:
    """Used where the outline has more than two loops."""
    return len(arguments[0].sizes) > 2


def per_loop(arguments: Sequence[Any], _: Any) -> bool:
    """Used where a number of vertices was asked for every loop."""
    return arguments[1].per_loop is not None


def counts_kept(hulls: Callable[..., Any]) -> Callable[..., Any]:
    """The hulls with the counts per loop that were asked for, or none."""

    def kept(self: Any, *arguments: Any) -> Any:
        return self._best(*arguments)

    return kept


def crowded(_: Sequence[Any], result: Any) -> bool:
    """Used where IPC ends with too many pairs."""
    return "too many pairs" in result.reason


def shortened(arguments: Sequence[Any], _: Any) -> bool:
    """Used where ranges are scaled by less than 1."""
    return bool(arguments[1] < 1.0)


def several_steps(_: Sequence[Any], result: Any) -> bool:
    """Used where a widening takes small steps."""
    return bool(result.systems > 0)


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


def uniform_radius(update: Callable[..., None]) -> Callable[..., None]:
    """One radius for all vertices, the smallest of all."""

    def updated(self: Any, *arguments: Any, **options: Any) -> None:
        update(self, *arguments, **options)
        self.radius = np.full_like(self.radius, float(np.median(self.radius)))

    return updated


MECHANISMS: dict[str, Mechanism] = {
    # where cages begin
    "second start": Mechanism("hierarchy", partial(Settings, starts=1)),
    "second start (2 to 3)": Mechanism("hierarchy", partial(Settings, starts=3)),
    "early stop of losing starts": Mechanism("hierarchy", patches={"level.early_stop:FIRST_LOOK": 10**9}),
    "the hull as fallback": Mechanism("hierarchy", partial(Settings, fallback=None)),
    "untightened cage as last resort": Mechanism(
        "hierarchy",
        patches={"level.builder:LevelBuilder._untightened": no_level},
        probes={"level.builder:LevelBuilder._untightened": found_something},
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
        probes={"decimation.hull.outer_hull:search_hulls": several_loops},
    ),
    "rescues": Mechanism(
        "decimation",
        patches={"decimation.hull.hull_search:_rescues": no_hulls},
        probes={"decimation.hull.hull_search:_rescues": called},
    ),
    "early end of hopeless hull searches": Mechanism(
        "decimation",
        patches={"decimation.hull.hull_search:HOPELESS_NUMBER": 10**9},
        probes={"decimation.hull.hull_search:_is_hopeless": holds},
    ),
    "counts shared out anew": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_hull:OuterHull.hulls": Around(counts_kept)},
        probes={"decimation.hull.outer_hull:OuterHull.hulls": per_loop},
    ),
    "clearing": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_hull:cleared": first},
        probes={"decimation.hull.outer_hull:cleared": changed},
    ),
    "clearing: small details built over": Mechanism(
        "decimation",
        patches={"decimation.hull.clearing:without_small_details": first},
        probes={"decimation.hull.clearing:without_small_details": fewer_vertices},
    ),
    "clearing: narrow gaps filled": Mechanism(
        "decimation",
        patches={"decimation.hull.clearing:_without": first},
        probes={"decimation.hull.clearing:_without": fewer_vertices},
    ),
    "filling of gaps like round-off": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_hull:without_gaps": first},
        probes={"decimation.hull.outer_hull:without_gaps": changed},
    ),
    "details like round-off built over": Mechanism(
        "decimation",
        patches={"decimation.hull.outer_hull:without_small_details": first},
        probes={"decimation.hull.outer_hull:without_small_details": fewer_vertices},
    ),
    "room in small holes": Mechanism(
        "decimation",
        patches={"decimation.request:with_room": first},
        probes={"decimation.request:with_room": changed},
    ),
    # flow
    "flow: steps with samples at vertices (6 to 1)": Mechanism(
        "flow", partial(Settings, flow=TwoSidedFlow(vertex_limit=1))
    ),
    "flow: erosion": Mechanism(
        "flow",
        patches={"flow.two_sided:_Run.erosion": no_stage},
        probes={"flow.two_sided:_Run.erosion": found_something},
    ),
    "flow: geodesic": Mechanism(
        "flow",
        patches={"flow.two_sided:_Run.geodesic": no_stage},
        probes={"flow.two_sided:_Run.geodesic": found_something},
    ),
    # contact
    "sequential QPs first (IPC first)": Mechanism(
        "contact", with_contacts(IPC(max_pairs=MAX_IPC_PAIRS), SequentialQP())
    ),
    "sequential QPs (IPC only)": Mechanism("contact", with_contacts(IPC())),
    "IPC behind sequential QPs": Mechanism("contact", with_contacts(SequentialQP())),
    "IPC gives way in crowds": Mechanism(
        "contact", patches={"level.attempts:MAX_IPC_PAIRS": np.inf}, probes={"contact.ipc:IPC.reinflate": crowded}
    ),
    "IPC: stiffening": Mechanism(
        "contact", patches={"contact.ipc:MAX_STIFFENINGS": 0}, probes={"contact.ipc:IPC.reinflate": called}
    ),
    "IPC: shorter ranges": Mechanism(
        "contact",
        patches={"contact.ipc:MAX_RANGE_REDUCTIONS": 0},
        probes={"contact.barrier_ranges:BarrierRanges.scaled": shortened},
    ),
    "QP: pace per vertex": Mechanism(
        "contact",
        patches={"contact.sequential_qp:PACE_GROWTH": 1.0, "contact.sequential_qp:PACE_REDUCTION": 1.0},
        probes={"contact.sequential_qp:SequentialQP.reinflate": called},
    ),
    "pruning of implied constraints": Mechanism(
        "contact",
        patches={"contact.contact_response:not_implied": all_kept, "tightening.quadratic_model:not_implied": all_kept},
    ),
    "thinning of nearly implied constraints": Mechanism(
        "tightening", patches={"tightening.quadratic_model:REDUNDANCY": 0.0}
    ),
    # tightening
    "escapes from saddles": Mechanism(
        "tightening",
        patches={"tightening.tightening:MAX_ESCAPES": 0},
        probes={"tightening.tightening:_Run._escape": found_something},
    ),
    "radius per vertex": Mechanism(
        "tightening", patches={"tightening.trust_region:TrustRegion.update": Around(uniform_radius)}
    ),
    "widening in small steps": Mechanism(
        "tightening",
        patches={"tightening.reach_clearance:MAX_STEPS": 0},
        probes={"tightening.tightening:widen": several_steps},
    ),
    "trials of shortened steps (3 to 1)": Mechanism("tightening", patches={"tightening.trial:MAX_ATTEMPTS": 1}),
    "overshoot of restoration": Mechanism(
        "tightening",
        patches={"tightening.restore_feasibility:OVERSHOOT": 1.0, "tightening.restore_feasibility:LATE_OVERSHOOT": 1.0},
    ),
    "patience (3 quiet steps to 1)": Mechanism("tightening", partial(Settings, tightening=Tightening(patience=1))),
}
"""Name and what is done without it; "(a to b)" where it is not all or nothing."""
