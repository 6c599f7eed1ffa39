"""What is remembered of levels: the whole, and the steps that another energy or clearance needs too."""

from __future__ import annotations

from ..cache import Memory, key_of
from ..flow import FlowMethod, FlowResult
from ..geometry.mesh import Mesh
from ..tasks import Stage
from .gate import copied
from .report import Level, LevelProgress, Progress

BYTES_PER_VERTEX = 300
"""Of a mesh with its trees."""

LEVEL_CAPACITY = 64_000_000
"""Bytes of all levels that are remembered, with their steps."""

_levels: Memory[Level] = Memory(LEVEL_CAPACITY)
_flows: Memory[FlowResult] = Memory()


def whole_level(work: Stage[Progress, Level], progress: LevelProgress, *asked: object) -> Stage[Progress, Level]:
    """A level that depends only on what was asked for. Its arrays are not shared with later ones."""
    key = key_of(*asked)
    known = _levels.get(key)
    if known is None:
        made = yield from work
        _levels.put(key, copied(made), _level_size(made))
        return made
    yield from progress.begin("verification")
    return copied(known)


def _level_size(level: Level) -> int:
    """Bytes of the steps and meshes of a level."""
    vertices = sum(len(mesh.vertices) for mesh in (level.fine, level.coarse, level.cage))
    steps = level.flow.steps, level.reinflation.moving_steps, level.reinflation.cage_steps
    return sum(each.nbytes for each in steps) + BYTES_PER_VERTEX * vertices


def flow_inside(method: FlowMethod, fine: Mesh, coarse: Mesh) -> Stage[float, FlowResult]:
    """The flow, which depends neither on the energy nor on the clearance, but for its coarse mesh."""
    key = key_of(method, fine, coarse)
    return (yield from _flows.stage(key, method.run(fine, coarse), lambda flow: flow.steps.nbytes))
