"""Layered paintings as puppets: textured meshes with the weights that game engines use, and an armature."""
