"""A set of cages as a chain of objects: found from each of them, copied, deleted, saved and undone."""

from __future__ import annotations

import random
from typing import Any

import bpy
import numpy as np
import pytest

from support.drawings import choose, circle, evaluated, in_world, poly_curve, star, wire
from support.marks import slow_after

PARTS = ("Body", "Head", "Hat")


def figure(*, bind: bool = True) -> Any:
    """Three drawings in two common cages; their set."""
    from nested_cages_extension.addon.record import CageSet

    parts = [wire(name, [circle(24, 1.0, (0.0, 3.0 * k))]) for k, name in enumerate(PARTS)]
    choose(*reversed(parts))
    assert bpy.ops.object.nested_cages_generate(levels="24, 12", together=True, show_flow=False) == {"FINISHED"}
    if bind:
        assert bpy.ops.object.nested_cages_bind() == {"FINISHED"}
    return CageSet.of(parts[0])


def copied(*objects: Any, linked: bool = False) -> dict[str, Any]:
    """Duplicates of objects by the names of the originals."""
    choose(*objects)
    bpy.ops.object.duplicate(linked=linked)
    bpy.context.view_layer.update()
    return {obj.name.rpartition(".")[0]: obj for obj in bpy.context.selected_objects}


def displayed(obj: Any) -> Any:
    bpy.context.view_layer.update()
    return in_world(obj, evaluated(obj))


def save(path: Any, *, again: bool = False) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    if again:
        bpy.ops.wm.open_mainfile(filepath=str(path))


@pytest.mark.slow
def test_a_set_is_found_from_each_of_its_objects_and_knows_all_of_them(addon) -> None:
    made = figure()
    found = addon.record.CageSet.of
    assert all(found(obj) == made for obj in (*made.parts, *made.members))
    assert [obj.name for obj in made.parts] == list(PARTS) and made.fine.name == "Body Fine"
    assert list(made) == made.cages and [len(cage.data.vertices) for cage in made] == [24, 12] and len(made) == 2
    assert made.settings.levels == "24, 12" and made.bound == "HARMONIC" and not made.inside and made.missing == []
    certificates = made.certificates
    assert all(each.sentence.startswith("Certified as stored") and not each.edited for each in certificates)
    assert found(poly_curve("Other", [star()])) is None
    assert addon.record.CageSet.everywhere() == [made]


@pytest.mark.slow
@pytest.mark.parametrize("linked", slow_after(1, [False, True]))
def test_a_copy_of_what_is_seen_is_a_character_at_once_and_gets_its_own_when_it_is_changed(addon, linked) -> None:
    made = figure()
    before = {part.name: displayed(part) for part in made.parts}
    copies = copied(*made.parts, *made.cages, linked=linked)
    own = addon.record.CageSet.of(copies["Hat"])
    assert own.parts == [copies[name] for name in PARTS] and own.cages == [copies[cage.name] for cage in made]
    assert own.missing == ["'Body Fine' is shared with 'Body Cage 1'"] and made.missing == []
    own.cages[-1].location.x += 1.0  # as an object, which needs no mesh of its own
    for name in PARTS:
        np.testing.assert_allclose(displayed(copies[name]), before[name] + (1.0, 0.0, 0.0), atol=1e-5)
        np.testing.assert_allclose(displayed(bpy.data.objects[name]), before[name], atol=1e-6)
    for obj in own.parts:
        obj.location.y += 5.0
    for obj in [each for each in own.members if each.parent is None]:
        obj.location.y += 5.0
    np.testing.assert_allclose(displayed(copies["Body"]), before["Body"] + (1.0, 5.0, 0.0), atol=1e-5)
    choose(copies["Hat"])
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    assert own.missing == [] and not own.bound and made.bound and not {*own.members} & {*made.members}
    assert not {obj.data for obj in own.members} & {obj.data for obj in made.members}
    for name in PARTS:
        np.testing.assert_allclose(displayed(bpy.data.objects[name]), before[name], atol=1e-6)


@pytest.mark.slow
def test_partial_copies_are_no_more_than_what_was_copied(addon) -> None:
    made, found = figure(), addon.record.CageSet.of
    made.cages[-1].location.x += 0.5
    pose = displayed(made.parts[1])
    copies = copied(made.parts[0], *made.cages)
    one = found(copies["Body"])
    assert one.parts == [copies["Body"]] and "'Head' was not copied along" in one.missing
    assert len(made.parts) == 3 and made.missing == []
    alone = copied(made.parts[1])["Head"]
    assert found(alone) is None
    alone.location.y += 9.0
    np.testing.assert_allclose(displayed(alone), pose + np.array([0.0, 9.0, 0.0]), atol=1e-5)
    assert found(copied(made.cages[0])["Body Cage 1"]) is None
    assert found(copied(made.parts[2], made.cages[1])["Hat"]) is None  # the finest cage has the record
    finest = copied(made.parts[0], made.cages[0])
    few = found(finest["Body"])
    assert few.missing[:1] == ["'Body Fine' is shared with 'Body Cage 1'"] and len(few) == 1
    choose(finest["Body"])
    assert bpy.ops.object.nested_cages_unbind() == {"FINISHED"}
    assert len(few) == 2 and few.missing == [] and len(made.parts) == 3 and made.missing == []


def test_deleted_objects_are_told_and_swept(addon, tmp_path) -> None:
    made = figure(bind=False)
    choose(bpy.data.objects["Head"], made.cages[0])
    bpy.ops.object.delete()
    made = addon.record.CageSet.of(bpy.data.objects["Body"])
    assert made.missing == ["'Body Cage 1' was deleted", "'Head' was deleted"]
    assert [len(cage.data.vertices) for cage in made] == [12] and len(made.parts) == 2
    save(tmp_path / "swept.blend", again=True)
    made = addon.record.CageSet.of(bpy.data.objects["Hat"])
    assert made.missing == [] and [cage.name for cage in made] == ["Body Cage 2"] and len(made.parts) == 2
    assert made.settings.levels == "24, 12" and "Head" not in bpy.data.objects and made.source.name == "Body"
    bpy.data.objects.remove(bpy.data.objects["Body"])
    assert made.source.name == "Hat"


@pytest.mark.slow
def test_undo_and_redo_bring_sets_back(addon) -> None:
    parts = [wire(name, [circle(24, 1.0, (0.0, 3.0 * k))]) for k, name in enumerate(PARTS)]
    choose(*parts)
    bpy.ops.ed.undo_push(message="drawn")
    bpy.ops.object.nested_cages_generate(levels="12", together=True)
    bpy.ops.ed.undo_push(message="caged")
    found = addon.record.CageSet
    assert len(found.everywhere()) == 1
    bpy.ops.ed.undo()
    assert found.everywhere() == [] and found.of(bpy.data.objects["Head"]) is None
    bpy.ops.ed.redo()
    assert len(found.of(bpy.data.objects["Head"]).parts) == 3 and len(found.everywhere()) == 1


class Flock:
    """A figure and what becomes of it and its copies."""

    def __init__(self, addon: Any, path: Any, seed: int) -> None:
        self.sets, self.path, self.random = addon.record.CageSet, path, random.Random(seed)
        figure()

    def some(self) -> Any:
        found = sorted((each for each in self.sets.everywhere() if each.parts), key=lambda each: each.finest.name)
        return self.random.choice(found) if found else figure()

    def copy(self) -> None:
        made = self.some()
        copied(*made.parts, *made.cages, linked=self.random.random() < 0.3)

    def copy_some(self) -> None:
        made = self.some()
        copied(*self.random.sample([*made.parts, *made.cages], 2))

    def delete(self) -> None:
        made = self.some()
        choose(self.random.choice([*made.parts, *made.cages]))
        bpy.ops.object.delete()

    def operate(self) -> None:
        made = self.some()
        choose(made.parts[0])
        work = self.random.choice(("unbind", "rebind", "bind", "report"))
        operator = getattr(bpy.ops.object, f"nested_cages_{work}")
        if operator.poll():
            try:
                operator()
            except RuntimeError as error:
                assert "Traceback" not in str(error), error

    def generate(self) -> None:
        choose(self.some().parts[0])
        try:
            bpy.ops.object.nested_cages_generate(levels=self.random.choice(("12", "20, 10")))
        except RuntimeError as error:
            assert "Traceback" not in str(error), error

    def reload(self) -> None:
        save(self.path, again=True)
        deleted = [each for made in self.sets.everywhere() for each in made.missing if "deleted" in each]
        assert not [each for each in deleted if "Cage" not in each], deleted

    def undo(self) -> None:
        bpy.ops.ed.undo_push(message="before")
        self.copy()
        bpy.ops.ed.undo_push(message="copied")
        bpy.ops.ed.undo()

    def check(self) -> None:
        bpy.context.view_layer.update()
        cages: list[Any] = []
        for made in self.sets.everywhere():
            assert all(made in self.sets.all_of(obj) for obj in (*made.parts, *made.cages))
            if made.bound:
                followed = [part.modifiers["Nested Cages Follow"] for part in made.parts if part.modifiers]
                assert len(followed) == len(made.parts)
            cages += made.cages
            assert all(np.isfinite(displayed(part)).all() for part in made.parts)
        assert len(cages) == len(set(cages))


@pytest.mark.parametrize("seed", slow_after(0, range(6), thorough_after=2))
def test_random_edits_of_a_flock(addon, tmp_path, seed) -> None:
    flock = Flock(addon, tmp_path / "flock.blend", seed)
    edits = (flock.copy, flock.copy_some, flock.delete, flock.operate, flock.operate, flock.generate, flock.reload)
    for _ in range(10):
        flock.random.choice((*edits, flock.undo))()
        flock.check()
