"""Puppets for game engines: textured meshes with certified hulls, written for Godot, Spine and scripts."""
