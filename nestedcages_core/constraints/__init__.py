"""What cages keep in addition to nesting; `base` is what all constraints derive from, also those written elsewhere.

Asked for by name: Box (a rectangle; HalfPlanes is its base class), Outside (clear of a second shape), AxisAligned
(edges along some directions), LeastEdge and LeastAngle, LoopClearance (a clearance of each loop). Made by settings:
Symmetric, Convex, Numbers (a grid, stored numbers) and Pins. One file each; each is imported when one is asked for.
"""
