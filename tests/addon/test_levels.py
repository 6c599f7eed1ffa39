"""Levels as users write them: counts, shares, distances, excesses, own objects; and cages inside the drawing."""

import bpy
import numpy as np
import pytest
import shapely
from mathutils import Matrix

from support import drawings
from support.blender import refused
from support.drawings import at_frame, certificate, choose, circle, generate, holds, made, poly_curve, solid, star
from support.marks import slow_after
from support.panels import draw

pytestmark = pytest.mark.slow


def counts(name: str = "Drawing") -> list[int]:
    """Numbers of vertices of the cages around a drawing."""
    return [len(cage.data.vertices) for cage in made(name)[1:]]


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        *((text, [40, 24]) for text in ("40, 24", "40 24", " 40;24 ", "40,, 24,")),
        ("7", [7]),
        ("24, 40", [40, 24]),  # the finest comes first
        ("50%, 20 %", [30, 12]),
        ("33.4%", [20]),
        ("61", [60]),  # no more than the drawing has
        ("20%, 21", [21, 12]),
        ("2", [3]),
        ("1%", [3]),
    ],
)
def test_levels_are_counts_and_shares(text: str, wanted: list[int]) -> None:
    poly_curve("Drawing", [star()])
    generate(text)
    assert counts() == wanted
    assert bool(certificate(made()[-1]).notes) or text not in {"61", "2", "1%"}  # and it is said


REFUSED = ["", "  ", "x", "64, x", "-3", "1.5", "%", ",", "1e3", "0", "120%", "2 px", "+2m", "0mm", "12, *"]


@pytest.mark.parametrize("text", REFUSED)
def test_other_texts_are_refused(text: str) -> None:
    poly_curve("Drawing", [star()])
    with refused():
        generate(text)


def test_a_count_holds_where_loops_are_in_each_others_way_unless_all_are_kept() -> None:
    poly_curve("Drawing", [circle(40, size) for size in (4.0, 3.9, 3.8)])
    generate("12")
    assert counts()[0] <= 12 and certificate(made()[1]).notes and not certificate(made()[1]).keeps_loops
    with refused("'Drawing'"):
        generate("12", loops="keep")


def test_own_objects_are_levels_among_others(extension) -> None:
    own = poly_curve("Own", [circle(9, 2.5)])
    own.select_set(False)
    poly_curve("Drawing", [star()])
    extension.cages([bpy.data.objects["Drawing"]], [20, own])
    assert counts() == [20, 9]
    depsgraph = at_frame(9000)
    assert solid(made()[2], depsgraph).contains(solid(made()[1], depsgraph))


@pytest.mark.parametrize("levels", ["20, *", "*"])
def test_own_objects_are_named_by_the_function_for_scripts_alone(levels) -> None:
    poly_curve("Drawing", [star()])
    with refused("'Drawing'"):
        generate(levels)


def farthest(cage: shapely.Geometry, fine: shapely.Geometry) -> float:
    """Hausdorff distance from the cage's solid to the drawing's, by shapely."""
    return shapely.hausdorff_distance(cage, fine, densify=0.01)


@pytest.mark.parametrize("scale", slow_after(1, [1.0, 1000.0, 0.001], thorough_after=1))
def test_a_distance_is_kept_in_units_of_the_scene(scale) -> None:
    obj = poly_curve("Drawing", [circle(90)])
    obj.scale = (scale, scale, scale)
    generate(f"{0.03 * scale:.9g}u, {0.1 * scale:.9g} u")
    fine, finer, coarser = made()
    depsgraph = at_frame(9000)
    shapes = [solid(each, depsgraph) for each in (fine, finer, coarser)]
    assert shapes[1].contains_properly(shapes[0])
    assert shapes[2].contains_properly(shapes[1])
    for cage, shape, most in ((finer, shapes[1], 0.03), (coarser, shapes[2], 0.1)):
        assert farthest(shape, shapes[0]) <= most * (1 + 1e-5)
        assert f"{most * scale:g}" in certificate(cage).need
    assert len(coarser.data.vertices) < len(finer.data.vertices)


def test_units_of_the_scene_are_understood() -> None:
    bpy.context.scene.unit_settings.scale_length = 0.01
    poly_curve("Drawing", [circle(60, 100.0)])
    generate("50 mm")
    cage = made()[1]
    fine = made()[0]
    depsgraph = at_frame(9000)
    assert certificate(cage).need and 0.5 < farthest(solid(cage, depsgraph), solid(fine, depsgraph)) <= 5.0


def test_an_excess_is_of_the_drawing_on_every_level() -> None:
    poly_curve("Drawing", [star()])
    generate("40, +20%, +50 %")
    fine, *cages = made()
    depsgraph = at_frame(9000)
    area = solid(fine, depsgraph).area
    excesses = [solid(cage, depsgraph).area / area - 1.0 for cage in cages]
    assert excesses[1] <= 0.2 + 1e-7
    assert excesses[2] <= 0.5 + 1e-7
    assert [len(cage.data.vertices) for cage in cages] == sorted((len(c.data.vertices) for c in cages), reverse=True)
    assert not certificate(cages[0]).need and certificate(cages[2]).need


def test_an_excess_that_cannot_be_is_refused() -> None:
    poly_curve("Drawing", [star()])
    for levels in ("+0.00001%", "1e-9u"):
        with refused("'Drawing'"):
            generate(levels)


def test_the_panel_says_what_levels_come_to() -> None:
    poly_curve("Drawing", [circle(60, 2.0)])
    settings = bpy.context.scene.nested_cages
    settings.levels = "20%, 5 cm, +25%, 12"
    bpy.context.view_layer.update()
    said = " ".join(draw())
    assert "20 % = 12" in said and "0.884" in said and "1.25" in said  # five centimetres are so much of the size
    settings.levels = "12 apples"
    assert not any("0.884" in text for text in draw())


def test_inner_cages_lie_inside_and_play() -> None:
    obj = poly_curve("Drawing", [star(80)])
    generate("24, 10", inside=True)
    fine, first, second = made(inside=True)
    names = [f"Drawing Inner {name}" for name in ("Fine", "Cage 1", "Cage 2")]
    assert [each.name for each in (fine, first, second)] == names
    assert bpy.context.scene.frame_current == drawings.end_of(second)
    for outer, cage in ((fine, first), (first, second)):
        begin, end = certificate(cage).frames[1], certificate(cage).frames[3]
        assert end > begin + 5
        for frame in np.linspace(begin, end, 12):
            depsgraph = at_frame(frame)
            assert not drawings.lines(outer, depsgraph).intersects(drawings.lines(cage, depsgraph)), (cage.name, frame)
    depsgraph = at_frame(9000)
    for outer, cage in ((fine, first), (first, second)):
        excess = solid(cage, depsgraph).area / solid(outer, depsgraph).area - 1.0
        assert -1.0 < excess < 0.0 and certificate(cage).excess == pytest.approx(excess, abs=1e-5)
    assert obj.visible_get()
    # the first shape of a cage is looser than the last one
    assert len(first.data.shape_keys.key_blocks) > 2


def test_cages_around_and_inside_are_kept_side_by_side_and_replaced_each_by_its_own() -> None:
    obj = poly_curve("Drawing", [star()])
    generate("20")
    outer = made()
    generate("16, 10", inside=True)
    assert made() == outer
    inner = made(inside=True)
    generate("12", inside=True)
    assert made(inside=True) == inner[:2]
    assert len(inner[1].data.vertices) == 12
    generate("18")
    assert made() == outer
    assert len(outer[1].data.vertices) == 18
    assert len(bpy.data.collections) == 2
    assert tuple(outer[1].color) != tuple(inner[1].color)
    for frame in (1, 9000):
        at_frame(frame)
        shown = [each for each in (inner[1], inner[0], outer[1]) if not each.hide_viewport]
        if frame == 9000:
            assert shown == [inner[1], inner[0], outer[1]]
    assert obj.visible_get()
    assert [each.inside for each in drawings.sets().all_of(obj)] == [False, True]


def test_inner_cages_are_verified() -> None:
    obj = poly_curve("Drawing", [star()])
    generate("20")
    generate("16, 10", inside=True)
    _, first, second = made(inside=True)
    bpy.ops.object.nested_cages_remove_animation()
    bpy.context.view_layer.objects.active = obj
    assert drawings.verify(first, second, made()[1])
    choose(first)
    bpy.ops.object.nested_cages_remove_animation()
    first.data.transform(Matrix.Scale(1.2, 4))
    first.data.update()
    drawings.verify()
    assert holds(first) is False and "'Drawing Inner Fine'" in certificate(first).finding
    assert first.select_get()


def test_selected_cages_of_both_sides_are_one_chain() -> None:
    poly_curve("Drawing", [star()])
    generate("20")
    generate("16, 10", inside=True)
    at_frame(9000)
    around, (_, first, second) = made()[1], made(inside=True)
    choose(second, around, first)
    assert bpy.ops.object.nested_cages_verify() == {"FINISHED"}
    assert holds(around) and "'Drawing Inner Cage 1'" in certificate(around).finding
    assert holds(second) and "'Drawing Inner Cage 1'" in certificate(second).finding


def test_inner_cages_move_nothing_and_say_so() -> None:
    poly_curve("Drawing", [star()])
    generate("16", inside=True)
    for operator in ("bind", "live"):
        assert not getattr(bpy.ops.object, f"nested_cages_{operator}").poll()
    for name, options in (
        ("bind", {}),
        ("puppet", {"source": "HANDLES"}),
        ("follow", {"levels": "16", "inside": True}),
        ("follow", {"levels": "2u"}),
        ("generate", {"levels": "20, +5%", "inside": True}),
    ):
        with refused():
            getattr(bpy.ops.object, f"nested_cages_{name}")(**options)


def test_scripts_get_inner_cages_and_needs(extension, core) -> None:
    obj = poly_curve("Drawing", [star()])
    ((first, second),) = extension.cages([obj], [20, 0.15], inside=True)
    assert first.name == "Drawing Inner Cage 1"
    assert len(second.data.vertices) == 9
    ((near, wide),) = extension.cages([obj], [core.Within(distance=0.05), core.Within(excess=0.5)])
    fine, outer, wider = (
        core.Mesh(drawings.base(each)[:, :2].astype(float), drawings.edges_of(each)) for each in made()
    )
    assert core.Within(distance=0.05).is_met(outer, fine) and core.Within(excess=0.5).is_met(wider, fine)
    assert certificate(near).need and certificate(wide).need
