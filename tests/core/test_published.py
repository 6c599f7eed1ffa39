"""The paper as written: the excess of its compiled program, its flow, its descent, its rules; and its repairs."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, PaperFlow, Settings, nested_cages
from support.judging import rejected
from support.marks import slow_after
from support.shapes import annulus, assert_nested, ring

REPAIRED = core.PaperContact(repairs=core.Repairs(parity=True, exact_home=True))
UNTIGHTENED = Settings(flow=PaperFlow(exact_parity=True), fallback=None, tightening=core.Tightening(iterations=0))


@pytest.mark.parametrize(
    ("scale", "excess"), slow_after(0, [(1.0, 19.379), (3.0, 3.771), (0.5, 51.160)], thorough_after=1)
)
def test_absolute_lengths_give_the_excess_of_the_compiled_program(scale: float, excess: float) -> None:
    """A disc of Table 1 at three sizes; the excesses are those of the authors' C++ on the same meshes."""
    fine, coarse = (mesh.moved(scale * mesh.vertices) for mesh in (annulus(16), annulus(16)))
    result = core.as_published(fine, coarse)
    assert 100.0 * (result.cage.area / fine.area - 1.0) == pytest.approx(excess, abs=0.1)
    assert 0.0 < result.short < 1e-3 * fine.diagonal
    assert np.array_equal(result.flow_steps[0], fine.vertices)
    assert np.hypot(*(result.flow_steps[1] - fine.vertices).T).max() == pytest.approx(0.01)  # the program's step
    assert result.short == pytest.approx(np.hypot(*(result.returned - fine.vertices).T).max())
    with rejected("reinflation.blocked", core.ReinflationError):  # the preset does the same, which its certificate sees
        nested_cages(fine, [coarse], core.AUGMENTED_2022)
    (level,) = nested_cages(fine, [coarse], core.AUGMENTED_2022_REPAIRED)  # returns exactly, to about the same cage
    assert 100.0 * level.report.excess == pytest.approx(excess, rel=0.01)


def test_newton_needs_few_iterations_on_the_papers_energy() -> None:
    """From the coarse to the fine annulus of Table 1; at the end the fine mesh goes straight home."""
    fine, contact = annulus(24), replace(REPAIRED, solver=core.ProjectedNewton())
    (level,) = nested_cages(fine, [annulus(16)], replace(UNTIGHTENED, contact=contact))
    assert_nested(level.cage, fine)
    assert np.array_equal(level.reinflation.cage_steps[-1], level.reinflation.cage_steps[-2])
    assert level.report.iterations["reinflation"] < 50
    assert level.report.excess == pytest.approx(0.207, abs=0.006)


class Shrinking:
    """A flow of one step."""

    def run(self, fine: Mesh, coarse: Mesh, *, tick: Callable[[float], None]) -> core.FlowResult:
        tick(0.5)
        return core.FlowResult(np.stack([fine.vertices, 0.9 * fine.vertices]), 1, "shrinking")


@pytest.mark.parametrize("over_length", [True, False])
def test_the_flow_weighs_edges_as_program_or_text(over_length: bool) -> None:
    """A vertex between a long and a short edge, next to a corner that pulls their samples in different directions."""
    coarse = Mesh.from_loops([np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])])
    fine = Mesh.from_loops([np.array([[4.2, 4.1], [4.1, 4.2], [1.0, 1.0], [1.2, 0.9]])])
    flow = PaperFlow(exact_parity=True, over_length=over_length)
    (level,) = nested_cages(fine, [coarse], Settings(flow=flow, fallback=None))
    before, after = level.flow.steps[:2]
    moved = (before - after)[0] / (flow.step * fine.diagonal)

    total = np.zeros(2)
    for end in (before[1], before[3]):
        for t in (0.0, 0.25, 0.5, 0.75):
            sample = (1.0 - t) * before[0] + t * end
            closest = np.clip(sample, 0.0, 4.0)
            if np.array_equal(closest, sample):  # inside: the nearest side of the square
                gaps = np.array([sample[0], 4.0 - sample[0], sample[1], 4.0 - sample[1]])
                side = int(gaps.argmin())
                closest = sample.copy()
                closest[side // 2] = 4.0 * (side % 2)
            weight = (1.0 - t) ** 2 / (np.hypot(*(end - before[0])) if over_length else 1.0)
            total += weight * (sample - closest) / np.hypot(*(sample - closest))
    assert moved == pytest.approx(total / np.hypot(*total))


def test_all_pairs_have_a_limit() -> None:
    with rejected("setting.invalid"):
        nested_cages(ring(40_000), [[ring(260, 0.95)]], replace(UNTIGHTENED, flow=Shrinking(), contact=REPAIRED))
