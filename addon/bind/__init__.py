"""Drawings that follow their cages."""
