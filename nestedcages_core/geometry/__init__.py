"""What a planar shape is: the validated mesh, exact predicates, distances, searches and triangulation."""
