"""What objects show, as closed outlines in a plane."""
