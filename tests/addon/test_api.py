"""The function for scripts: objects in, cages out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import bpy
import pytest

from support.drawings import circle, facts, poly_curve, snapshot, star, wire

ROOT = Path(__file__).resolve().parents[2]


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
    assert all(facts(cage)["clearance"] >= 0.01 for cages in made for cage in cages)
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
    made = extension.cages([one, two], 12)
    assert [len(cages) for cages in made] == [1, 0]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"levels": "many"}, "'many' is none of these"),
        ({"levels": 2.5}, "between 0 and 1"),
        ({"colour": "red"}, "There is no setting 'colour'"),
    ],
)
def test_what_is_wrong_is_told_and_nothing_changes(extension: ModuleType, settings: dict, message: str) -> None:
    objects = drawings()
    before = snapshot()
    with pytest.raises(ValueError, match=message):
        extension.cages(objects, **settings)
    assert snapshot() == before


def test_objects_that_cannot_be_caged_are_named(extension: ModuleType) -> None:
    one, two = drawings()
    two.hide_set(True)
    with pytest.raises(ValueError, match="'Two' is not visible"):
        extension.cages([one, two], 12)
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    with pytest.raises(ValueError, match="'Eye' has no outline"):
        extension.cages([camera])
    with pytest.raises(ValueError, match="No objects"):
        extension.cages([])
    for wrong in (["A"], [None], "A"):
        with pytest.raises(ValueError, match="is not an object: give objects"):
            extension.cages(wrong)


@pytest.mark.slow
def test_the_example_writes_one_file_per_object(tmp_path: Path) -> None:
    command = [sys.executable, "examples/one_file_each.py", "--output", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=170, check=False)
    assert done.returncode == 0, done.stderr
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["0026.svg", "0041.svg", "0051.svg", "0052.svg", "03c0.svg", "20ac.svg"]
    assert all("<path" in path.read_text() for path in tmp_path.iterdir())
    assert done.stdout.count("2 cages") == 6
