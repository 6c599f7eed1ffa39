"""Registering twice in a row, presets, the tab of the panels, and a description on all that the user can touch."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from types import SimpleNamespace

import bpy
import pytest

from support.drawings import add, choose, circle, facts, poly_curve, star
from support.sources import ROOT


def test_the_add_on_can_be_disabled_and_enabled_again(extension) -> None:
    extension.unregister()
    assert not hasattr(bpy.types.Scene, "nested_cages")
    assert not hasattr(bpy.types, "OBJECT_OT_nested_cages_generate")
    extension.register()
    poly_curve("Drawing", [star()])
    assert bpy.ops.object.nested_cages_generate(levels="12") == {"FINISHED"}


def test_nothing_of_ours_is_called_once_the_add_on_is_disabled(extension) -> None:
    handlers = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    lists = [found for found in handlers if isinstance(found, list)]

    def ours():
        return [function for found in lists for function in found if function.__module__.startswith(extension.__name__)]

    count = 15 + hasattr(bpy.app.handlers, "blend_import_post")  # since Blender 4.3
    assert len(ours()) == count
    extension.unregister()
    assert ours() == []
    extension.register()
    assert len(ours()) == count


def test_everything_has_a_description(extension) -> None:
    rooms = (bpy.ops.object, bpy.ops.scene)
    operators = [getattr(room, name) for room in rooms for name in dir(room) if name.startswith("nested_cages_")]
    for rna in [bpy.types.Scene.bl_rna.properties["nested_cages"].fixed_type, *(op.get_rna_type() for op in operators)]:
        for prop in rna.properties:
            if prop.identifier not in {"rna_type", "name", "remove_name", "remove_active"}:
                assert prop.description, (rna.identifier, prop.identifier)
    for operator in operators:
        assert operator.get_rna_type().description


def test_all_properties_can_be_overridden(addon) -> None:
    """Else an override points into its library again after its file was loaded."""
    waiting = [owner.bl_rna.properties[name] for owner, name, *_ in addon.properties.schema.POINTERS]
    for prop in waiting:
        assert prop.is_overridable, prop.identifier
        if prop.type in {"POINTER", "COLLECTION"} and prop.fixed_type.base.identifier == "PropertyGroup":
            waiting += [each for each in prop.fixed_type.properties if each.identifier not in {"rna_type", "name"}]
    assert len(waiting) > 100


def test_polls_write_nothing(addon) -> None:
    poly_curve("Drawing", [circle(12)])
    others = [add(f"Other {k}", bpy.data.meshes.new("Other")) for k in range(3)]
    for caged in (False, True):
        if caged:
            assert bpy.ops.object.nested_cages_generate(levels="6") == {"FINISHED"}
        for obj in (*others, bpy.data.objects["Drawing"]):
            choose(obj)
            for name in dir(bpy.ops.object):
                if name.startswith("nested_cages_"):
                    getattr(bpy.ops.object, name).poll()
            bpy.context.view_layer.update()
        assert not any(obj.is_property_set("nested_cages_member") for obj in others)


def test_the_operator_and_the_scene_have_the_same_settings(extension, addon) -> None:
    operator = bpy.ops.object.nested_cages_generate.get_rna_type().properties
    for name in addon.properties.settings.NAMES:
        mine, scenes = operator[name], bpy.context.scene.nested_cages.bl_rna.properties[name]
        assert mine.description == scenes.description
        # The panel fits the animation to a length; scripts that give frames per step get what they ask for.
        assert mine.default == (scenes.default if name != "fit_length" else not scenes.default)


PRESETS = ("Collision", "Outline", "Rig", "Tight", pytest.param("IPC 2022 Repaired", marks=pytest.mark.slow))


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_sets_all_that_makes_a_cage_relative_to_the_drawing(addon, name) -> None:
    """Whatever was chosen before; cages are equally tight around a drawing of any size, but for the paper's method."""
    settings = bpy.context.scene.nested_cages
    own = {"show_result": False, "length": 77, "thickness": 0.25, "resolution": 5}
    strange = {"inside": True, "convex": True, "grid": 0.5, "symmetry": "FOUND", "pin_group": "Pins", "min_edge": 0.2}
    strange |= {"together": True, "clearance": 0.3, "level_objects": "Gone", "levels": "*, 7", "as_published": True}
    for key, value in (own | strange).items():
        setattr(settings, key, value)
    assert bpy.ops.scene.nested_cages_use_preset(name=name) == {"FINISHED"}
    kept = addon.operators.presets.KEPT
    chosen = addon.operators.presets.PRESETS[name][1]
    for key in addon.properties.settings.NAMES:
        if key not in kept:
            assert getattr(settings, key) == chosen.get(key, settings.bl_rna.properties[key].default), key
    assert {key: getattr(settings, key) for key in own} == own
    found = []
    for size in (1.0,) if chosen.get("as_published") else (1.0, 0.01):
        poly_curve(f"Drawing {size}", [star(100) * size])
        values = {key: getattr(settings, key) for key in addon.properties.settings.NAMES}
        assert bpy.ops.object.nested_cages_generate(**values) == {"FINISHED"}
        found.append(facts(bpy.data.objects[f"Drawing {size} Cage 1"])["excess"])
    assert found[-1] == pytest.approx(found[0], rel=0.05)
    with pytest.raises(RuntimeError, match="no preset 'Nothing': choose one of Collision"):
        bpy.ops.scene.nested_cages_use_preset(name="Nothing")


def test_the_panels_move_to_another_tab(extension) -> None:
    panels = sys.modules[f"{extension.__name__}.addon.ui.panels"]
    panels.move_to("Animation")
    assert bpy.types.VIEW3D_PT_nested_cages.bl_category == "Animation"
    panels.move_to(panels.CATEGORY)
    assert bpy.types.VIEW3D_PT_nested_cages.bl_category == "Nested Cages"


def test_a_missing_scipy_is_a_sentence(extension, addon, monkeypatch) -> None:
    poly_curve("Drawing", [star()])
    monkeypatch.delattr(extension, "nestedcages_core", raising=False)
    for name in list(sys.modules):
        if name.startswith(f"{extension.__name__}.nestedcages_core"):
            monkeypatch.delitem(sys.modules, name)
        elif name.partition(".")[0] == "scipy":
            monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(RuntimeError, match="Nested Cages needs scipy"):
        bpy.ops.object.nested_cages_generate(levels="12")


def test_appended_nodes_are_those_of_their_script(addon) -> None:
    """Nobody changes packaging/node_groups.py without `make nodes`; what is appended is there once, and local."""
    script = SimpleNamespace(**runpy.run_path(str(ROOT / "packaging" / "node_groups.py")))
    nodes = addon.scene.display
    found = [nodes.group(name) for name in script.GROUPS] + [nodes.material(name, "Own") for name in script.MATERIALS]
    for block in found:
        assert block.library is None and block[script.DIGEST] == script.digest(), block.name
    assert nodes.group(nodes.FILL) == bpy.data.node_groups[nodes.FILL] and len(bpy.data.node_groups) == len(
        script.GROUPS
    )
    assert not bpy.data.libraries
    # Blender 5.2 puts one before a linked level of subdivision, and logs a repair of the link each time.
    assert not [node for tree in bpy.data.node_groups for node in tree.nodes if node.bl_idname == "ShaderNodeClamp"]
    nodes.remove_unused()
    assert {tree.name for tree in bpy.data.node_groups} == {nodes.FILL, nodes.THICKNESS}


REGISTER = """
import importlib.util, os, sys
import bpy
spec = importlib.util.spec_from_file_location("extension", "__init__.py", submodule_search_locations=[os.getcwd()])
sys.modules["extension"] = extension = importlib.util.module_from_spec(spec)
spec.loader.exec_module(extension)
extension.register()
loaded = [name for name in sys.modules if name.partition(".")[0] == "scipy" or "nestedcages_core" in name]
extension.unregister()
print("loaded:", loaded, flush=True)
os._exit(0)
"""


@pytest.mark.slow
def test_registration_imports_neither_the_core_nor_scipy() -> None:
    done = subprocess.run(
        [sys.executable, "-c", REGISTER], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert "loaded: []" in done.stdout, done.stdout + done.stderr


def test_the_guide_names_the_operators_and_properties_that_are_there() -> None:
    text = (ROOT / "docs" / "guide" / "scripts.md").read_text(encoding="utf-8")
    operators = {name for name in dir(bpy.ops.object) if name.startswith("nested_cages_")}
    named = set()
    for names, about in re.findall(r"^\| (`nested_cages_.*?) \| (.*)\|$", text, flags=re.MULTILINE):
        row = set(re.findall(r"\w+", names))
        known = {"nested_cages_generate", "True"}
        for name in row & operators:
            for each in getattr(bpy.ops.object, name).get_rna_type().properties:
                known |= {each.identifier, *(item.identifier for item in getattr(each, "enum_items", ()))}
        assert {word for shown in re.findall(r"`(.*?)`", about) for word in re.split("[ =]", shown)} <= known, names
        named |= row
    assert named == operators - {"nested_cages_cancel"}
