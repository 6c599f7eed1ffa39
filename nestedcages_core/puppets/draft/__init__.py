"""How parts hang together: evidence from shapes, order, groups and names, and the most likely tree."""
