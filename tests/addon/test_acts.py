"""What artists do to sets of cages with Blender's own tools, and what of the sets is there then."""

from typing import Any

import bpy
import pytest

from support.blender import new_file
from support.drawings import armature, bezier_circle, choose, circle, generate, save, set_of, sets, wire
from support.marks import slow_after


def circles(count: int = 1, levels: str = "8", **settings: Any) -> Any:
    """Drawings P0, P1 ... with cages; their sets by `cages`, the function for scripts."""
    parts = [wire(f"P{k}", [circle(16, 1.0, (3.0 * k, 0.0))]) for k in range(count)]
    choose(*reversed(parts))
    generate(levels, show_flow=False, **settings)
    return set_of(parts[0])


def names(found: Any) -> tuple[list[str], list[str]] | None:
    return None if found is None else ([part.name for part in found.parts], [cage.name for cage in found])


ONE = (["P0"], ["P0 Cage 1"])


@pytest.mark.parametrize("bound", slow_after(1, [True, False]))
def test_a_cage_with_another_parent_or_without_one_stays_in_its_set(bound: bool) -> None:
    found = circles()
    drawing, cage = found.source, found.cages[0]
    if bound:
        bpy.ops.object.nested_cages_bind()
    rig = armature("Arm", Bone=((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    choose(cage, rig)
    bpy.ops.object.parent_set(type="ARMATURE")
    assert cage.parent == rig and names(set_of(drawing)) == ONE
    choose(drawing)
    generate("7", show_flow=False)
    assert names(set_of(drawing)) == ONE and set_of(drawing).cages == [cage] and len(cage.data.vertices) == 7
    assert cage.parent == rig and "ARMATURE" in [modifier.type for modifier in cage.modifiers]
    choose(cage)
    bpy.ops.object.parent_clear(type="CLEAR_KEEP_TRANSFORM")
    assert cage.parent is None and names(set_of(cage)) == ONE and bool(set_of(cage).bound) is bound


def test_cages_of_a_curve_with_a_path_stay_and_are_copied_with_it() -> None:
    """Children of such a curve would follow the path: its cages follow by a constraint."""
    curve = bezier_circle("P0")
    curve.data.use_path, curve.data.eval_time = True, 30.0
    generate("8", show_flow=False)
    (cage,) = set_of(curve)
    assert cage.parent is None and [each.type for each in cage.constraints] == ["CHILD_OF"]
    assert cage.matrix_world.translation.length < 1e-6
    choose(cage, curve)
    bpy.ops.object.duplicate()
    assert names(set_of(bpy.data.objects["P0.001"])) == (["P0.001"], ["P0 Cage 1.001"])


def test_undo_takes_common_cages_back_and_redo_makes_them_again() -> None:
    for k in range(2):
        wire(f"P{k}", [circle(16, 1.0, (3.0 * k, 0.0))])
    bpy.ops.ed.undo_push(message="drawn")
    generate("24", together=True, show_flow=False)
    bpy.ops.ed.undo_push(message="generated")
    bpy.ops.ed.undo()
    assert not sets().everywhere() and set_of(bpy.data.objects["P0"]) is None
    bpy.ops.ed.redo()
    assert len(sets().everywhere()) == 1 and len(set_of(bpy.data.objects["P1"]).parts) == 2


@pytest.mark.parametrize("which", slow_after(1, ["P0 Cage 2", "P0", "P0 Cage 1", "", "bound"]))
def test_any_object_of_a_set_brings_all_of_it_into_another_file(which: str, tmp_path) -> None:
    """No objects of meshes that a binding keeps for later, of which Blender 4.2 tells nothing."""
    circles(levels="12, 8")
    if which == "bound" and bpy.app.version >= (4, 3):
        bpy.ops.object.nested_cages_bind()
    there, path = sorted(obj.name for obj in bpy.data.objects), save(tmp_path / "set.blend")
    new_file()
    files = [{"name": name} for name in ({"": ["P0", "P0 Cage 1", "P0 Cage 2"], "bound": there}.get(which) or [which])]
    bpy.ops.wm.append(directory=f"{path}/Object/", filename=files[0]["name"], files=files, instance_object_data=True)
    assert sorted(obj.name for obj in bpy.data.objects) == there
    assert names(set_of(bpy.data.objects["P0"])) == (["P0"], ["P0 Cage 1", "P0 Cage 2"])


@pytest.mark.slow
def test_a_drawing_of_another_file_has_cages_here(tmp_path) -> None:
    wire("P0", [circle(16)])
    path = save(tmp_path / "library.blend")
    new_file()
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["P0"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    for levels in ("8", "7"):
        bpy.context.view_layer.update()
        drawing = next(obj for obj in bpy.data.objects if obj.library is not None)
        choose(drawing)
        generate(levels, show_flow=False)
        save(tmp_path / "home.blend", again=True)
        drawing = next(obj for obj in bpy.data.objects if obj.library is not None)
        assert names(set_of(drawing)) == ONE and len(set_of(drawing).cages[0].data.vertices) == int(levels)
