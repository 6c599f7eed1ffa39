"""Promises in addition to the number of vertices, one folder each. Each fills slots of a plan; none imports another."""
