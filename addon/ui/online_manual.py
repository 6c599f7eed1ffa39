"""The page of the guide, which comes with the add-on, about the item under the pointer: F1 and "Online Manual"."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..generate.groups import ANIMATION, FRAMES, GROUPS, LOOKS, READING, SHAPE

# The folder of the extension, or of the repository.
ROOT = Path(__file__).resolve().parents[2]
# The guide in the extension's zip, and in the repository; the first one that exists is shown.
GUIDES = ((ROOT / "manual" / "docs" / "guide", ".html"), (ROOT / "docs" / "guide", ".md"))
# Suffixes of operators, prefixes of settings, and the page about each, with the heading that is not its first.
OPERATORS = {
    "verify": "verify",
    "bind": "bind",
    "remove_animation": "animation#remove-animation-keep-cages",
    "follow": "animation#follow-a-moving-drawing",
    "live": "animation#live",
    "export": "export#export",
    "import": "export#import",
    "cutout": "pictures#cutout",
    **dict.fromkeys(("puppet", "walk", "snap"), "characters#puppet"),
    "select_fault": "messages",
    "generate": "cages",
}
# The same of settings that are about something else than their operator.
OWN = {
    "import.hidden": "godot#in-blender",
    **dict.fromkeys(("import.repaint", "import.replace_weights"), "godot#repaint"),
    **dict.fromkeys(("import.vertices", "import.padding", "import.threshold"), "pictures#outline-of-selected"),
    **dict.fromkeys(("import.gap", "import.holes"), "silhouette"),
    **dict.fromkeys(("puppet.gap", "puppet.vertices"), "characters#one-cage"),
}
# Settings of cages.
SETTINGS = {
    "levels": "cages#vertices",
    "clearance": "cages#clearance",
    "inside": "cages#cage-inside",
    "together": "cages#all-in-one",
    "use_selected_as_levels": "cages#selected-as-cages",
    **dict.fromkeys((*READING, *SHAPE, *LOOKS), "cages#advanced"),
    "convex": "constraints#convex",
    "grid": "constraints#grid",
    "loops": "constraints#loops",
    "symmetry": "constraints#symmetry",
    "directions": "constraints#edges",
    **dict.fromkeys(GROUPS, "constraints#weights-and-pins"),
    "joint_armature": "constraints#joints",
    **dict.fromkeys(("min_edge", "min_angle"), "constraints#shortest-edge-and-sharpest-angle"),
    **dict.fromkeys((*FRAMES, *ANIMATION), "animation#how-cages-form"),
}
WITH_SETTINGS = ("nestedcages*", "object_ot_nested_cages_generate", "object_ot_nested_cages_follow")
# Blender's names of items, in lower case with wildcards, and the page about them. The first match counts.
PAGES = (
    *((f"bpy.types.object_ot_nested_cages_{name}*", page) for name, page in OWN.items()),
    *((f"bpy.types.{kind}.{name}*", page) for name, page in SETTINGS.items() for kind in WITH_SETTINGS),
    *((f"bpy.types.object_ot_nested_cages_{name}.*", page) for name, page in OPERATORS.items()),
    *((f"bpy.ops.object.nested_cages_{name}*", page) for name, page in OPERATORS.items()),
    ("bpy.types.nestedcagespreferences*", "install"),
    ("bpy.*nested*cages*", "cages"),
)


def manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    """The prefix of all pages, and the pages; none without the guide."""
    shown = next((guide for guide in GUIDES if guide[0].is_dir()), None)
    if shown is None:
        return "", ()
    folder, ending = shown
    places = ((name, *page.partition("#")) for name, page in PAGES)
    return f"{folder.as_uri()}/", tuple((name, f"{page}{ending}{mark}{place}") for name, page, mark, place in places)


def register() -> None:
    bpy.utils.register_manual_map(manual_map)


def unregister() -> None:
    bpy.utils.unregister_manual_map(manual_map)
