"""F1 and "Online Manual": the page of the documentation about what the pointer is on."""

from __future__ import annotations

import bpy

# Where the repository's files can be read; the only place that knows.
REPOSITORY = "https://github.com/nested-cages/nested-cages/blob/main/"
# What Blender calls things, in small letters with wildcards, and the page about them in the repository.
PAGES = (
    ("bpy.ops.object.nested_cages_verify*", "README.md#what-is-guaranteed"),
    ("bpy.ops.object.nested_cages*", "README.md#five-steps-in-blender"),
    ("bpy.ops.scene.nested_cages*", "README.md#five-steps-in-blender"),
    ("bpy.types.nestedcages*", "README.md#five-steps-in-blender"),
    ("bpy.types.object_ot_nested_cages*", "README.md#five-steps-in-blender"),
)


def manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    """The prefix of all pages, and the pages."""
    return REPOSITORY, PAGES


def register() -> None:
    bpy.utils.register_manual_map(manual_map)


def unregister() -> None:
    bpy.utils.unregister_manual_map(manual_map)
