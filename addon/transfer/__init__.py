"""The artist's work on cages and drawings, carried over to new meshes."""
