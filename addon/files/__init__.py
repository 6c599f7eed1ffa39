"""Drawings from files, and cages to files."""
