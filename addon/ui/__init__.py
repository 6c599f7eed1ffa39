"""Panels and the manual; they read and never compute."""
