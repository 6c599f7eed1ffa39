"""Registering twice in a row, the tab of the panels, and a description on all that the user can touch."""

import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

import bpy
import pytest
from bl_operators.wm import WM_OT_doc_view_manual as DocView

from support.blender import refused
from support.drawings import add, choose, circle, generate, poly_curve, star
from support.panels import own_settings
from support.sources import ROOT


def test_the_add_on_can_be_disabled_and_enabled_again(extension) -> None:
    handlers = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    lists = [found for found in handlers if isinstance(found, list)]

    def ours():
        return [function for found in lists for function in found if function.__module__.startswith(extension.__name__)]

    count = len(ours())
    assert count > 0
    extension.unregister()
    assert ours() == []
    assert not hasattr(bpy.types.Scene, "nested_cages")
    assert not hasattr(bpy.types, "OBJECT_OT_nested_cages_generate")
    extension.register()
    assert len(ours()) == count
    poly_curve("Drawing", [star()])
    generate("12")


def test_everything_has_a_description(extension) -> None:
    categories = (bpy.ops.object, bpy.ops.scene)
    operators = [
        getattr(category, name) for category in categories for name in dir(category) if name.startswith("nested_cages_")
    ]
    for rna in [bpy.types.Scene.bl_rna.properties["nested_cages"].fixed_type, *(op.get_rna_type() for op in operators)]:
        for prop in rna.properties:
            if prop.identifier not in {"rna_type", "name", "remove_name", "remove_active"}:
                assert prop.description, (rna.identifier, prop.identifier)
    for operator in operators:
        assert operator.get_rna_type().description


def test_f1_leads_to_a_heading_of_the_guide_about_each_operator_and_setting() -> None:
    """As Blender names them: operators, their settings in the redo panel, and those of the panel."""
    settings = own_settings()
    items = {f"types.NestedCagesSettings.{name}": "" for name in settings}
    for operator in (name for name in dir(bpy.ops.object) if name.startswith("nested_cages_")):
        known = getattr(bpy.ops.object, operator).get_rna_type().properties
        shown = [each for each in known if not each.is_hidden and each.identifier != "rna_type"]
        own = [each for each in shown if not operator.endswith("follow") or each.identifier not in settings]
        items |= {f"types.OBJECT_OT_{operator}.{each.identifier}": each.name for each in own}
        items[f"ops.object.{operator}"] = ""
    missing = []
    for name, label in items.items():
        page, _, place = DocView._lookup_rna_url(f"bpy.{name}", verbose=False).partition("#")
        assert page.startswith((ROOT / "docs/guide").as_uri())
        text = Path(unquote(urlsplit(page).path)).read_text(encoding="utf-8")
        parts = re.split(r"^#+ (.*)$", text, flags=re.MULTILINE)[1:]
        slugs = [re.sub(r"[^\w\- ]", "", each.lower()).replace(" ", "-") for each in parts[::2]]
        section = "".join(parts[2 * slugs.index(place) :][:2]) if place else text
        if label not in " ".join(section.split()):
            missing.append((name, label, place))
    assert missing == []


def test_all_properties_can_be_overridden() -> None:
    """Else an override points into its library again after its file was loaded."""
    waiting = [
        prop for owner in (bpy.types.Object, bpy.types.Scene) for prop in owner.bl_rna.properties
        if prop.identifier.startswith("nested_cages")
    ]  # fmt: skip
    for prop in waiting:
        assert prop.is_overridable, prop.identifier
        if prop.type in {"POINTER", "COLLECTION"} and prop.fixed_type.base.identifier == "PropertyGroup":
            waiting += [each for each in prop.fixed_type.properties if each.identifier not in {"rna_type", "name"}]
    assert len(waiting) > 50


def test_polls_write_nothing() -> None:
    poly_curve("Drawing", [circle(12)])
    others = [add(f"Other {k}", bpy.data.meshes.new("Other")) for k in range(3)]
    for caged in (False, True):
        if caged:
            generate("6")
        for obj in (*others, bpy.data.objects["Drawing"]):
            choose(obj)
            for name in dir(bpy.ops.object):
                if name.startswith("nested_cages_"):
                    getattr(bpy.ops.object, name).poll()
            bpy.context.view_layer.update()
        assert not any(list(obj.keys()) for obj in others)


def test_the_operator_and_the_scene_have_the_same_settings() -> None:
    operator = bpy.ops.object.nested_cages_generate.get_rna_type().properties
    scene = bpy.context.scene.nested_cages.bl_rna.properties
    names = own_settings()
    assert len(names) > 25
    for name in names:
        assert operator[name].description == scene[name].description
        # The panel fits the animation to a length; scripts that give frames per step get what they ask for.
        assert (operator[name].default == scene[name].default) == (name != "length")


def test_a_missing_scipy_is_a_sentence(extension, monkeypatch) -> None:
    poly_curve("Drawing", [star()])
    monkeypatch.delattr(extension, "nestedcages_core", raising=False)
    for name in list(sys.modules):
        if name.startswith(f"{extension.__name__}.nestedcages_core"):
            monkeypatch.delitem(sys.modules, name)
        elif name.partition(".")[0] == "scipy":
            monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, "scipy", None)
    with refused("scipy"):
        generate("12")


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
