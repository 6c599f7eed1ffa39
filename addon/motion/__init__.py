"""Cages that follow a moving drawing, or its edits."""
