"""Faults that tests once let pass, for ``mutants.py --by-hand``: each is put in, and its test must fail."""

from __future__ import annotations

from typing import NamedTuple


class Fault(NamedTuple):
    """What becomes of one place of a file, and the test that says so."""

    path: str
    before: str
    after: str
    test: str


CORE = "nestedcages_core/"
TESTS = "tests/core/test_deliberate_faults.py::test_"
MOTION = CORE + "verification/motion.py"
CYCLES = CORE + "decimation/line_cycles/"
ORACLE = "tests/core/test_line_cycles_oracle.py::test_"
MERGING = CORE + "decimation/merging.py"
PARTS = "tests/core/test_merging.py::test_"
JOINED = "parts_closer_than_the_distance_are_joined_and_holes_below_its_square_filled"
FEWEST = (
    "tests/core/test_tolerance.py::test_the_fewest_vertices_around_and_within_a_disc_are_those_of_the_regular_polygons"
)
SEARCH = "tests/core/test_tolerance.py::test_the_search_finds_the_least_count_that_keeps_the_tolerance"
TRUST = CORE + "tightening/trust_region.py"

FAULTS = (
    Fault(MOTION, "step += len(block.positions) - 1", "step += len(block.positions)",
          TESTS + "the_interval_between_two_blocks_of_steps_is_looked_at"),
    Fault(MOTION, "travelled = self.away[:-1] + speed", "travelled = speed",
          TESTS + "earlier_steps_of_a_block_count_as_travelled"),
    Fault(MOTION, "step += first\n", "step += 0\n", TESTS + "earlier_steps_of_a_block_count_as_travelled"),
    Fault(MOTION, "near = (measured <= self._with_rounding(point + np.maximum(start, end)))",
          "near = (measured <= self._with_rounding(point + start))",
          TESTS + "what_moves_on_either_side_of_a_pair_counts"),
    Fault(MOTION, "self.slack = COEFFICIENT_ROUNDING * float(np.abs(self.positions).max())", "self.slack = 0.0",
          TESTS + "distances_count_with_the_rounding_of_large_coordinates"),
    Fault(CORE + "geometry/predicates/orientation.py", "EXTENDED_BOUND = 40.0 * UNIT_ROUND_OFF**2",
          "EXTENDED_BOUND = 0.0", TESTS + "predicates_beyond_double_precision_are_exact"),
    Fault(CORE + "tolerance/within.py", "return stays_within(*by_side(cage, fine, side), self.limit)",
          "return stays_within(*by_side(cage, fine, side), 1.01 * self.limit)", TESTS + "limits_are_kept_to_the_digit"),
    Fault(CORE + "tolerance/within.py", "return self.measured(cage, fine, side) <= self.limit",
          "return self.measured(cage, fine, side) <= 1.01 * self.limit", TESTS + "limits_are_kept_to_the_digit"),
    Fault(CORE + "tolerance/reach.py", "return _reach(cage, fine, limit, slack)[0]",
          "return 1.02 * _reach(cage, fine, limit, slack)[0]", TESTS + "limits_are_kept_to_the_digit"),
    Fault(CORE + "motion/following.py",
          " if judged(promises.plan, moved, clearance, same_loops=follower.same_loops) else None", "",
          TESTS + "a_step_that_leaves_the_drawing_is_no_cage"),
    Fault(CORE + "level/motion_gate.py",
          "if cage.fault is not None:\n            raise NestingError(\n                f",
          "if False:\n            raise NestingError(\n                f",
          TESTS + "a_key_that_leaves_the_drawing_is_an_error"),
    Fault(CORE + "motion/animated.py", "not verify_motion(cage, fine, np.stack([cage.vertices] * 2), way)", "False",
          TESTS + "a_still_cage_holds_between_the_poses_too"),
    Fault(CORE + "tolerance/fewest.py", "met = self.is_met(level.cage)", "met = True",
          TESTS + "the_fewest_vertices_keep_the_tolerance"),
    Fault(CORE + "tolerance/fewest.py", "self.bound = sum(bounds)", "self.bound = sum(bounds) + 1",
          TESTS + "the_least_number_of_vertices_is_a_lower_bound"),
    Fault(CORE + "constraints/numbers.py", "if np.array_equal(self.nearest(cage.vertices), cage.vertices):", "if True:",
          TESTS + "constraints_find_cages_that_miss_them"),
    Fault(CORE + "constraints/symmetric.py",
          "if not (away > 0.0).any():", "if True:", TESTS + "constraints_find_cages_that_miss_them"),
    Fault(CORE + "command/making.py", '"min_edge", "min_angle", "seconds")', '"min_edge", "seconds")',
          TESTS + "every_option_of_the_command_reaches_the_settings"),
    Fault(CORE + "level/builder.py", "            if clearance < wanted:\n                cage =",
          "            if False:\n                cage =",
          TESTS + "a_cage_is_tightened_again_at_each_smaller_clearance"),
    Fault(CORE + "level/builder.py", "(1.0 + PAPER_PREFERENCE) * excess", "excess",
          TESTS + "a_start_that_the_flow_entered_is_preferred_by_a_little"),
    Fault(CORE + "level/builder.py",
          "self.plan.started((yield from self._coarse_meshes(attempt)))", "yield from self._coarse_meshes(attempt)",
          "tests/core/test_symmetry.py::test_bad_symmetries_are_rejected"),
    Fault(CORE + "level/gate.py", "fault = next(plan.missed(cage, whole=promised), None)", "pass",
          TESTS + "a_polygon_that_is_not_convex_is_no_convex_cage"),
    Fault(CORE + "constraints/convex.py", "or winding_number(other[:1], one, np.roll(one, -1, axis=0))[0]", "",
          TESTS + "hulls_that_touch_have_no_convex_cages"),
    Fault(TRUST, "if gain > FAIR_GAIN:", "if False:", TESTS + "radii_grow_after_good_steps"),
    Fault(CORE + "solver/quadratic_program.py", "max((after / complementarity) ** 3, SMALLEST_CENTRING)",
          "max((after / complementarity) ** 3, 0.3)", TESTS + "quadratic_programs_take_few_iterations"),
    Fault("addon/following/live.py", "        (app.redo_post, _on_undo),\n", "",
          "tests/addon/test_live.py::test_undo_is_followed"),
    Fault("addon/generation/verifying.py", "scene.frame_set(frame, subframe=subframe)", "scene.frame_set(frame)",
          "tests/addon/test_verify.py::test_the_moment_between_two_frames_is_kept"),
    Fault(CORE + "level/gate.py", "        if not motion:\n", "        if False:\n",
          "tests/core/test_needs_together.py::test_steps_that_rounding_spoils_count_as_flow"),
    Fault(CORE + "level/builder.py", "0.0 if plan.numbers is None else plan.numbers.room", "0.0",
          TESTS + "a_margin_for_stored_numbers_is_there_at_the_first_trial"),
    Fault(CORE + "motion/level.py", "    rooms: float = 1.0", "    rooms: float = 0.0",
          TESTS + "a_margin_for_stored_numbers_is_there_at_the_first_trial"),
    Fault(CORE + "decimation/hull/hull_moves.py", "if stamps[slot] == stamp:", "if stamps[slot] >= stamp:",
          "tests/core/test_outer_hull.py::test_the_queue_gives_moves_in_order"),
    Fault("addon/following/live.py", "stored=STORED)", "stored=None)",
          "tests/addon/test_live.py::test_a_step_is_certified_as_it_is_stored"),
    Fault(CORE + "constraints/numbers.py", "return as_stored(self.exact(points), self.stored)", "return points",
          "tests/core/test_needs_together.py::test_a_cage_follows_on_the_numbers_that_are_stored"),
    Fault(MERGING, "mesh.area < best.area", "mesh.area > best.area", PARTS + "the_shape_of_least_area_is_used"),
    Fault(MERGING, "if shapely.Polygon(hole).area >= least", "if shapely.Polygon(hole).area < least", PARTS + JOINED),
    Fault(MERGING, "max_distance=within", "max_distance=None", PARTS + JOINED),
    Fault(MERGING, "reach = 0.5 * part", "reach = part", PARTS + JOINED),
    Fault(CORE + "tolerance/within.py", "return side * (cage.area / fine.area - 1.0)",
          "return cage.area / fine.area - 1.0", FEWEST),
    Fault(CORE + "tolerance/fewest.py", "if not (yield from self._try(aim)):\n                low = aim",
          "if not (yield from self._try(aim)):\n                low = aim + 1", SEARCH),
    Fault(CORE + "tolerance/fewest.py", "while self.count - low > 1:", "while self.count - low > 2:", SEARCH),
    Fault(CORE + "tolerance/fewest.py", "not (yield from self._try(self.count - 1))", "True", SEARCH),
    Fault(CYCLES + "turns.py", "(self.forth > free[0][self.source]) | (self.back > free[1][self.target])",
          "self.forth > free[0][self.source]", ORACLE + "what_is_free_of_either_line_bounds_a_turn"),
    Fault(CYCLES + "turns.py", "(forth >= -SLACK) & (back >= -SLACK)", "(forth >= SLACK) & (back >= -SLACK)",
          ORACLE + "turns_are_the_pairs_of_lines_that_meet_where_both_are_free"),
    Fault(CYCLES + "crossings.py", "(gap > 1) & (gap < size[i] - 1)", "gap > 1",
          ORACLE + "crossings_are_those_of_all_pairs"),
    Fault(CYCLES + "crossings.py", "apart = (self.loop[i] != self.loop[j])", "apart = (self.loop[i] == self.loop[j])",
          ORACLE + "crossings_are_those_of_all_pairs"),
    Fault(CYCLES + "giving_way.py", "if abs(s) * bias > abs(t):", "if abs(s) * bias < abs(t):",
          ORACLE + "the_line_whose_contact_is_farther_gives_way"),
    Fault(CYCLES + "giving_way.py", "np.abs(along[some]) - SLACK", "np.abs(along[some]) + SLACK",
          ORACLE + "the_line_whose_contact_is_farther_gives_way"),
    Fault(CYCLES + "method.py", "request.side * hull.area < request.side * mesh.area", "False",
          ORACLE + "where_cycles_crossed_the_smaller_of_them_and_the_hull_is_taken"),
    Fault(CYCLES + "method.py", "shift[blocked if len(blocked) else far] = HULL_OFFSET", "shift[far] = HULL_OFFSET",
          ORACLE + "only_blocked_loops_lose_their_shift"),
    Fault(CORE + "motion/level.py", "wanted = 0.0 if self.settings.clearance is None else self.clearance",
          "wanted = 0.0",
          "tests/core/test_gate.py::test_keys_keep_the_clearance"),
    Fault(CORE + "motion/between.py", "[other for other in (begin.before, end, begin) if other is not None]",
          "[end, begin]", "tests/core/test_gate.py::test_neighbours_of_a_pushed_key_are_judged_again"),
    Fault(CORE + "geometry/smallest_gap.py", "if slack <= ACCURATE * best:", "if slack >= 0.0:",
          "tests/core/test_smallest_gap.py::test_certificate_and_checker_agree_to_the_last_digits"),
    Fault(CORE + "command/written.py", "            if missing:", "            if False:",
          "tests/core/test_check_command.py::test_what_a_viewer_does_not_show_so_is_refused"),
    Fault(CORE + "exchange/svg/levels.py", "points = moved(path.points, shape.matrix)", "points = path.points",
          "tests/core/test_check_command.py::test_what_a_viewer_does_not_show_so_is_refused"),
    Fault(CORE + "exchange/svg/selectors.py", "self.left -= visits * self.weight", "self.left -= 1",
          "tests/core/test_limits.py::test_small_drawings_take_bounded_work"),
)  # fmt: skip
