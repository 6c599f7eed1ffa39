"""Whether cages hold what is displayed."""
