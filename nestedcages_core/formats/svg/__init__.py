"""SVG in and out: what is painted becomes a mesh, meshes become paths with holes."""
