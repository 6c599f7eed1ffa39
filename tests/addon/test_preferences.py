"""F1 leads to pages that exist, and new files begin with the user's defaults."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import bpy
import pytest
from bl_operators.wm import WM_OT_doc_view_manual as DocView

from conftest import PACKAGE, ROOT


@pytest.fixture
def manual(extension):
    return sys.modules[f"{extension.__name__}.addon.manual"]


@pytest.fixture
def preferences(extension) -> Iterator[bpy.types.AddonPreferences]:
    """The add-on's preferences, as if it had been enabled by the user."""
    addon = bpy.context.preferences.addons.new()
    addon.module = PACKAGE
    yield addon.preferences
    for addon in list(bpy.context.preferences.addons):
        if addon.module == PACKAGE:
            bpy.context.preferences.addons.remove(addon)


@pytest.mark.parametrize(
    ("name", "page"),
    [
        ("bpy.ops.object.nested_cages_generate", "cages"),
        ("bpy.ops.object.nested_cages_verify", "verify"),
        ("bpy.ops.object.nested_cages_rebind", "bind"),
        ("bpy.ops.scene.nested_cages_level_add", "levels"),
        ("bpy.types.NestedCagesSettings.clearance", "levels"),
        ("bpy.types.NestedCagesSettings.ease", "animation"),
        ("bpy.types.NestedCagesSettings.thickness", "cages"),
        ("bpy.types.NestedCagesLevel.count", "levels"),
        ("bpy.types.NestedCagesPreferences.category", "cages"),
        ("bpy.types.OBJECT_OT_nested_cages_generate.resolution", "cages"),
    ],
)
def test_f1_leads_to_a_page_of_the_guide(manual, name, page) -> None:
    url = DocView._lookup_rna_url(name, verbose=False)
    assert url == f"{manual.REPOSITORY}docs/guide/{page}.md"


def test_all_pages_are_in_the_repository(manual) -> None:
    for _, page in manual.PAGES:
        assert (ROOT / page).is_file(), page


def test_other_pages_are_left_to_blender(extension) -> None:
    url = DocView._lookup_rna_url("bpy.types.Object.location", verbose=False)
    assert url is not None and "nested" not in url


def test_new_files_begin_with_the_users_defaults(preferences, tmp_path) -> None:
    settings = bpy.context.scene.nested_cages
    settings.levels, settings.energy, settings.ease, settings.clearance = "30%, 7", "SHAPE_KEEPING", True, 0.25
    saved = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=saved)
    assert bpy.ops.scene.nested_cages_store_defaults() == {"FINISHED"}
    preferences.defaults.frames_per_step = 9
    preferences.defaults.clearance = 0.5

    bpy.ops.wm.read_homefile(use_empty=True, load_ui=False)
    settings = bpy.context.scene.nested_cages
    assert (settings.levels, settings.energy, settings.ease) == ("30%, 7", "SHAPE_KEEPING", True)
    assert (settings.frames_per_step, settings.clearance) == (9, 0.5)
    assert [level.kind for level in settings.level_list] == ["PERCENT", "COUNT"]

    bpy.ops.wm.open_mainfile(filepath=saved)
    assert bpy.context.scene.nested_cages.clearance == 0.25
    assert bpy.context.scene.nested_cages.frames_per_step == 4


def test_without_own_defaults_new_files_are_as_they_were(preferences) -> None:
    preferences.defaults.levels = "9"
    bpy.ops.wm.read_homefile(use_empty=True, load_ui=False)
    assert bpy.context.scene.nested_cages.levels == "20%, 8%"


def test_defaults_cannot_be_stored_without_preferences(extension) -> None:
    assert not bpy.ops.scene.nested_cages_store_defaults.poll()
