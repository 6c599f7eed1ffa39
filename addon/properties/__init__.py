"""What the user can set: in the panel, for the operator, and as preferences."""
