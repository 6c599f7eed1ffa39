"""Decimations that a user may choose instead of the default one."""
