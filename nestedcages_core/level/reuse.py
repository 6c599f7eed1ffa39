"""The steps of a level that are remembered: another energy or clearance needs the same ones."""

from __future__ import annotations

from collections.abc import Sequence

from ..cache import Memory, key_of
from ..decimation import Count, SeveralStarts, Start
from ..flow import FlowMethod, FlowResult
from ..geometry.mesh import Mesh
from ..tasks import Stage

CAPACITY = 16_000_000
"""Bytes of all coarse meshes that are remembered, and of all flows."""

BYTES_PER_VERTEX = 300
"""Of a mesh with its trees."""

_starts: Memory[list[Start]] = Memory(CAPACITY)
_flows: Memory[FlowResult] = Memory(CAPACITY)


def coarse_meshes(
    source: SeveralStarts, fine: Mesh, count: Count, *, clearance: float, most: int
) -> Stage[float, list[Start]]:
    """The starts of a decimation, which depend neither on the energy nor on the flow."""
    numbers = count if isinstance(count, int) else tuple(count)
    key = key_of(source, fine, numbers, clearance, most)
    search = source.starts(fine, count, clearance=clearance, most=most)
    return list((yield from _starts.stage(key, search, _size)))


def flow_inside(method: FlowMethod, fine: Mesh, coarse: Mesh) -> Stage[float, FlowResult]:
    """The flow, which depends neither on the energy nor on the clearance, but for its coarse mesh."""
    key = key_of(method, fine, coarse)
    return (yield from _flows.stage(key, method.run(fine, coarse), lambda flow: flow.steps.nbytes))


def _size(starts: Sequence[Start]) -> int:
    """Bytes of the meshes of starts."""
    meshes = [mesh for start in starts for mesh in (start.coarse, start.on_curve) if mesh is not None]
    return BYTES_PER_VERTEX * sum(len(mesh.vertices) for mesh in meshes)
