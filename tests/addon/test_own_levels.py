"""Own objects as levels; the energies."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from support.drawings import at_frame, circle, evaluated, facts, poly_curve, solid, star
from support.marks import slow_after


def cages():
    found = [obj for obj in bpy.data.objects if facts(obj).get("level", 0) > 0]
    return sorted(found, key=lambda obj: facts(obj)["level"])


def test_own_objects_are_levels_among_others() -> None:
    own = poly_curve("Own", [circle(9, 2.5)])
    own.select_set(False)
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="20, *", level_objects="Own") == {"FINISHED"}
    assert [len(cage.data.vertices) for cage in cages()] == [20, 9]
    depsgraph = at_frame(9000)
    assert solid(cages()[1], depsgraph).contains(solid(cages()[0], depsgraph))


def test_an_own_object_may_be_selected_with_the_drawing() -> None:
    poly_curve("Drawing", [star()])
    poly_curve("Own", [circle(9, 2.5)])
    assert bpy.ops.object.nested_cages_generate(levels="*", level_objects="Own") == {"FINISHED"}
    assert [cage.name for cage in cages()] == ["Drawing Cage 1"]


@pytest.mark.parametrize(
    ("levels", "objects", "sentence"),
    [
        ("20, *", "", "1 of the levels should be an object of your own .*, and 0 are named: select your objects"),
        ("20, *", "Nobody", "'Nobody' is named as a level but is not in the scene"),
        ("20, *", "Empty", "'Empty' is named as a level but has no outline"),
        ("*", "Drawing", "Select the drawing too"),
    ],
)
def test_own_objects_that_cannot_be_levels_are_refused(levels, objects, sentence) -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Empty", None))
    poly_curve("Drawing", [star()])
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.object.nested_cages_generate(levels=levels, level_objects=objects)
    assert not cages()


def test_names_without_a_place_are_ignored() -> None:
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="20", level_objects="Nobody") == {"FINISHED"}


@pytest.mark.parametrize(
    "energy", slow_after(2, ["SHAPE_KEEPING", "INITIAL_DISPLACEMENT", "BOUNDARY_ARAP", "INTERIOR_ARAP"])
)
def test_each_energy_gives_its_own_certified_cage(core, energy) -> None:
    poly_curve("Drawing", [star()])
    shapes = []
    for wanted in ("AREA", energy):
        assert bpy.ops.object.nested_cages_generate(levels="16", energy=wanted) == {"FINISHED"}
        (cage,) = cages()
        depsgraph = at_frame(9000)
        fine = bpy.data.objects["Drawing Fine"]
        assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
        shapes.append((evaluated(cage, depsgraph), facts(cage)["excess"]))
    (tight, least), (other, more) = shapes
    assert np.abs(tight - other).max() > 1e-4
    assert more > least
