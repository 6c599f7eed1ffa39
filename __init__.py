"""Nested Cages as a Blender extension.

The repository's root is the extension's package. Test runners and build tools import a root ``__init__.py`` as well;
outside Blender, or without a package around it, this module is therefore empty.
"""

try:
    import bpy
except ImportError:
    bpy = None

if bpy is not None and __package__:
    from .addon import register, unregister
    from .addon.api import cages
    from .addon.cage_sets import CageSet

    __all__ = ["CageSet", "cages", "register", "unregister"]
