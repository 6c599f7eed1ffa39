"""Every choice of a method gives the core's object that it is called after, and a certified cage."""

from __future__ import annotations

from dataclasses import replace

import bpy
import pytest

from support.drawings import at_frame, facts, lines, poly_curve, solid, star

# What each choice is in the core, told apart from the add-on's own table.
EXPECTED = {
    ("decimation", "ON_CURVE"): "LineCycles(",
    ("decimation", "OUTER_HULL"): "OuterHull(",
    ("decimation", "ARC_LENGTH"): "ArcLength()",
    ("energy", "AREA"): "Area()",
    ("energy", "SHAPE_KEEPING"): "ShapeKeeping(",
    ("energy", "INITIAL_DISPLACEMENT"): "InitialDisplacement()",
    ("energy", "STEP_DISPLACEMENT"): "StepDisplacement()",
    ("energy", "BOUNDARY_ARAP"): "BoundaryARAP()",
    ("energy", "INTERIOR_ARAP"): "InteriorARAP()",
}


def test_the_table_is_complete(addon) -> None:
    table = {"decimation": addon.generation.methods.DECIMATIONS, "energy": addon.generation.methods.ENERGIES}
    assert {(name, key) for name, choices in table.items() for key in choices} == set(EXPECTED)
    for choices in table.values():
        for key, name, description in addon.generation.methods.items(choices):
            assert key.isupper() and name and len(description) > 15, (key, name)
            assert not description.endswith("."), key  # Blender adds it


@pytest.mark.parametrize(("name", "key"), EXPECTED)
def test_each_choice_is_the_object_that_it_is_called_after(addon, core, name, key) -> None:
    methods = addon.generation.methods.Methods(**{name: key})
    assert repr(getattr(methods.settings(), name)).startswith(EXPECTED[name, key])


def test_untouched_they_are_the_core_s_own(addon, core) -> None:
    methods = addon.generation.methods.Methods
    assert methods().settings() == core.Settings()
    assert addon.properties.settings.filled(methods, bpy.context.scene.nested_cages) == methods()
    assert methods(fall_back=False).settings() == core.Settings(fallback=None)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "key"), [*EXPECTED, ("fall_back", False), ("as_published", True)])
def test_each_choice_makes_a_certified_cage(addon, name, key) -> None:
    poly_curve("Drawing", [star(24)])
    assert bpy.ops.object.nested_cages_generate(levels="10", **{name: key}) == {"FINISHED"}
    fine, cage = bpy.data.objects["Drawing Fine"], bpy.data.objects["Drawing Cage 1"]
    assert facts(cage)["certificate"].startswith("Certified as stored")
    depsgraph = at_frame(facts(cage)["end"])
    assert solid(cage, depsgraph).contains(solid(fine, depsgraph))
    assert lines(cage, depsgraph).distance(lines(fine, depsgraph)) > 0.0


def test_presets_keep_the_methods(addon, tmp_path, monkeypatch) -> None:
    assert {f"settings.{name}" for name in addon.properties.settings.NAMES} == set(
        bpy.types.SCENE_OT_nested_cages_preset_add.preset_values
    )
    monkeypatch.setattr(bpy.utils, "user_resource", lambda *_, **__: str(tmp_path))
    settings = bpy.context.scene.nested_cages
    settings.energy, settings.as_published, settings.fall_back = "SHAPE_KEEPING", True, False
    assert bpy.ops.scene.nested_cages_preset_add(name="Mine") == {"FINISHED"}
    (stored,) = tmp_path.rglob("*.py")
    settings.energy, settings.as_published, settings.fall_back = "AREA", False, True
    bpy.ops.script.execute_preset(filepath=str(stored), menu_idname="NESTEDCAGES_PT_presets")
    assert (settings.energy, settings.as_published, settings.fall_back) == ("SHAPE_KEEPING", True, False)


def test_the_preset_of_the_paper_is_the_core_s_definition(addon, core) -> None:
    """What benchmarks compare is what the preset makes; another energy is that of its contact too."""
    bpy.ops.scene.nested_cages_use_preset(name="IPC 2022 Repaired")
    made = addon.properties.settings.filled(addon.generation.methods.Methods, bpy.context.scene.nested_cages)
    assert made.settings() == core.AUGMENTED_2022_REPAIRED
    other = replace(made, energy="SHAPE_KEEPING").settings()
    assert other.energy == other.contact.energy == core.ShapeKeeping()
