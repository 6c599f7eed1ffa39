"""Numbers of all packages: what is negligible, how often loops run at most, and what steps must gain."""

INPUT_ROUND_OFF = 1e-12
"""Relative difference of coordinates that were rounded when they were written, above the 1e-16 of float64."""

ROUND_OFF = 1e-9
"""Relative difference, or angle in radians, of computed values that are the same: half the digits of float64."""

NEGLIGIBLE = 1e-6
"""Relative difference that is real but that no drawing shows; a tenth of the default clearance."""

ROUNDING_ULPS = 8.0
"""What a conversion between units and back may take, in roundings of the largest coordinate: it counts far from the
origin."""

MOST_ROUNDS = 12
"""Cap of loops that refine, widen or repair: nearly all end after a few rounds, and others gain little in hundreds."""

MOST_STEPS = 100
"""Cap of loops of small steps that converge, unless something is wrong."""

MOST_HALVINGS = 60
"""Cap of loops that halve: what is left is then below the spacing of doubles."""

PATIENCE = 3
"""Steps in a row without progress after which a loop ends."""

BACKTRACKING = 0.5
"""Factor on a step that fails (Nocedal & Wright 2006, section 3.1); its inverse on one after a good step."""

PART_OF_GAP = 0.25
"""Part of a gap, or of a thickness, that each of its two sides may take up: half of it stays free."""

SUFFICIENT_DECREASE = 1e-4
"""Armijo's constant: fraction of the predicted decrease that a step must reach (Nocedal & Wright 2006, section 3.1)."""
