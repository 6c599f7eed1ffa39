"""Outer hull: the greedy search behind it, on loops as linked lists that only this folder sees."""
