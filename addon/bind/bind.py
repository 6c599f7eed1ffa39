"""Binding: each level follows the next coarser one, and the drawing follows the first.

Bound objects show a mesh without the steps of their animation. The mesh with the steps is kept and restored when they
are unbound. The artist's work on either mesh is transferred to the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import bpy
import numpy as np
from bpy.types import Context, Object
from mathutils import Matrix

from .. import cage_sets, keys
from ..animation import visibility
from ..blender import display, mesh_data, shape_keys
from ..blender.jobs import Progress, Work, drain
from ..cage_sets import CageSet
from ..cage_sets.selection import check_free
from ..core import blamed, core
from ..drawing import placement
from ..drawing.painted import paints
from ..drawing.plane import PLANARITY, scale_of, size, space_to_space, transform
from ..errors import UserError, counted
from ..messages import BROKEN
from ..transfer import unshaped
from . import bound_meshes, field

# Relative change of a clearance that is more than round-off.
CHANGED = 1e-3
# What the job says.
STAGE = "binding"
# Largest error of a vertex at rest, as a fraction of the size: some roundings of float32.
REST_ERROR = 1e-5
# More drawings than this are counted, not named.
MAX_NAMES = 3


def in_step(context: Context, works: Iterable[Work[str]]) -> Work[list[str | UserError]]:
    """The results of works that are advanced together; before each step of all, the scene is updated once, which takes
    a pass over all of it.
    """
    running, results = dict(enumerate(works)), dict[int, str | UserError]()
    try:
        while running:
            context.view_layer.update()
            for number, work in running.items():
                try:
                    progress = next(work)
                except StopIteration as end:
                    results[number] = end.value
                except UserError as error:
                    results[number] = error
            running = {number: work for number, work in running.items() if number not in results}
            if running:
                yield progress
    finally:
        for work in running.values():
            work.close()
    return [results[number] for number in sorted(results)]


def bind(context: Context, cage_set: CageSet, method: str = "AUTO") -> str:
    """Makes every level of an output collection follow the next one; says which drawings follow, or why not.

    Raises: UserError, with nothing changed.
    """
    return _alone(context, steps(context, cage_set, method))


def bind_all(context: Context, sets: Iterable[CageSet]) -> Work[list[str]]:
    """The same for several sets. Raises: the first UserError; others may be bound then."""
    results = yield from in_step(context, [steps(context, each, "AUTO") for each in sets])
    for result in results:
        if isinstance(result, UserError):
            raise result
    return [str(result) for result in results]


def _alone(context: Context, work: Work[str]) -> str:
    (made,) = drain(in_step(context, [work]))
    if isinstance(made, UserError):
        raise made
    return made


def steps(context: Context, cage_set: CageSet, method: str) -> Work[str]:
    """The same, as a work for `in_step`."""
    levels = _levels(context, cage_set)
    yield Progress(0.0, STAGE)
    try:
        visibility.leave(cage_set)
        for obj in levels:
            bound_meshes.park(obj)
        yield Progress(1.0 / 5.0, STAGE)
        bound_meshes.fill(levels)
        return (yield from _connect(context, cage_set, levels, method))
    except BaseException:
        unbind(cage_set)
        display.remove_unused()
        raise


def rebind(context: Context, cage_set: CageSet, method: str = "AUTO") -> Work[str]:
    """Binds again, with the current vertices and transforms of cages and drawing. Raises: UserError.

    Bound objects return to their own shapes first. If the cages do not enclose these, nothing is changed. It can be
    cancelled until the first change.
    """
    levels = _levels(context, cage_set)
    for done, (inner, cage) in enumerate(pairwise(levels)):
        yield Progress(done / len(levels), f"checking '{cage.name}'")
        _check_enclosed(inner, cage)
    yield Progress(1.0 - 1.0 / len(levels), STAGE)
    _disconnect(levels)
    bound_meshes.fill(levels)
    return _alone(context, _connect(context, cage_set, levels, method))


def newcomers(context: Context) -> Iterator[Object]:
    """The selected drawings without cages of their own that a bound output can take along."""
    for obj in context.selected_objects:
        if paints(obj) and field.followed(obj) is None and CageSet.of(obj) is None:
            yield obj


def take_in(context: Context, cage_set: CageSet) -> Work[str]:
    """Makes the selected drawings follow the cages of a bound output as well. Raises: UserError."""
    parts, finest, coarsest = list(newcomers(context)), cage_set.cages[0], cage_set.cages[-1]
    made = field.field_of(finest)
    assert made is not None
    space = placement.carrier_of(made)[0] or made
    armature = next((m.object for m in coarsest.modifiers if isinstance(m, bpy.types.ArmatureModifier)), None)
    for part in parts:
        field.follow(part, finest, space)
        if armature is not None:
            placement.attach(part, armature)
    cage_set.join(*parts)
    yield from ()
    return f"{_named(parts)} bound, with what is in the cages already"


def unbind(*sets: CageSet) -> list[str]:
    """Restores the state before binding, with the artist's later work but poses of vertices; returns what is lost."""
    levels = [obj for cage_set in sets for obj in cage_set.members]
    _disconnect(levels)
    lost = bound_meshes.unpark(levels)
    for cage_set in sets:
        cage_set.record.bound = ""
        visibility.enter(cage_set)
    return lost


def forget(cage_set: CageSet) -> str:
    """Removes the remains of a binding from output written again; returns the method it was bound by, or nothing."""
    method = cage_set.bound
    if not method:
        return ""
    levels = cage_set.members
    _disconnect(levels, lines_back=False)
    for obj in levels:
        before = cage_sets.before(obj)
        cage_sets.set_before(obj, cage_sets.Before())
        if before.mesh is not None:
            shape_keys.remove_mesh(before.mesh)
    cage_set.record.bound = ""
    return method


def _levels(context: Context, cage_set: CageSet) -> list[Object]:
    levels = cage_set.members
    if cage_set.fine is None:
        raise UserError(f"The fine mesh of '{cage_set.name}' was deleted: generate them again")
    check_free(levels)
    for obj in levels:
        if obj.name not in context.view_layer.objects:
            raise UserError(f"'{obj.name}' is not in this view layer: tick its cage_set in the Outliner")
    return levels


def _check_enclosed(inner: Object, cage: Object) -> core.Certificate:
    """The certificate of a cage around what is in it, both unposed. Raises: UserError unless it holds, in its plane."""
    there = space_to_space(cage, inner)
    drawing, corners = mesh_data.mesh_of(inner), mesh_data.points_of(mesh_data.mesh_of(cage))
    points = transform(there, mesh_data.points_of(drawing))
    if np.ptp(np.concatenate([points[:, 2], corners[:, 2]])) > PLANARITY * size(corners):
        raise UserError(
            f"'{inner.name}' and '{cage.name}' do not lie in one plane: move the cage back into it, then bind again"
        )
    with blamed(f"'{inner.name}'"):
        fine = core.Mesh(points[:, :2], mesh_data.loop_edges(drawing))
    around = mesh_data.shape_of(cage)
    certificate = core.verify(around, fine, same_loops=around.has_loops_like(fine))  # holes may be filled
    if not certificate.holds:
        wrong = ", ".join(dict.fromkeys(BROKEN[problem.code] for problem in certificate.problems))
        raise UserError(
            f"'{cage.name}' does not enclose '{inner.name}' as it is now ({wrong}): move its vertices out, then bind "
            "again"
        )
    return certificate


def _connect(context: Context, cage_set: CageSet, levels: list[Object], method: str) -> Work[str]:
    """Makes a field for each cage, which what is inside follows."""
    before = cage_set.bound
    kind = next((each for each in (method, before) if each in field.NAMES), field.HARMONIC)
    cage_set.record.bound = kind
    yield Progress(2.0 / 5.0, STAGE)
    for inner, cage in pairwise(levels):
        certificate, node = _check_enclosed(inner, cage), cage_sets.node_of(cage)
        clearance, excess = float(certificate.clearance) * scale_of(inner), float(certificate.excess)
        if cage_sets.is_edited(cage) or not math.isclose(clearance, node.clearance, rel_tol=CHANGED):
            cage_sets.restate(cage, clearance, excess)
    originals = cage_set.originals
    space = next((obj for obj in originals if obj.name in context.view_layer.objects), levels[0])
    with unshaped(levels):
        for inner, cage in pairwise(levels):
            field.make(cage, space, kind)
            field.pose(cage, space)
            there = (
                Matrix(space_to_space(space, inner).tolist()) if inner.matrix_world != space.matrix_world else Matrix()
            )
            field.follow(inner, cage, space, None if inner == levels[0] else there)
        yield Progress(3.0 / 5.0, f"{STAGE}: '{levels[0].name}' follows '{levels[-1].name}'")
        for inner in levels[:-1]:
            _check_at_rest(context, inner)
        yield Progress(4.0 / 5.0, STAGE)
    for obj in levels:
        mesh = mesh_data.mesh_of(obj)
        mesh_data.add_attribute(mesh, keys.REST, "FLOAT_VECTOR", mesh_data.points_of(mesh).astype(np.float32))
        bound_meshes.take_lines_out(obj)
    return _take_along(context, originals, space, levels)


def _check_at_rest(context: Context, obj: Object) -> None:
    """Raises: UserError if a bound object does not stand still at rest."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    points, displayed = (mesh_data.points_of(mesh_data.mesh_of(each)) for each in (obj, evaluated))
    error = float(np.abs(displayed - points).max()) / size(points)
    if not error <= REST_ERROR:
        raise UserError(f"'{obj.name}' cannot follow its cage: it would move by {error:.1e} of its size at rest")


def _take_along(context: Context, originals: list[Object], space: Object, levels: list[Object]) -> str:
    """Makes the drawings follow, instead of the fine mesh if all can; returns which do, and why others do not."""
    fine, cage = levels[:2]
    problems = [] if originals else [f"The original object was deleted; '{fine.name}' follows"]
    for original in originals:
        try:
            if original.name not in context.view_layer.objects:
                raise UserError(f"'{original.name}' is not in this view layer")
            field.follow(original, cage, space)
        except UserError as error:
            problems.append(f"'{fine.name}' follows in place of '{original.name}': {error}")
    if not problems:
        fine.hide_set(True)
    followers = [original for original in originals if field.followed(original) == cage]
    return "; ".join([*([f"{_named(followers)} bound"] if followers else []), *problems])


def _named(objects: Sequence[Object]) -> str:
    """The names of few objects, or the number of many."""
    return ", ".join(f"'{o.name}'" for o in objects) if len(objects) <= MAX_NAMES else counted(len(objects), "drawing")


def _disconnect(levels: list[Object], *, lines_back: bool = True) -> None:
    """Lets go what follows the cages of sets, and removes their fields."""
    for obj in levels:
        field.release(obj)
        field.unpose(obj)
        display.render_lines(obj, True)
    ours = set(levels)
    for obj in [
        obj for obj in bpy.data.objects if cage_sets.has_node(obj) and not cage_sets.is_helper(obj, cage_sets.PROXY)
    ]:
        if field.followed(obj) in ours:
            field.release(obj)
    helpers: list[Object] = []
    for owner in levels:
        for helper in cage_sets.helpers_of(owner, cage_sets.FIELD, cage_sets.LINES):
            if lines_back and cage_sets.is_helper(helper, cage_sets.LINES):
                display.set_thickness(owner, cage_sets.node_of(helper).thickness)
            cage_sets.drop(cage_sets.new_node(owner).helpers, [helper])
            for modifier in list(helper.modifiers):
                display.remove_modifier(helper, modifier)
            helpers.append(helper)
    shape_keys.discard(helpers, [mesh_data.mesh_of(helper) for helper in helpers], ())
