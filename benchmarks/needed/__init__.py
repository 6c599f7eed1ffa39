"""Tables about what cages are needed for, one module each; `needs.py` runs them."""
