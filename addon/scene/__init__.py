"""Objects of the scene to planar drawings, and results back to objects."""
