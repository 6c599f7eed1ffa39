"""Cages from drawings: what is asked for, the run, and what is written into the scene."""
