"""Objects of the scene as planar drawings, and ownership of output.

`reading`: the lines of an object. `plane`: the plane of a drawing. `convert`: from objects to drawings, by these.
`filling`: outlines as faces, prisms and curves. `display`: appearance of output.
`ownership`: which output belongs to which drawing. `selection`: the active and selected objects.
"""
