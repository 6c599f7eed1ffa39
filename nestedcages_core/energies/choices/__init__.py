"""Energies that a user may choose instead of the area."""
