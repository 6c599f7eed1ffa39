"""Drawings from files and images, cages as files and as other objects."""
