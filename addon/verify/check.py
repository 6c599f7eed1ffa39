"""Verification of cages that may have been edited, the vertices at fault, and where a pose folds what is in a cage."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object, Scene
from numpy.typing import NDArray

from .. import keys
from ..blender import mesh_data
from ..blender.jobs import Progress, Work
from ..blender.mesh_data import evaluated_mesh, stored
from ..cage_sets import FAULT, HOLDS, UNJUDGED
from ..core import core, loops, predicates
from ..drawing.planar import Drawing, Outline, drawing_in, fine_drawing, read
from ..drawing.plane import Frame, space_to_space, transform, world_matrix
from ..errors import FloatArray, UserError
from ..messages import BROKEN, note

# Smallest part of the drawing's area that is called a fold.
SMALLEST = 1e-4


@dataclass(frozen=True, eq=False)
class Folding:
    """The field `shows` of a cage at rest, and what follows it.

    rest: vertices (N, 3); weights: (N, m) of the cage's corners; triangles: (T, 3) those that hold a part of the
    drawing; areas: (T,) of these.
    """

    cage: Object
    inner: Object
    shows: Object
    rest: FloatArray
    weights: FloatArray
    triangles: NDArray[np.int64]
    areas: FloatArray

    @classmethod
    def of(cls, cage: Object, inner: Object, shows: Object) -> Folding:
        """The field of a cage, and an inner object that follows it. Raises: UserError."""
        outline, data = mesh_data.shape_of(inner), mesh_data.mesh_of(shows)
        rest, corners = mesh_data.points_of(data), mesh_data.stored(data.polygons, "vertices", 3, np.int32)
        places = np.column_stack([outline.vertices, np.zeros(len(outline.vertices))])
        shape = outline.moved(transform(space_to_space(shows, inner), places)[:, :2])
        triangles = corners.astype(np.int64)
        triangles = triangles[core.coordinates.holding(rest[:, :2], triangles, shape)]
        return cls(cage, inner, shows, rest, _stored_weights(data), *_upright(rest, triangles))

    @classmethod
    def of_skin(cls, mesh: Object, inner: Object) -> Folding:
        """A mesh that bones bend, all of it, and what it carries."""
        data = mesh_data.mesh_of(mesh)
        data.calc_loop_triangles()
        rest, triangles = mesh_data.points_of(data), mesh_data.stored(data.loop_triangles, "vertices", 3, np.int32)
        return cls(mesh, inner, mesh, rest, np.eye(len(rest)), *_upright(rest, triangles.astype(np.int64)))

    def now(self, context: Context) -> Finding | None:
        """What is folded on this frame: its part of the area, where most of it is, and the bone that bends it."""
        # Blender keeps only what is evaluated of hidden objects up to date
        cage, shows = (each.evaluated_get(context.evaluated_depsgraph_get()) for each in (self.cage, self.shows))
        corners = mesh_data.points_of(mesh_data.mesh_of(cage))
        if len(corners) != self.weights.shape[1]:
            return None
        posed = self.weights @ transform(space_to_space(shows, cage), corners)
        folded = core.coordinates.folded(posed[:, :2], self.triangles)
        share = float(self.areas[folded].sum() / self.areas.sum())
        if share < SMALLEST:
            return None
        worst = self.triangles[folded][self.areas[folded].argmax()]
        place, bone = transform(world_matrix(shows), posed[worst].mean(axis=0)[None])[0], self._bone(worst)
        how = f"bends '{bone}' over itself" if bone else "lies over itself"
        facts = {"inner": self.inner.name, "how": how, "share": share, "place": place.tolist()}
        said = note("check.folded", **facts, when="", more="")
        frame, nothing = context.scene.frame_current, np.empty((0, 3), np.float32)
        return Finding(self.cage.name, self.inner.name, FAULT, said, 0.0, (frame, frame), nothing, nothing)

    def _bone(self, triangle: NDArray[np.int64]) -> str:
        """Of the bones that move a triangle through the cage's corners, the one that bends it most; maybe none."""
        armatures = [each.object for each in self.cage.modifiers if isinstance(each, bpy.types.ArmatureModifier)]
        bends = {bone.name: _bend(bone) for each in armatures if each is not None for bone in each.pose.bones}
        names = {group.index: group.name for group in self.cage.vertex_groups if group.name in bends}
        pull = dict.fromkeys(names.values(), 0.0)
        for number, vertex in enumerate(self.cage.data.vertices):
            part = float(self.weights[triangle, number].sum()) if number < self.weights.shape[1] else 0.0
            for element in vertex.groups if part > 0.0 else ():
                if element.group in names:
                    pull[names[element.group]] += part * element.weight
        return max(pull, key=lambda name: pull[name] * bends[name], default="")


def _upright(rest: FloatArray, triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], FloatArray]:
    """Triangles (T, 3) counter-clockwise at rest, as those of a mirrored object are not, and their areas (T,)."""
    areas = 0.5 * np.linalg.det(np.diff(rest[triangles][:, :, :2], axis=1))
    return np.where(areas[:, None] < 0.0, triangles[:, ::-1], triangles), np.abs(areas)


def _stored_weights(field: bpy.types.Mesh) -> FloatArray:
    """The weights (N, m) that a field stores; of one without, each vertex is a corner."""
    attributes: Any = field.attributes
    names = [f"{keys.WEIGHT}{number}" for number in range(len(attributes))]
    columns = [mesh_data.stored(attributes[name].data, "value", 1) for name in names if name in attributes]
    return np.column_stack([c.ravel() for c in columns]).astype(float) if columns else np.eye(len(field.vertices))


def _bend(bone: bpy.types.PoseBone) -> float:
    """The angle by which a bone is turned against its parent, in radians."""
    now, rest = bone.matrix, bone.bone.matrix_local
    if bone.parent is not None:
        now, rest = bone.parent.matrix.inverted_safe() @ now, bone.parent.bone.matrix_local.inverted_safe() @ rest
    return float(rest.to_quaternion().rotation_difference(now.to_quaternion()).angle)


@dataclass(frozen=True)
class Finding:
    """The finding for one cage and the mesh in it from the first to the last of `frames`: whether it holds, has a fault
    or is not judged, a note, the smallest clearance in scene units, and the points at fault, (k, 3) in each object's
    space, on the last frame.
    """

    cage: str
    fine: str
    verdict: str
    note: core.Fault
    clearance: float
    frames: tuple[int, int]
    cage_faults: NDArray[np.float32]
    fine_faults: NDArray[np.float32]

    @property
    def broken(self) -> bool:
        """Whether there is a fault."""
        return self.verdict == FAULT


# Reads what is displayed of a drawing, in the plane of the cages. Raises: UserError.
Seen = Callable[[Context, Object, Frame], tuple[Outline, Drawing]]


def _outline(context: Context, obj: Object, frame: Frame) -> tuple[Outline, Drawing]:
    """The outline of an object, in the plane of a frame or a parallel one."""
    outline = read(context, obj)
    return outline, drawing_in(frame, outline, layer=True)


@dataclass(frozen=True)
class Chain:
    """Objects from the inside out, and the drawings that the one at index ``fine`` is a copy of; ``instead``: only they
    are displayed as they are, since they may have changed, not the copy. ``seen`` reads them. ``folding``: the fields
    that they follow; of these alone, there are no objects.
    """

    objects: Sequence[Object]
    originals: Sequence[Object] = ()
    fine: int = 0
    instead: bool = False
    seen: Seen = _outline
    folding: Sequence[Folding] = ()


def check(context: Context, chains: Sequence[Chain]) -> list[Finding]:
    """Checks each object of each chain against the one before it, evaluated on the current frame, and the neighbours of
    a copy also against its originals; these findings come first, only folds before them. Raises: UserError.
    """
    return _folds(context, chains) + _enclosures(context, chains)


def _enclosures(context: Context, chains: Sequence[Chain]) -> list[Finding]:
    findings = []
    for chain in chains:
        for pair in _pairs(context, chain) if chain.objects else ():
            finding = _finding(*pair, context.scene.frame_current)
            is_posed = any(each.cage.name == finding.cage for each in chain.folding)
            if finding.broken and is_posed and _crosses_itself(pair[3]):
                said = note("check.unjudged", outer=finding.cage, inner=finding.fine, when="")
                finding = replace(finding, verdict=UNJUDGED, note=said, clearance=inf)
            findings.append(finding)
    return findings


def _crosses_itself(cage: Drawing) -> bool:
    """Whether the outline of a cage crosses itself, as where a limb passes over the body."""
    outline = loops.Loops.of(np.concatenate(cage.loops), list(map(len, cage.loops)))
    i, j = predicates.crossing_pairs(outline.tree)
    return bool(((outline.ahead[i] != j) & (outline.ahead[j] != i)).any())


def _folds(context: Context, chains: Sequence[Chain]) -> list[Finding]:
    return [folds for chain in chains for each in chain.folding if (folds := each.now(context)) is not None]


def _pairs(context: Context, chain: Chain) -> Iterator[tuple[Outline, Drawing, Outline, Drawing]]:
    """What is inside and what is around it, in the plane of the first object. Raises: UserError."""
    outlines = [read(context, obj) for obj in chain.objects]
    frame = fine_drawing(outlines[0]).frame
    drawings = [(outline, drawing_in(frame, outline)) for outline in outlines]
    for original in chain.originals:
        copied = chain.seen(context, original, frame)
        if chain.fine > 0:
            yield (*drawings[chain.fine - 1], *copied)
        if chain.fine < len(drawings) - 1:
            yield (*copied, *drawings[chain.fine + 1])
    for place, (inner, outer) in enumerate(pairwise(drawings)):
        if not (chain.instead and chain.fine in (place, place + 1)):
            yield (*inner, *outer)


def check_animation(context: Context, chains: Sequence[Chain]) -> Work[list[Finding]]:
    """Checks all frames up to the first fault, which becomes current; finds the largest fold. Raises: UserError."""
    scene = context.scene
    first, last = scene.frame_start, scene.frame_end
    findings: list[Finding] = []
    folds: dict[tuple[str, str], list[Finding]] = {}
    for frame in range(first, last + 1):
        yield Progress((frame - first) / (last + 1 - first), "checking frames")
        scene.frame_set(frame)
        try:
            enclosures = _enclosures(context, chains)
        except UserError as error:
            raise UserError(f"Frame {frame}: {error}") from error
        for fold in _folds(context, chains):
            folds.setdefault((fold.cage, fold.fine), []).append(fold)
        if any(finding.broken for finding in enclosures):
            return _largest(folds, first) + [_on(finding, first, frame) for finding in enclosures]
        enclosures = [each if each.verdict == HOLDS else _on(each, first, frame) for each in enclosures]
        findings = [
            min(pair, key=lambda each: (each.verdict == HOLDS, each.clearance))
            for pair in zip(findings or enclosures, enclosures, strict=True)
        ]
    said = [
        note("check.frames", **finding.note.data, first=first, last=last) if finding.verdict == HOLDS else finding.note
        for finding in findings
    ]
    whole = [replace(each, frames=(first, last), note=text) for each, text in zip(findings, said, strict=True)]
    return _largest(folds, first) + whole


def _largest(folds: dict[tuple[str, str], list[Finding]], first: int) -> list[Finding]:
    """The largest fold of each drawing, with the number of frames that have one."""
    largest = []
    for on in folds.values():
        worst, frames = max(on, key=lambda each: each.note.data["share"]), [each.frames[1] for each in on]
        more = f"; {len(on)} frames from {frames[0]} to {frames[-1]} have folds" if len(on) > 1 else ""
        said = note(worst.note.code, **{**worst.note.data, "more": more})
        largest.append(_on(replace(worst, note=said), first, worst.frames[1]))
    return largest


def _on(finding: Finding, first: int, frame: int) -> Finding:
    """The finding of the first frame with a fault; its note names the frame."""
    said = note(finding.note.code, **{**finding.note.data, "when": f"Frame {frame}: "})
    return replace(finding, frames=(first, frame), note=said)


@contextmanager
def same_frame(scene: Scene) -> Iterator[None]:
    """Returns to the current frame at the end."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)


def _finding(inner: Outline, fine: Drawing, outer: Outline, cage: Drawing, frame: int) -> Finding:
    clearance = 0.0
    try:
        outside, inside = cage.mesh(), fine.mesh()
        certificate = core.verify(outside, inside, same_loops=outside.has_loops_like(inside))
    except UserError as error:
        verdict, said = FAULT, note("check.invalid", text=str(error), when="")
    else:
        verdict, clearance = HOLDS if certificate.holds else FAULT, float(certificate.clearance) * fine.frame.scale
        names = {"outer": outer.name, "inner": inner.name, "when": ""}
        if certificate.holds:
            said = note("check.holds", **names, clearance=clearance, excess=float(certificate.excess))
        else:
            codes = [problem.code for problem in certificate.problems]
            words = ", ".join(dict.fromkeys(BROKEN[code] for code in codes))
            said = note("check.broken", **names, text=words, codes=codes)
    cage_faults, fine_faults = _faults(cage, fine)
    return Finding(
        outer.name,
        inner.name,
        verdict,
        said,
        clearance,
        (frame, frame),
        outer.points_of(cage)[cage_faults].astype(np.float32),
        inner.points_of(fine)[fine_faults].astype(np.float32),
    )


def _faults(cage: Drawing, fine: Drawing) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Points of both drawings that are on crossing edges, outside of the cage, or inside one of its holes."""
    around, inside = (loops.Loops.of(np.concatenate(each.loops), list(map(len, each.loops))) for each in (cage, fine))
    ends, fine_ends = around.ahead, inside.ahead
    at_fault, fine_at_fault = np.zeros(len(ends), np.bool_), np.zeros(len(fine_ends), np.bool_)
    i, j = predicates.crossing_pairs(around.tree, inside.tree)
    at_fault[np.concatenate([i, ends[i]])] = True
    fine_at_fault[np.concatenate([j, fine_ends[j]])] = True
    i, j = predicates.crossing_pairs(around.tree)
    apart = (ends[i] != j) & (ends[j] != i)
    i, j = i[apart], j[apart]
    at_fault[np.concatenate([i, ends[i], j, ends[j]])] = True
    winding = predicates.winding_number(inside.vertices, around.vertices, around.ends)
    # The loops have no consistent sense, so the even-odd rule decides what is inside.
    return at_fault, fine_at_fault | (winding % 2 == 0) | (winding == predicates.ON_BOUNDARY)


def select_points(context: Context, obj: Object, points: NDArray[np.float32]) -> int:
    """Selects the vertices of a mesh object that are at evaluated points (k, 3), and only these; returns how many."""
    with evaluated_mesh(obj.evaluated_get(context.evaluated_depsgraph_get())) as shape:
        places = stored(shape.vertices, "co", 3)
    mesh = obj.data
    wanted = {point.tobytes() for point in np.ascontiguousarray(points)}
    chosen = np.array([place.tobytes() in wanted for place in places], dtype=bool)
    if len(chosen) != len(mesh.vertices):
        return 0
    mesh_data.select_vertices(mesh_data.mesh_of(obj), chosen)
    return int(chosen.sum())
