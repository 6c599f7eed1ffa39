"""Bones: along the limbs of one shape, and along the parts of a puppet."""
