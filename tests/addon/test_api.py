"""The function for scripts: objects in, cages out."""

from types import ModuleType

import bpy
import pytest

from support.drawings import certificate, circle, poly_curve, snapshot, star, wire


def drawings() -> list[bpy.types.Object]:
    one, two = poly_curve("One", [star()]), wire("Two", [circle(40, 1.0, (4.0, 0.0))])
    bpy.ops.object.select_all(action="DESELECT")
    return [one, two]


@pytest.mark.slow
def test_the_cages_of_each_object_come_back(extension: ModuleType) -> None:
    one, two = drawings()
    bpy.context.view_layer.objects.active = two
    made = extension.cages([one, two], (24, 12), clearance=0.01)
    assert [[cage.name for cage in cages] for cages in made] == [
        ["One Cage 1", "One Cage 2"],
        ["Two Cage 1", "Two Cage 2"],
    ]
    assert [[len(cage.data.vertices) for cage in cages] for cages in made] == [[24, 12], [24, 12]]
    assert all(certificate(cage).clearance >= 0.01 for cages in made for cage in cages)
    assert bpy.context.selected_objects == [] and bpy.context.view_layer.objects.active == two
    assert bpy.context.scene.frame_current == 1


@pytest.mark.parametrize(("levels", "counts"), [("20, 10", [20, 10]), (15, [15]), (0.2, [12]), ([0.5, 8], [30, 8])])
def test_levels_of_every_kind(extension: ModuleType, levels: object, counts: list[int]) -> None:
    one, _ = drawings()
    (made,) = extension.cages([one], levels)
    assert [len(cage.data.vertices) for cage in made] == counts


def test_own_coarse_meshes_are_levels(extension: ModuleType) -> None:
    one, _ = drawings()
    own = wire("Own", [circle(9, 1.4)])
    (made,) = extension.cages([one], [20, own])
    assert [len(cage.data.vertices) for cage in made] == [20, 9]


def test_all_in_one(extension: ModuleType) -> None:
    (made,) = extension.cages(drawings(), 24, together=True)
    assert len(made) == 1


def test_what_cannot_be_caged_has_no_cages_though_it_had_some(extension: ModuleType) -> None:
    one, two = drawings()
    extension.cages([one, two], 12)
    two.data.vertices[0].co = (4.0, 2.0, 3.0)
    before = bpy.data.objects.keys()
    made = extension.cages([one, two], 12)
    assert [len(cages) for cages in made] == [1, 0] and bpy.data.objects.keys() == before


@pytest.mark.parametrize("settings", [{"levels": "many"}, {"levels": 2.5}, {"colour": "red"}, {"energy": "MOST"}])
def test_what_is_wrong_is_an_error_and_nothing_changes(extension: ModuleType, settings: dict) -> None:
    objects = drawings()
    before = snapshot()
    with pytest.raises(ValueError, match=str(next(iter(settings.values()))) + "|" + next(iter(settings))):
        extension.cages(objects, **settings)
    assert snapshot() == before


def test_objects_that_cannot_be_caged_are_named(extension: ModuleType) -> None:
    one, two = drawings()
    two.hide_set(True)
    with pytest.raises(ValueError, match="'Two'"):
        extension.cages([one, two], 12)
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    with pytest.raises(ValueError, match="'Eye'"):
        extension.cages([camera])
    for wrong in ([], ["A"], [None], "A"):
        with pytest.raises(ValueError):
            extension.cages(wrong)
