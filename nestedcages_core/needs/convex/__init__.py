"""Convex cages."""
