"""What is remembered is forgotten in time, is told apart, and changes no result."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from nestedcages_core import (
    IPC,
    Area,
    Found,
    InteriorARAP,
    LineCycles,
    Mesh,
    Mirror,
    NestedCagesError,
    NoEnergy,
    OuterHull,
    SequentialQP,
    Settings,
    ShapeKeeping,
    TwoSidedFlow,
    WeightedSum,
    nested_cages,
)
from nestedcages_core.cache import LARGEST_SHARE, Memory, forget, key_of
from nestedcages_core.decimation.hull.hull_moves import Weights
from nestedcages_core.level.builder import LevelBuilder
from nestedcages_core.tasks import drain
from support.marks import slow_after, slowly
from support.shapes import islands, star


class TestMemory:
    def test_the_least_recently_used_are_forgotten_first(self) -> None:
        memory: Memory[str] = Memory(40)
        for key in ("a", "b", "c", "d"):
            memory.put(key, key.upper(), 10)
        assert memory.get("a") == "A"
        memory.put("e", "E", 10)
        assert [memory.get(key) for key in "abcde"] == ["A", None, "C", "D", "E"]

    def test_a_value_that_would_push_out_most_others_is_not_kept(self) -> None:
        memory: Memory[int] = Memory(100)
        memory.put("small", 1, 5)
        memory.put("large", 2, int(100 * LARGEST_SHARE) + 1)
        assert (memory.get("small"), memory.get("large"), len(memory)) == (1, None, 1)

    def test_a_value_that_replaces_another_counts_once(self) -> None:
        memory: Memory[int] = Memory(40)
        for value in range(10):
            memory.put("same", value, 10)
        memory.put("other", 1, 10)
        assert (memory.get("same"), memory.get("other")) == (9, 1)

    def test_all_are_forgotten(self) -> None:
        memory: Memory[int] = Memory(40)
        memory.put("a", 1, 1)
        forget()
        assert memory.get("a") is None

    def test_a_stage_runs_once_unless_it_has_no_key(self) -> None:
        memory: Memory[int] = Memory(1000)
        runs = []

        def work() -> Iterator[float]:
            runs.append(1)
            yield 0.5
            return 7

        assert [memory.value("value", lambda value=value: value, 8) for value in (1, 2)] == [1, 1]
        for key, total in (("a", 1), ("a", 1), (None, 2), (None, 3), ("b", 4)):
            assert drain(memory.stage(key, work(), lambda _: 8)) == 7
            assert len(runs) == total

    def test_a_stage_that_is_dropped_or_fails_is_not_remembered(self) -> None:
        memory: Memory[int] = Memory(1000)

        def work(fails: bool) -> Iterator[float]:
            yield 0.5
            if fails:
                raise NestedCagesError("no")
            return 7

        dropped = memory.stage("a", work(False), lambda _: 8)
        next(dropped)
        dropped.close()
        with pytest.raises(NestedCagesError):
            drain(memory.stage("a", work(True), lambda _: 8))
        assert len(memory) == 0


@dataclass(frozen=True)
class OfOwn:
    """A user's own method object."""

    values: object = 1.0


@dataclass
class Changing:
    values: float = 1.0


class Unknown:
    pass


class OwnEnergy:
    def at(self, coarse: Mesh) -> Area:
        return Area()


class Derived(SequentialQP):
    """Its methods may do anything."""


@dataclass(frozen=True)
class Hiding:
    hidden: float = field(default=1.0, compare=False)


class TestKeys:
    def test_what_behaves_alike_has_the_same_key(self) -> None:
        for make in (
            lambda: (OuterHull(), TwoSidedFlow(), SequentialQP(), IPC(energy=ShapeKeeping(2.0))),
            lambda: (WeightedSum(((1.0, Area()), (2.0, NoEnergy()))), Mirror((0.0, 0.0), (0.0, 1.0)), Weights()),
            lambda: (OfOwn((1, 2.0, "three")), np.arange(3.0), None, 1e-5),
        ):
            assert key_of(*make()) == key_of(*make()) is not None

    def test_what_differs_is_told_apart(self) -> None:
        array = np.arange(6.0)
        parts = (
            0, 0.0, -0.0, False, None, "", 1, 1.0, True, (), (1,), OfOwn(), OfOwn(1), OfOwn(True),
            Area(), NoEnergy(), OuterHull(), LineCycles(), LineCycles(on_curve=False),
            ShapeKeeping(1.0), ShapeKeeping(np.nextafter(1.0, 2)),
            array, array.reshape(2, 3), array.astype(np.float32), np.nextafter(array, 9.0), np.arange(6),
        )  # fmt: skip
        keys = [key_of(part) for part in parts]
        assert None not in keys
        assert len(set(keys)) == len(keys)

    @pytest.mark.parametrize(
        "part",
        [
            Unknown(), Changing(), Derived(), Hiding(), [1, 2], {}, np.float32(1.0), OfOwn([1]),
            OfOwn(Unknown()), OfOwn(np.arange(2)),
            (1, Unknown()), IPC(energy=OwnEnergy()), Area,
        ],
    )  # fmt: skip
    def test_what_may_change_has_no_key(self, part: object) -> None:
        assert key_of(1.0, part) is None

    def test_classes_of_the_same_name_are_told_apart(self) -> None:
        def made() -> object:
            @dataclass(frozen=True)
            class Method:
                strength: float = 1.0

            return Method()

        one, other = made(), made()
        assert repr(one) == repr(other)
        assert key_of(one) != key_of(other)


def bits(fine: Mesh, count: int, settings: Settings) -> bytes:
    """Coarse mesh, flow, reinflation and cage, or why there is none."""
    try:
        level = nested_cages(fine, [count], settings).levels[0]
    except NestedCagesError as error:
        return str(error).encode()
    way = level.reinflation
    arrays = level.coarse.vertices, level.flow.steps, way.moving_steps, way.cage_steps, level.cage.vertices
    return b"".join(array.tobytes() for array in arrays) + repr((level.report.notes, level.report.iterations)).encode()


def dragged(fine: Mesh) -> list[Settings]:
    """Settings as a hand on sliders gives them, in no order."""
    strengths, clearances = (0.5, 4.0, 0.5, 2.0), (1e-5, 3e-4, 1.05e-2, 3e-4)
    settings = [Settings(energy=ShapeKeeping(strength)) for strength in strengths]
    settings += [Settings(clearance=share * fine.diagonal) for share in clearances]
    settings += [Settings(energy=NoEnergy(), clearance=1e-2 * fine.diagonal), Settings(contact=IPC()), Settings()]
    return settings


@pytest.mark.slow
@pytest.mark.parametrize("shape", [lambda: star(5, 60), *slowly(islands)])
def test_results_are_the_same_bits_whatever_was_asked_for_before(shape) -> None:
    fine = shape()
    count = 5 * len(fine.loops)
    alone = []
    for settings in dragged(fine):
        forget()
        alone.append(bits(fine, count, settings))
    assert len(set(alone)) > len(alone) // 2
    forget()
    assert [bits(fine, count, settings) for settings in dragged(fine)] == alone


def test_another_energy_repeats_nothing_but_the_tightening(monkeypatch) -> None:
    fine, copy = star(), star()
    nested_cages(fine, [20])

    def fail(*_: object, **__: object) -> Iterator[float]:
        yield 0.0
        raise AssertionError("again")

    for method in ((LineCycles, "starts"), (TwoSidedFlow, "run"), (SequentialQP, "reinflate")):
        monkeypatch.setattr(*method, fail)
    report = nested_cages(copy, [20], Settings(energy=ShapeKeeping())).levels[0].report
    assert report.start == "flow"
    with pytest.raises(AssertionError, match="again"):
        nested_cages(star(9, 181), [20])


def test_the_users_arrays_are_not_shared_with_later_results() -> None:
    fine = star()
    first = nested_cages(fine, [20]).levels[0]
    kept = first.cage.vertices.copy()
    first.flow.steps[:] = 0.0
    first.reinflation.cage_steps[:] = 0.0
    again = nested_cages(fine, [20]).levels[0]
    assert (again.cage.vertices == kept).all()
    assert (again.flow.steps[0] == fine.vertices).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", slow_after(2, [{}, {"grid": 0.01}, {"symmetry": Found()}, {"energy": InteriorARAP()}])
)
def test_the_very_same_request_is_answered_at_once(options: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    fine = star()
    forget()
    first = nested_cages(fine, [24, 12], **options)

    def computed(*_: object) -> Iterator[None]:
        pytest.fail("computed again")
        yield

    monkeypatch.setattr(LevelBuilder, "build", computed)
    again = nested_cages(Mesh(fine.vertices, fine.edges), [24, 12], **options)
    assert again.cages == first.cages
    assert again[0].report == first[0].report
    assert not np.shares_memory(again[0].flow.steps, first[0].flow.steps)


GROWING = """
import resource, numpy as np
import nestedcages_core.geometry.arrays
faults = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_minflt
before = faults()
for size in range(1, 32):
    np.empty(size * 2**14).fill(1.0)
print((faults() - before) * resource.getpagesize() / (size * 2**17))
"""
"""Prints how much fresh memory arrays take of which each is larger than those before, in parts of the largest."""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other libraries keep memory by rules of their own")
def test_freed_memory_is_used_again() -> None:
    own = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}  # dask sets some
    done = subprocess.run([sys.executable, "-c", GROWING], capture_output=True, text=True, check=True, env=own)
    assert float(done.stdout) < 2.0
