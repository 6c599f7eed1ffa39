"""Cages on a grid."""
