"""F1 and "Online Manual": the page of the documentation about what the pointer is on."""

from __future__ import annotations

import bpy

# Where the repository's files can be read; the only place that knows.
REPOSITORY = "https://github.com/nested-cages/nested-cages/blob/main/"
GUIDE = "docs/guide/"
# What Blender calls things, in small letters with wildcards, and the page about them. The first that fits counts.
PAGES = (
    *(
        (f"bpy.ops.object.nested_cages_{name}*", f"{GUIDE}{page}")
        for name, page in (
            ("verify", "verify.md"),
            ("bind", "bind.md"),
            ("rebind", "bind.md"),
            ("unbind", "bind.md"),
            ("bake_action", "animation.md"),
            ("remove_animation", "animation.md"),
            ("to_objects", "export.md"),
            ("export", "export.md"),
            ("from_image", "pictures.md"),
        )
    ),
    *(
        (f"bpy.types.*nestedcages*.{name}*", f"{GUIDE}{page}")
        for name, page in (
            ("level", "levels.md"),
            ("use_selected_as_levels", "own_meshes.md"),
            ("clearance", "levels.md"),
            ("decimation", "levels.md"),
            ("energy", "levels.md"),
            ("start_frame", "animation.md"),
            ("frames_per_step", "animation.md"),
            ("show_", "animation.md"),
            ("ease", "animation.md"),
            ("loop_back", "animation.md"),
        )
    ),
    ("bpy.types.nestedcageslevel*", f"{GUIDE}levels.md"),
    ("bpy.ops.scene.nested_cages_level*", f"{GUIDE}levels.md"),
    ("bpy.ops.*.nested_cages*", f"{GUIDE}cages.md"),
    ("bpy.types.*nested_cages*", f"{GUIDE}cages.md"),
    ("bpy.types.*nestedcages*", f"{GUIDE}cages.md"),
)


def manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    """The prefix of all pages, and the pages."""
    return REPOSITORY, PAGES


def register() -> None:
    bpy.utils.register_manual_map(manual_map)


def unregister() -> None:
    bpy.utils.unregister_manual_map(manual_map)
