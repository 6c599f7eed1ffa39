"""Hostile and broken input: grammars that make it at random, attacks that are known, and the only outcomes allowed."""
