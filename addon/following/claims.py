"""What is claimed of cages is checked again, in the background, as soon as their drawing changes.

What moves the cages too, as a pose does, is no change of the drawing, and is left to Verify Cages.
"""

from __future__ import annotations

import hashlib
import itertools
import time
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Object, Scene
from mathutils import Matrix, Vector

from .. import record
from ..animation import shape_keys
from ..binding import field
from ..core import core
from ..errors import UserError
from ..generation.job import LOOK_INTERVAL, Job, Progress, Work, drain, in_window
from ..generation.verifying import Chain, Finding, Folding, check
from ..io import silhouettes
from ..keys import found_object
from ..notes import note
from ..record import CageSet
from ..scene import convert, filling, ownership, placement
from ..scene.convert import Drawing, Outline
from ..scene.plane import Frame, transform, world_matrix
from . import live

# Points of a drawing that tell whether its transform was applied, and their largest relative error then.
MAX_CORNERS, UNMOVED = 8, 1e-5

# Session IDs of the finest cages of changed sets, and the time of the last change.
_changed: dict[int, float] = {}
# Files since whose opening no change was looked at, when all of their drawings are.
_new_files: set[str] = set()
# By session ID of drawings: where they stood, and some of their points.
_stood: dict[int, tuple[Matrix, list[Vector]]] = {}


def chain_of(context: Context, objects: Sequence[Object]) -> Chain:
    """The objects with the visible originals of the fine mesh: not those played by a copy, nor followed inexactly."""
    fine = next((obj for obj in objects if record.level_of(obj) == 0), None)
    cage_set = CageSet.of(fine) if fine is not None else None
    if (
        fine is None
        or cage_set is None
        or any(shape_keys.is_step_shown(obj) for obj in objects if record.level_of(obj) is not None)
    ):
        return Chain(objects, folding=_folding(objects))
    visible = [original for original in cage_set.originals if original not in objects and original.visible_get()]
    place = objects.index(fine)
    if not cage_set.bound:
        return Chain(objects, [each for each in visible if _is_readable(context, cage_set, each)], place)
    originals = [original for original in visible if field.followed(original) is not None]
    return Chain(objects, originals, place, bool(originals), _displayed, _folding(objects))


def _folding(objects: Sequence[Object]) -> list[Folding]:
    """The fields that bound objects follow, each with the cage around them."""
    pairs = [(inner, cage, field.field_of(cage)) for inner, cage in pairwise(objects)]
    return [Folding.of(cage, inner, shows) for inner, cage, shows in pairs if shows and field.followed(inner) == cage]


def _is_readable(context: Context, cage_set: CageSet, obj: Object) -> bool:
    """Whether a drawing can be read as it is, or should be: not what had to be closed, nor parts of a silhouette."""
    try:
        convert.read(context, obj)
    except UserError:
        return cage_set.record.known and not cage_set.settings.close_open and obj in cage_set.parts
    return True


def _displayed(context: Context, obj: Object, frame: Frame) -> tuple[Outline, Drawing]:
    """The outline of a bound drawing, or of the area that it paints if it has none. Raises: UserError."""
    try:
        outline = convert.read(context, obj)
    except UserError:
        shown = field.shown_by(obj)
        loops, _ = drain(silhouettes.painted_loops(context, [shown], frame, closed=True))
        back = np.linalg.inv(world_matrix(shown)) @ frame.matrix
        own = tuple(transform(back, frame.points(loop)).astype(np.float32) for loop in loops)
        return Outline(obj.name, own, world_matrix(shown), obj.session_uid), Drawing(obj.name, frame, loops)
    return outline, convert.drawing_in(frame, outline, layer=True)


def pose_of(context: Context, cage: Object) -> str:
    """A digest of a cage as it is displayed, in its parent's space."""
    shape = cage.evaluated_get(context.evaluated_depsgraph_get()).data
    points = filling.stored(shape.vertices, "co", 3) if isinstance(shape, bpy.types.Mesh) else np.empty(0)
    return hashlib.blake2b(points.tobytes() + np.array(cage.matrix_basis).tobytes(), digest_size=8).hexdigest()


def stands(context: Context, cage: Object) -> bool:
    """Whether what Verify Cages found of a cage is still so: not in another pose, as far as this frame can tell."""
    node, frame = record.node_of(cage), context.scene.frame_current
    first, last = node.checked
    elsewhere = first != last and (node.check == record.HOLDS or frame != last)
    return node.check != "NONE" and (elsewhere or node.posed == pose_of(context, cage))


def remember(context: Context, checked: Sequence[Object], findings: Sequence[Finding]) -> None:
    """Stores findings on the cages that they are about, for the panel; the last one of each stays."""
    by_name = {obj.name: obj for obj in checked}
    for finding in findings:
        outer, inner = by_name[finding.cage], by_name[finding.fine]
        cage = outer if ownership.depth_of(outer) > 0 else inner
        if record.level_of(cage) is not None:
            if not finding.holds and context.scene.frame_current != finding.frames[1]:
                context.scene.frame_set(finding.frames[1])  # the whole animation was checked
            _remember(context, cage, finding.holds, finding.note, finding.frames)


def _remember(context: Context, cage: Object, holds: bool, finding: core.Fault, frames: tuple[int, int]) -> None:
    node = record.node_of(cage)
    node.posed = pose_of(context, cage)
    node.check, node.checked = record.HOLDS if holds else record.FAULT, frames
    node.judged = record.stamp(cage)
    record.set_check(node, finding)


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_update(_scene: Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Notes outputs whose drawing has changed its shape; cages stay where it is, however it carries them."""
    changed: list[tuple[Any, bool]] = [(each.id.original, each.is_updated_geometry) for each in depsgraph.updates]
    if not changed:
        return
    touched = {block.session_uid: geometry for block, geometry in changed}
    sets = CageSet.everywhere() if _new_files else _sets_of([block for block, _ in changed])
    _new_files.clear()
    for cage_set in sets:
        theirs = cage_set.drawings()
        if not theirs:
            continue
        ids = [
            id.session_uid for obj in (*theirs, *record.shown_in(theirs[0])) for id in (obj, obj.data) if id is not None
        ]
        if theirs[0].session_uid in _stood and touched.keys().isdisjoint(ids):
            continue
        cages = {cage.session_uid for cage in cage_set.cages}
        for source in theirs:
            _stay(cage_set, source)
        if cages and any(map(touched.get, ids)) and not any(map(touched.get, cages)):
            for obj in _carried(cage_set):
                for source in theirs:
                    placement.keep_carried(obj, source)
            if not _changed:
                Job(_checking(), background=True).start()
            _changed[cage_set.finest.session_uid] = time.perf_counter()


def _sets_of(ids: Sequence[bpy.types.ID]) -> list[CageSet]:
    """The sets of objects among data-blocks."""
    ours = [obj for obj in ids if isinstance(obj, Object) and (record.has_node(obj) or obj.library is not None)]
    return list(dict.fromkeys(each for obj in ours for each in CageSet.all_of(obj)))


def _carried(cage_set: CageSet) -> list[Object]:
    """All objects that a drawing carries."""
    helpers = (record.helpers_of(cage, record.FIELD, record.LINES) for cage in cage_set.members)
    return [*cage_set.members, *itertools.chain(*helpers)]


def _stay(cage_set: CageSet, source: Object) -> None:
    """Leaves cages in place when a transform of their drawing was applied, or its origin set: its points stay too."""
    before, now = _stood.get(source.session_uid), (source.matrix_world.copy(), _corners(source))
    _stood[source.session_uid] = now
    if before is None or before[0] == now[0] or before[1] == now[1] or len(before[1]) != len(now[1]):
        return
    there, here = ([matrix @ point for point in points] for matrix, points in (before, now))
    size = max(point.length for point in there)
    if any((one - other).length > UNMOVED * size for one, other in zip(there, here, strict=True)):
        return
    back = now[0].inverted_safe() @ before[0]
    for obj in _carried(cage_set):
        if record.is_helper(obj, record.FIELD) and placement.carrier_of(obj)[0] == source:
            filling.mesh_of(obj).transform(back)  # it is in the drawing's own space
            placement.carry(obj, source)
        else:
            placement.rebase(obj, source, back)
    if source == cage_set.source:
        for cage in cage_set.cages:
            field.move_offset(cage, back)


def _corners(obj: Object) -> list[Vector]:
    """The first points of a curve or mesh, in its own space."""
    if obj.type == "MESH":
        return [vertex.co.copy() for vertex in obj.data.vertices[:MAX_CORNERS]]
    splines = obj.data.splines[:MAX_CORNERS] if obj.type == "CURVE" else ()
    points = [point for spline in splines for point in (spline.bezier_points or spline.points)[:MAX_CORNERS]]
    return [point.co.to_3d() for point in points]


def _checking() -> Work[None]:
    """Checks what has changed until nothing is left."""
    try:
        while _changed:
            yield Progress(0.0, "", live.REST)
            yield from check_changed(live.REST)
            windows = bpy.context.window_manager.windows
            shown = {each.scene for each in windows} or {bpy.context.scene}
            for identity in list(_changed):
                finest = found_object(identity)
                source = CageSet(finest).source if finest is not None else None
                if source is None or all(scene.objects.get(source.name) != source for scene in shown):
                    del _changed[identity]
    finally:
        _changed.clear()


def check_changed(rested: float = 0.0) -> Work[None]:
    """Checks the cages of drawings whose last change is some seconds ago, in a window that shows their scene, and
    stores what is wrong.
    """
    now = time.perf_counter()
    for identity in [identity for identity, when in _changed.items() if now - when >= rested]:
        windows = bpy.context.window_manager.windows
        for window in {each.scene: each for each in windows}.values() if len(windows) else (None,):
            with in_window(window):
                _check_changed(bpy.context, identity)
        yield Progress(0.0, "", LOOK_INTERVAL)


def _check_changed(context: Context, identity: int) -> None:
    following, finest = live.current(), found_object(identity)
    cage_set = CageSet(finest) if finest is not None else None
    source = cage_set.source if cage_set is not None else None
    if (
        identity not in _changed
        or cage_set is None
        or not cage_set.counts
        or source is None
        or source.mode == "EDIT"  # checked when it is left
        or context.scene.objects.get(source.name) != source  # maybe in another window
    ):
        return
    del _changed[identity]
    if following is None or following.identity != source.session_uid:
        _check(context, cage_set)


def changed_since(when: float) -> set[int]:
    """Session IDs of the finest cages of sets whose drawing has changed since then."""
    return {identity for identity, changed in _changed.items() if changed >= when}


def certified(sets: Sequence[CageSet], edited: set[int]) -> None:
    """What was just made needs no check, although Blender took its drawing for changed while it was shown again;
    edited: session IDs of finest cages of sets whose drawing has changed since it was read.
    """
    for cage_set in sets:
        if cage_set.finest.session_uid not in edited:
            _changed.pop(cage_set.finest.session_uid, None)


def _check(context: Context, cage_set: CageSet) -> None:
    fine, cage = cage_set.fine, cage_set.finest
    if fine is None or not record.exists(cage):
        return
    known = record.node_of(cage).check != "NONE"
    try:
        chain = chain_of(context, sorted([fine, cage], key=ownership.depth_of))
        named = {original.name for original in chain.originals}
        findings = [each for each in check(context, [chain]) if named & {each.fine, each.cage}]
    except UserError as error:
        frame = context.scene.frame_current
        _remember(context, cage, False, note("check.invalid", text=str(error), when=""), (frame, frame))
    else:
        findings.sort(key=lambda finding: not finding.holds)
        if findings and (known or not findings[-1].holds):
            remember(context, [*chain.objects, *chain.originals], findings)


@bpy.app.handlers.persistent  # type: ignore[untyped-decorator]
def _on_load(*_: object) -> None:
    """The drawings of another file stand elsewhere."""
    _stood.clear()
    _new_files.add(bpy.data.filepath)


def register() -> None:
    bpy.app.handlers.depsgraph_update_post.append(_on_update)
    bpy.app.handlers.load_post.append(_on_load)
    _new_files.add("")


def unregister() -> None:
    bpy.app.handlers.load_post.remove(_on_load)
    bpy.app.handlers.depsgraph_update_post.remove(_on_update)
    _changed.clear()
    _stood.clear()
