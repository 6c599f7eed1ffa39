"""From objects of a scene to planar drawings: their evaluated outlines, as closed loops in their plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from bpy.types import Context, Object
from numpy.typing import NDArray

from .. import keys
from ..core import broad_phase, core, distance
from ..core import loops as loops_of
from ..errors import Fault, FloatArray, UserError
from .edge_loops import SMALLEST_LOOP, chains, without_doubles
from .evaluated import READERS, Lines, has_nodes, lines_of, render_resolution, shown_at, temporary
from .faces import is_thick, may_show_more, seen, shown_in, tile
from .grease_pencil import KINDS, Counts, Painting
from .plane import PLANARITY, Frame, fitted_frame, own_frame, size, transform, united, united_loops, world_matrix

# Smallest part of the area of several drawings that is missing from their sum if one lies in another.
NESTED_PART = 1e-9
# Largest distance of edges at fault from the place in a message, as a fraction of the drawing's size: they may be
# rounded.
NEAR = 1e-4
# Maximum number of points of a fault.
MOST_POINTS = 8
# How much farther a curve may be from its chords than its places at every quarter of them: a fifteenth for a parabola.
BETWEEN = 1.1


@dataclass(frozen=True)
class ReadingOptions:
    """`close_open`: join the ends of open lines. `project`: flatten non-planar outlines instead of rejecting them."""

    close_open: bool = False
    project: bool = False


@dataclass(frozen=True)
class Outline:
    """The evaluated outline of an object: closed loops (k, 3) in its own space, float32, its matrix (4, 4), and its
    session ID. ``letters``: its loops may cross and touch, as those of texts and instances. ``filled``: it has faces.
    ``curve``: places (k, 3) of the true curve, and of what renders show, in its own space.
    """

    name: str
    loops: tuple[NDArray[np.float32], ...]
    matrix: FloatArray
    identity: int
    letters: bool = False
    filled: bool = False
    curve: tuple[NDArray[np.float32], ...] = ()

    @property
    def points(self) -> FloatArray:
        """All points (n, 3) in the object's own space."""
        return np.concatenate(self.loops).astype(np.float64)

    def points_of(self, drawing: Drawing) -> FloatArray:
        """The points (n, 3) of its drawing, which may have united its loops, in the object's own space."""
        placed = _placed(self.matrix, drawing.frame, drawing.loops)
        return self.points if sum(map(len, placed)) == len(self.points) else np.concatenate(placed).astype(np.float64)


@dataclass(frozen=True)
class Drawing:
    """An outline in a plane: loops (k, 2) in ``frame``, float32 values as float64. ``identity`` finds its object even
    after renaming, undo and redo. ``others``: drawings of other objects joined to it, whose loops come last unless all
    are ``united``. ``deviation``: how far the true curve, and what renders show, are from the loops at most.
    """

    name: str
    frame: Frame
    loops: tuple[FloatArray, ...]
    identity: int = 0
    others: tuple[Drawing, ...] = ()
    united: bool = False
    filled: bool = False
    deviation: float = 0.0

    @property
    def source(self) -> Object | None:
        """Its source object; None if that is gone."""
        return keys.found_object(self.identity, self.name)

    def mesh(self) -> core.Mesh:
        """The core's ``Mesh`` of this drawing. Raises: UserError, with the drawing's name, if it is invalid."""
        try:
            return core.Mesh.from_loops(self.loops)
        except core.NestedCagesError as error:
            raise UserError(in_words(error.fault, self.name, self._parts), self.fault(error.fault)) from error

    def fault(self, problem: core.Fault) -> Fault | None:
        """The ends of the edges at the place that a message of the core names, of the closest object; None without a
        place.
        """
        if problem.data.get("place") is None:
            return None
        place = np.array(problem.data["place"], dtype=np.float64)
        reach = NEAR * size(np.concatenate(self.loops))
        closest = min(self._parts, key=lambda part: min(_distances(loop, place).min() for loop in part.loops))
        near = [_distances(loop, place) <= reach for loop in closest.loops]
        points = np.concatenate([loop[at | np.roll(at, 1)] for loop, at in zip(closest.loops, near, strict=True)])
        if not len(points):
            every = np.concatenate(closest.loops)
            points = every[broad_phase.nearest(place[None], every)[1]]
        away = np.linalg.norm(points - place, axis=1)
        points = points[np.argsort(away, kind="stable")[:MOST_POINTS]]
        crossing = place[None] if away.min() > reach else points[:0]
        return Fault.at(closest.identity, self.frame.to_world(np.concatenate([crossing, points])))

    @property
    def _parts(self) -> list[Drawing]:
        """The drawing of each object."""
        if self.united:
            return [self]
        own = len(self.loops) - sum(len(other.loops) for other in self.others)
        return [replace(self, loops=self.loops[:own], others=()), *self.others]


def in_words(problem: core.Fault, name: str, parts: Sequence[Drawing]) -> str:
    """A message of the core about a drawing of some objects: where these cross, without numbers of loops and edges."""
    owners = [part.name for part in parts for _ in part.loops]
    loops = list(dict.fromkeys(problem.data.get("loops", ())))
    theirs = list(dict.fromkeys(owners[loop] for loop in loops if loop < len(owners))) or [name]
    who = " and ".join(f"'{each}'" for each in theirs)
    if problem.code == "mesh.spike":
        return f"{who} has a line that goes back on itself: delete its tip"
    if problem.code not in ("mesh.crossing", "mesh.repeated_vertex"):
        return f"'{name}': {problem}"
    what = f"Two outlines of {who} cross or touch" if len(loops) > 1 else f"{who} crosses or touches itself"
    return f"{what}: move points apart"


def _distances(loop: FloatArray, place: FloatArray) -> FloatArray:
    """Distances (k,) of a place from the edges of a loop (k, 2)."""
    return distance.point_edge(place, loop, np.roll(loop, -1, axis=0)).distance


def readable(obj: Object) -> bool:
    """Whether `read` supports this type of object."""
    return obj.type in READERS or obj.type in KINDS


def read(
    context: Context, obj: Object, options: ReadingOptions = ReadingOptions(), lines: Lines | None = None
) -> Outline:
    """The current evaluated outline of an object; lines: its own, if they are known. Raises: UserError."""
    if obj.type in KINDS:
        return _painted(context, obj, options)
    if lines is None:
        context.evaluated_depsgraph_get()  # updates the object's matrix
        lines = lines_of(context, obj)
    matrix = world_matrix(obj)
    if is_thick(obj) and (shown := _displayed(context, obj, matrix, lines, options)) is not None:
        return shown
    loops = _closed_loops(obj, lines.vertices, lines.edges, options)
    lost = np.ptp(np.concatenate(loops), axis=0).astype(bool) & ~matrix[:3, :3].any(axis=0)
    if lost.any():
        axes = " and ".join(axis for axis, gone in zip("XYZ", lost, strict=True) if gone)
        raise UserError(f"'{obj.name}' is scaled to nothing along {axes}: give it a scale first")
    letters = obj.type == "FONT" or has_nodes(obj)
    flat = obj.type == "FONT" or (obj.type == "CURVE" and obj.data.dimensions == "2D")
    filled = len(obj.data.polygons) > 0 if obj.type == "MESH" else flat and obj.data.fill_mode != "NONE"
    found = Outline(obj.name, loops, matrix, obj.session_uid, letters=letters, filled=filled, curve=lines.curve)
    return (may_show_more(obj) and _displayed(context, obj, matrix, lines, options, found)) or found


def _painted(context: Context, obj: Object, options: ReadingOptions) -> Outline:
    """The outline of what a Grease Pencil object paints; closed lines are areas too. Raises: UserError."""
    painting = Painting.of(context, obj)
    frame = painting.frame()
    areas = painting.areas(frame, Counts(closed=True, nested=True, opened=options.close_open))
    if not areas:
        raise UserError(f"'{obj.name}' has no area: give its strokes a radius, fill them, or make them cyclic")
    loops = united(obj.name, areas)
    off = painting.thickness(frame)
    if off > PLANARITY * size(np.concatenate(loops)) * frame.scale and not options.project:
        raise _not_flat(obj.name, off)
    own = _placed(painting.matrix, frame, loops)
    return Outline(obj.name, own, painting.matrix, obj.session_uid, letters=True, filled=True)


def _displayed(
    context: Context,
    obj: Object,
    matrix: FloatArray,
    lines: Lines,
    options: ReadingOptions,
    drawn: Outline | None = None,
) -> Outline | None:
    """The outline of all faces that an object shows, in viewport and renders, seen along the normal of its lines; None
    where it shows none, or where an outline that is drawn holds them. Raises: UserError.
    """
    points = (lines.vertices if drawn is None else np.concatenate(drawn.loops)).astype(np.float64)
    if not len(points) or not np.isfinite(points).all():
        return None
    frame = own_frame(matrix, points) or fitted_frame(matrix, points)
    with temporary() as blocks:
        shapes = [shown_at(context, obj, blocks, each) for each in sorted({0, render_resolution(obj)})]
        depsgraph = context.evaluated_depsgraph_get()
        displayed = [shown_in(each.evaluated_get(depsgraph), matrix, frame) for each in shapes]
    outlines = [] if drawn is None else [seen(frame, transform(matrix, p.astype(np.float64))) for p in drawn.loops]
    if drawn is not None and tile(np.concatenate([each.triangles for each in displayed]), outlines):
        return None
    areas = [area for each in displayed for area in each.areas()]
    if not areas:
        return None
    loops, off = united(obj.name, areas, closed=True), float(np.ptp(frame.from_world(transform(matrix, points))[1]))
    if off > PLANARITY * size(np.concatenate(loops)) * frame.scale and not options.project:
        raise _not_flat(obj.name, off)
    return Outline(obj.name, _placed(matrix, frame, loops), matrix, obj.session_uid, letters=True, filled=True)


def _placed(matrix: FloatArray, frame: Frame, loops: Sequence[FloatArray]) -> tuple[NDArray[np.float32], ...]:
    """Loops (k, 2) of a frame in the space of an object with a matrix, (k, 3)."""
    back = np.linalg.pinv(matrix)
    placed = [frame.points(loop) if frame.own else transform(back, frame.to_world(loop)) for loop in loops]
    return tuple(loop.astype(np.float32) for loop in placed)


def fine_drawing(outline: Outline, options: ReadingOptions = ReadingOptions()) -> Drawing:
    """The outline in its own plane: the object's frame if possible, else a fitted one. Raises: UserError."""
    matrix, points = outline.matrix, outline.points
    return drawing_in(own_frame(matrix, points) or fitted_frame(matrix, points), outline, options)


def drawing_in(
    frame: Frame, outline: Outline, options: ReadingOptions = ReadingOptions(), *, layer: bool = False
) -> Drawing:
    """The outline in a given frame, rounded to float32. Raises: UserError if it is not in the frame's plane.

    layer: a parallel plane will do.
    """
    loops, offs = [], []
    there = np.array_equal(outline.matrix, frame.matrix)
    for loop in outline.loops:
        points = loop.astype(np.float64)
        if there:
            xy, heights = points[:, :2], (points[:, 2] - frame.height) * frame.scale
        else:
            xy, heights = frame.from_world(transform(outline.matrix, points))
        loops.append(xy.astype(np.float32).astype(np.float64))
        offs.append(heights)
    heights = np.concatenate(offs)
    off = float(np.abs(heights - (np.median(heights) if layer else 0.0)).max())
    extent = size(np.concatenate(loops)) * frame.scale
    if off > PLANARITY * extent and not options.project:
        raise _not_flat(outline.name, off)
    # letters that overlap or touch are united
    kept = united_loops(outline.name, loops) if outline.letters else tuple(loops)
    deviation = _deviation(outline, frame, loops)
    return Drawing(outline.name, frame, kept, outline.identity, filled=outline.filled, deviation=deviation)


def _not_flat(name: str, off: float) -> UserError:
    return UserError(
        f"'{name}' does not lie in one plane with the drawing: it is up to {off:.3g} off it; flatten it, or tick "
        "'Project Anyway'"
    )


def _deviation(outline: Outline, frame: Frame, loops: Sequence[FloatArray]) -> float:
    """How far the true curve of an outline, and what renders show, may lie from its loops (k, 2) in a frame."""
    if not outline.curve:
        return 0.0
    places = frame.from_world(transform(outline.matrix, np.concatenate(outline.curve).astype(np.float64)))[0]
    tree = loops_of.Loops.of(np.concatenate(loops), list(map(len, loops))).tree
    return BETWEEN * float(tree.closest(places).distance.max(initial=0.0))


def joined(drawing: Drawing, others: Sequence[Drawing]) -> Drawing:
    """A drawing and others in the same frame as one. Where they overlap they are united. Raises: UserError."""
    parts = (drawing, *others)
    loops, deviation = tuple(loop for part in parts for loop in part.loops), max(part.deviation for part in parts)
    whole = replace(drawing, loops=loops, others=tuple(others), deviation=deviation)
    try:
        area = core.Mesh.from_loops(whole.loops).area
    except core.NestedCagesError:
        area = 0.0
    # Each part by itself, which names the one that has a fault. A line inside another part is a hole, a face is not.
    nested = area < (1.0 - NESTED_PART) * sum(part.mesh().area for part in parts)
    if not area or (nested and any(part.filled for part in others)):
        loops = united(drawing.name, [core.formats.Painted(part.loops, evenodd=True) for part in parts])
        return replace(whole, loops=loops, united=True)
    return whole


def _closed_loops(
    obj: Object, vertices: NDArray[np.float32], edges: NDArray[np.int64], options: ReadingOptions
) -> tuple[NDArray[np.float32], ...]:
    """The loops (k, 3) that the edges make, doubled points merged. Raises: UserError."""
    lines = chains(edges, len(vertices))
    if len(lines.branching):
        raise UserError(
            f"'{obj.name}' branches at ({_place(vertices[lines.branching[0]])}): at each point of an outline two edges "
            "meet, so separate or delete the others",
            _fault(obj, vertices[lines.branching[:1]]),
        )
    # A cyclic spline of two points evaluates to a single edge.
    all_cyclic = obj.type == "CURVE" and all(spline.use_cyclic_u for spline in obj.data.splines)
    opened = [vertices[line] for line in lines.opened if len(line) >= SMALLEST_LOOP or not all_cyclic]
    if opened and not options.close_open:
        raise _open_error(obj, opened)
    loops = [vertices[line] for line in (*lines.closed, *lines.opened)]
    if not np.isfinite(vertices).all():
        raise UserError(f"'{obj.name}' has a point whose place is not a number: delete it")
    if not loops and len(vertices) and not len(edges) and not (obj.type == "MESH" and not obj.data.polygons):
        raise UserError(f"'{obj.name}' is a solid and has no outline: select a flat drawing, or delete faces")
    if not loops and obj.type == "FONT" and not obj.data.body.strip():
        raise UserError(f"'{obj.name}' is a text without letters: write some (Tab)")
    if not loops:
        raise UserError(f"'{obj.name}' has no outline: draw a closed line, or select a flat drawing")
    extent = size(np.concatenate(loops).astype(float))
    for number, loop in enumerate(loops):
        loops[number] = without_doubles(loop, extent)
        if len(loops[number]) < SMALLEST_LOOP:
            raise UserError(
                f"'{obj.name}' has a loop with fewer than three different points at ({_place(loop[0])}): delete it",
                _fault(obj, loop[:1]),
            )
    return tuple(loops)


def _open_error(obj: Object, lines: Sequence[NDArray[np.float32]]) -> UserError:
    """The error for an open line of the object, with the number of its spline if known."""
    splines = obj.data.splines if obj.type == "CURVE" else ()
    number = next((i for i, spline in enumerate(splines, 1) if not spline.use_cyclic_u), None)
    ends = lines[0][[0, -1]]
    remedy = f"join the ends of its line at ({_place(ends[0])}) and ({_place(ends[1])})"
    if number is not None:
        remedy = f"make its spline {number} cyclic (Alt C in Edit Mode)"
    return UserError(f"'{obj.name}' is open: {remedy}, or tick 'Close Open Lines'", _fault(obj, ends))


def _fault(obj: Object, points: NDArray[np.float32]) -> Fault:
    """A fault at points (k, 3) in an object's own space."""
    return Fault.at(obj.session_uid, transform(np.array(obj.matrix_world, dtype=np.float64), points.astype(np.float64)))


def _place(point: NDArray[np.float32]) -> str:
    """A point in the object's own space, in words."""
    return ", ".join(f"{x:.4g}" for x in point)
