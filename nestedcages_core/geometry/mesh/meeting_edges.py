"""Where edges of loops meet, in words."""

from __future__ import annotations

import numpy as np

from ...errors import InvalidMeshError
from ..arrays import IntArray
from ..loops import Loops
from ..predicates import segments_intersect
from ..vectors import crossing_point, place


def raise_contact(order: Loops, i: IntArray, j: IntArray) -> None:
    """Raise for the first of the pairs (i, j) of edges in contact: a shared point, a touch or a crossing."""
    points, vertex, loop, ahead, ends = order.vertices, order.numbers, order.loop, order.ahead, order.ends

    def edge(k: int) -> str:
        return f"edge {vertex[k]}-{vertex[ahead[k]]} of loop {loop[k]}"

    for here, there in ((i, j), (ahead[i], j), (i, ahead[j]), (ahead[i], ahead[j])):
        same = np.flatnonzero((points[here] == points[there]).all(axis=1))
        if len(same):
            k, m = int(here[same[0]]), int(there[same[0]])
            raise InvalidMeshError(
                f"Vertices {vertex[k]} of loop {loop[k]} and {vertex[m]} of loop {loop[m]} both lie at "
                f"{place(points[k])}; move one of them, so that the boundary does not touch itself.",
                code="mesh.repeated_vertex",
                loops=[loop[k], loop[m]],
                vertices=[vertex[k], vertex[m]],
                place=points[k],
            )
    first = int(np.lexsort((j, i))[0])
    k, m = int(i[first]), int(j[first])
    for a, b in ((k, m), (int(ahead[k]), m), (m, k), (int(ahead[m]), k)):
        if segments_intersect(points[[a]], points[[a]], points[[b]], ends[[b]])[0]:
            raise InvalidMeshError(
                f"Vertex {vertex[a]} of loop {loop[a]} lies on {edge(b)} at {place(points[a])}; move it off the edge.",
                code="mesh.crossing",
                loops=[loop[a], loop[b]],
                vertices=[vertex[a], vertex[b], vertex[ahead[b]]],
                place=points[a],
            )
    point = crossing_point(points[k], ends[k], points[m], ends[m])
    where, corners = place(point), [vertex[k], vertex[ahead[k]], vertex[m], vertex[ahead[m]]]
    if loop[k] == loop[m]:
        raise InvalidMeshError(
            f"Loop {loop[k]} crosses itself near {where}: {edge(k)} meets {edge(m)}; move their vertices apart.",
            code="mesh.crossing",
            loops=[loop[k]],
            vertices=corners,
            place=point,
        )
    raise InvalidMeshError(
        f"Loops {loop[k]} and {loop[m]} cross near {where}: {edge(k)} meets {edge(m)}; move them apart, or unite them.",
        code="mesh.crossing",
        loops=[loop[k], loop[m]],
        vertices=corners,
        place=point,
    )
