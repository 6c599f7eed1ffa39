"""Objects of the scene as planar drawings, and what belongs together.

`reading`: the lines of an object. `chains`: lines to closed loops. `plane`: the plane they lie in. `convert`: all of
this, objects to drawings. `filling`: outlines to faces, prisms and curves. `display`: how output looks. `ownership`:
which output belongs to which drawing. `selection`: what the user works with.
"""
