"""Cages with an exact symmetry."""
