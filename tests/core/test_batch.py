"""Batches: order, failures, cancelling, going on, and workers that die."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import BatchProgress, Hierarchy, InvalidMeshError, Mesh, NestedCagesError, nested_cages_many
from support.judging import rejected
from support.shapes import assert_nested, star

BOW_TIE = shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)])


def glyphs(count: int) -> list[Mesh]:
    return [star(3 + k % 5, 40 + k) for k in range(count)]


def outermost(hierarchy: Hierarchy) -> Mesh:
    return hierarchy.cages[-1]


def half(mesh: Mesh) -> list[int]:
    return [len(mesh.vertices) // 2]


@pytest.fixture(scope="module")
def processes() -> Iterator[Executor]:
    with ProcessPoolExecutor(2) as pool:
        yield pool


def spawning() -> Executor:
    """A process that imports all anew, as on Windows and macOS."""
    return ProcessPoolExecutor(1, get_context("spawn"))


@pytest.fixture(params=["here", "threads", "processes", "maker"])
def executor(request: pytest.FixtureRequest, processes: Executor) -> Iterator[object]:
    if request.param == "threads":
        with ThreadPoolExecutor(2) as pool:
            yield pool
    else:
        yield {"here": None, "processes": processes, "maker": spawning}[request.param]


@pytest.mark.slow
def test_results_come_in_order_and_equal_single_runs(executor: Executor | None) -> None:
    shapes = glyphs(4)
    seen: list[BatchProgress] = []
    outcomes = nested_cages_many(shapes, [16], executor=executor, progress=seen.append)
    assert [outcome.key for outcome in outcomes] == list(range(4))
    for shape, outcome in zip(shapes, outcomes, strict=True):
        assert (outcome.unwrap().fine.vertices == shape.vertices).all()
        assert (outcome.result.cages[0].vertices == core.nested_cages(shape, [16]).cages[0].vertices).all()
        assert outcome.seconds > 0.0
    assert [each.finished for each in seen] == [1, 2, 3, 4]
    assert seen[-1].fraction == 1.0
    assert {each.outcome.key for each in seen} == set(range(4))


@pytest.mark.slow
def test_a_failure_does_not_lose_the_others(executor: Executor | None) -> None:
    shapes = {"a": star(5, 50), "bow tie": BOW_TIE, "text": "no shape", "b": shapely.Point(0, 0).buffer(1)}
    outcomes = nested_cages_many(shapes, [12], executor=executor)
    assert [outcome.key for outcome in outcomes] == ["a", "bow tie", "text", "b"]
    assert [type(outcome.error) for outcome in outcomes] == [type(None), InvalidMeshError, InvalidMeshError, type(None)]
    assert_nested(outcomes[3].result.cages[0], Mesh.from_geometry(shapes["b"]))
    with rejected("mesh.crossing", InvalidMeshError):
        outcomes[1].unwrap()
    (small,) = nested_cages_many([star(5, 50)], [20, 2], core.Settings(clearance=1e-3), executor=executor)
    assert isinstance(small.error, core.NestingError)


@pytest.mark.slow
def test_levels_by_key_by_function_and_from_a_generator(executor: Executor | None) -> None:
    shapes = {"a": star(5, 50), "b": star(4, 60)}
    by_key = nested_cages_many(shapes, {"a": [20, 10], "b": [8]}, executor=executor)
    assert [[len(cage.vertices) for cage in outcome.result.cages] for outcome in by_key] == [[20, 10], [8]]
    by_function = nested_cages_many(shapes, half, executor=executor, keep=outermost)
    assert [len(outcome.result.vertices) for outcome in by_function] == [25, 30]
    of_generator = nested_cages_many(shapes, (level for level in [20, 12]), executor=executor)
    assert [[len(cage.vertices) for cage in outcome.unwrap().cages] for outcome in of_generator] == [[20, 12]] * 2


def test_an_empty_batch() -> None:
    assert nested_cages_many([], [8], executor=ThreadPoolExecutor) == []


@pytest.mark.slow
def test_a_batch_may_be_cancelled(executor: Executor | None) -> None:
    done: dict[object, core.Outcome] = {}

    def stop(progress: BatchProgress) -> None:
        done[progress.outcome.key] = progress.outcome
        if progress.finished == 3:
            raise KeyboardInterrupt

    shapes = {f"glyph {k}": shape for k, shape in enumerate(glyphs(7))}
    with pytest.raises(KeyboardInterrupt):
        nested_cages_many(shapes, [12], executor=executor, progress=stop)
    assert len(done) == 3
    assert all(len(outcome.unwrap().cages[0].vertices) == 12 for outcome in done.values())


def test_a_cancelled_batch_leaves_the_other_shapes_of_an_executor() -> None:
    kept: list[Hierarchy] = []

    def stop(_: BatchProgress) -> None:
        raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt):
        nested_cages_many(glyphs(60), [12], executor=pool, progress=stop, keep=kept.append)
    assert len(kept) < 60


class Bomb:
    """A result that cannot be read back where it arrives."""

    def __reduce__(self) -> object:
        return int, ("not a number",)


def bomb(hierarchy: Hierarchy) -> object:
    return Bomb()


def lock(hierarchy: Hierarchy) -> object:
    return threading.Lock()


@pytest.mark.slow
def test_results_that_do_not_travel_are_errors_of_their_shape() -> None:
    (read,) = nested_cages_many([star(5, 50)], [12], executor=lambda: ProcessPoolExecutor(1), keep=bomb)
    (written,) = nested_cages_many([star(5, 50)], [12], executor=lambda: ProcessPoolExecutor(1), keep=lock)
    assert [outcome.error.code for outcome in (read, written)] == ["batch.invalid"] * 2
    assert isinstance(read.error.__cause__, BrokenExecutor)
    assert isinstance(written.error.__cause__, TypeError)


class Deadly:
    """A shape that kills the worker that makes it."""

    @property
    def __geo_interface__(self) -> dict[str, object]:
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))  # on Windows either ends it at once
        raise AssertionError("the worker is dead")


@pytest.mark.slow
def test_every_shape_without_a_result_has_an_error_when_a_worker_dies() -> None:
    shapes: dict[str, object] = {f"glyph {k}": shape for k, shape in enumerate(glyphs(9))}
    shapes["deadly"] = Deadly()
    shapes.update({f"more {k}": shape for k, shape in enumerate(glyphs(3))})
    with ProcessPoolExecutor(1) as pool:
        outcomes = nested_cages_many(shapes, [12], executor=pool)
        again = nested_cages_many(shapes, [12], executor=pool)  # with its worker dead
    assert [outcome.key for outcome in outcomes] == list(shapes)
    for outcome in (*outcomes[9:], *again):
        assert isinstance(outcome.error, NestedCagesError)
        assert outcome.error.code == "batch.invalid"
    made = [outcome for outcome in outcomes if outcome.error is None]
    assert made and all(len(outcome.result.cages[0].vertices) == 12 for outcome in made)


def test_a_broken_executor_is_an_error_of_every_shape() -> None:
    class Dead(Executor):
        def submit(self, *_: object, **__: object) -> Future:
            raise BrokenExecutor("dead")

    outcomes = nested_cages_many(glyphs(2), [12], executor=Dead)
    assert [outcome.error.code for outcome in outcomes] == ["batch.invalid"] * 2


def test_exceptions_that_end_the_program_are_raised() -> None:
    with ThreadPoolExecutor(1) as pool, pytest.raises(SystemExit):
        nested_cages_many(glyphs(1), [12], executor=pool, keep=lambda _: sys.exit())


@pytest.mark.slow
def test_dask_makes_cages_too() -> None:
    from distributed import Client, LocalCluster

    shapes = glyphs(4)
    workers = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with workers as cluster, Client(cluster) as client:
        outcomes = nested_cages_many(shapes, [12], executor=client.get_executor())
    assert [len(outcome.unwrap().cages[0].vertices) for outcome in outcomes] == [12] * 4
