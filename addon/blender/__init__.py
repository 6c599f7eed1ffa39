"""Between numpy and Blender: meshes, modifiers, keys, placement, views and jobs. Nothing here knows of cages."""
