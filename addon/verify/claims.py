"""What Verify Cages looks at, drawings and cages as they are displayed, and what it found of which pose."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from itertools import pairwise

import bpy
import numpy as np
from bpy.types import Context, Object

from .. import cage_sets
from ..bind import field
from ..blender import mesh_data, shape_keys
from ..blender.jobs import drain
from ..cage_sets import CageSet, selection
from ..drawing import planar
from ..drawing.planar import Drawing, Outline
from ..drawing.plane import Frame, transform, world_matrix
from ..errors import UserError
from ..files import silhouettes
from .check import Chain, Finding, Folding


def chain_of(context: Context, objects: Sequence[Object]) -> Chain:
    """The objects with the visible originals of the fine mesh: not those played by a copy, nor followed inexactly."""
    fine = next((obj for obj in objects if cage_sets.level_of(obj) == 0), None)
    cage_set = CageSet.of(fine) if fine is not None else None
    if (
        fine is None
        or cage_set is None
        or any(shape_keys.is_step_shown(obj) for obj in objects if cage_sets.level_of(obj) is not None)
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
        planar.read(context, obj)
    except UserError:
        return cage_set.record.known and not cage_set.settings.close_open and obj in cage_set.parts
    return True


def _displayed(context: Context, obj: Object, frame: Frame) -> tuple[Outline, Drawing]:
    """The outline of a bound drawing, or of the area that it paints if it has none. Raises: UserError."""
    try:
        outline = planar.read(context, obj)
    except UserError:
        shown = field.shown_by(obj)
        loops, _ = drain(silhouettes.painted_loops(context, [shown], frame, closed=True))
        back = np.linalg.inv(world_matrix(shown)) @ frame.matrix
        own = tuple(transform(back, frame.points(loop)).astype(np.float32) for loop in loops)
        return Outline(obj.name, own, world_matrix(shown), obj.session_uid), Drawing(obj.name, frame, loops)
    return outline, planar.drawing_in(frame, outline, layer=True)


def pose_of(context: Context, cage: Object) -> str:
    """A digest of a cage as it is displayed, in its parent's space."""
    shape = cage.evaluated_get(context.evaluated_depsgraph_get()).data
    points = mesh_data.stored(shape.vertices, "co", 3) if isinstance(shape, bpy.types.Mesh) else np.empty(0)
    return hashlib.blake2b(points.tobytes() + np.array(cage.matrix_basis).tobytes(), digest_size=8).hexdigest()


def stands(context: Context, cage: Object) -> bool:
    """Whether what Verify Cages found of a cage is still so: not in another pose, as far as this frame can tell."""
    node, frame = cage_sets.node_of(cage), context.scene.frame_current
    first, last = node.checked
    elsewhere = first != last and (node.check != cage_sets.FAULT or frame != last)
    return node.check != "NONE" and (elsewhere or node.posed == pose_of(context, cage))


def remember(context: Context, checked: Sequence[Object], findings: Sequence[Finding]) -> None:
    """Stores findings on the cages that they are about, for the panel; the last one of each stays."""
    by_name = {obj.name: obj for obj in checked}
    for finding in findings:
        outer, inner = by_name[finding.cage], by_name[finding.fine]
        cage = outer if selection.depth_of(outer) > 0 else inner
        if cage_sets.level_of(cage) is not None:
            if finding.broken and context.scene.frame_current != finding.frames[1]:
                context.scene.frame_set(finding.frames[1])  # the whole animation was checked
            _remember(context, cage, finding)


def _remember(context: Context, cage: Object, finding: Finding) -> None:
    node = cage_sets.node_of(cage)
    node.posed = pose_of(context, cage)
    node.check, node.checked = finding.verdict, finding.frames
    node.judged = cage_sets.stamp(cage)
    cage_sets.set_check(node, finding.note)
