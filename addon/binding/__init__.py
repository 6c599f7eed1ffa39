"""Cages that move what is in them, by modifiers and node groups that a file keeps."""
