"""Cages for many shapes, on any executor of concurrent.futures: threads, processes, Dask, MPI."""

from __future__ import annotations

from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import closing
from dataclasses import dataclass
from typing import Any, TypeAlias

from ..errors import NestedCagesError
from ..geometry.mesh import Mesh
from ..levels import Settings
from ..progress import listened
from .outcome import Keep, Outcome, Task

Level: TypeAlias = int | Mesh
Levels: TypeAlias = Iterable[Level] | Mapping[Hashable, Iterable[Level]] | Callable[[Mesh], Iterable[Level]]
Shapes: TypeAlias = Iterable[Any] | Mapping[Any, Any]


@dataclass(frozen=True)
class BatchProgress:
    """Progress of a batch."""

    finished: int
    total: int
    outcome: Outcome
    """The outcome that has just come in."""

    @property
    def message(self) -> str:
        """How many shapes are done."""
        return f"{self.finished} of {self.total} shapes"

    @property
    def fraction(self) -> float:
        """Fraction of the batch that is done, from 0 to 1."""
        return self.finished / self.total


def nested_cages_many(
    shapes: Shapes,
    levels: Levels,
    settings: Settings | None = None,
    *,
    executor: Executor | Callable[[], Executor] | None = None,
    progress: Callable[[BatchProgress], None] | bool | None = None,
    keep: Keep | None = None,
) -> list[Outcome]:
    """Cages around many shapes.

    Parameters
    ----------
    shapes : iterable or mapping
        What `Mesh.of` reads, in a sequence or by key.
    levels : sequence, mapping or callable
        As in `nested_cages`; the same for all shapes, by key, or a function of the mesh.
    settings : Settings, optional
        Of all shapes.
    executor : concurrent.futures.Executor or callable, optional
        Where the work runs, or a function that makes an executor, which is shut down at the end. If a worker process
        dies, the shapes without a result have an error. Default: this process, one shape after the other.
    progress : callable or bool, optional
        Called with a `BatchProgress` for every outcome; it may raise to cancel, and then no further shape is started.
        True: a bar, if tqdm is installed.
    keep : callable, optional
        The part of a Hierarchy to keep, such as ``lambda made: made.cages[-1]``. With processes, this function and
        that of the levels must be defined in a module. Default: all of it.

    Returns
    -------
    list of Outcome
        In the order of the input; the outcome of a shape that fails holds the error.

    Raises
    ------
    NestedCagesError
        If the levels name no entry for a shape.
    """
    tasks = list(_tasks(shapes, levels, settings if settings is not None else Settings(), keep))
    outcomes: dict[Hashable, Outcome] = {}

    def work(report: Callable[[BatchProgress], None]) -> list[Outcome]:
        with closing((task.run() for task in tasks) if executor is None else _outcomes(tasks, executor)) as incoming:
            for outcome in incoming:
                outcomes[outcome.key] = outcome
                report(BatchProgress(len(outcomes), len(tasks), outcome))
        return [outcomes[task.key] for task in tasks]

    return listened(work, progress)


def _outcomes(tasks: Sequence[Task], executor: Executor | Callable[[], Executor]) -> Generator[Outcome, None, None]:
    """Yield outcomes as they come in; start no further task once the caller stops iterating."""
    pool = executor if isinstance(executor, Executor) else executor()
    futures: dict[Future[Outcome], Task] = {}
    try:
        for task in tasks:
            try:
                futures[pool.submit(task.run)] = task
            except BrokenExecutor as died:  # before this one was sent
                yield _failed(task, died)
        for future in as_completed(futures):
            error = future.exception()
            yield future.result() if error is None else _failed(futures[future], error)
    finally:
        for future in futures:
            future.cancel()
        if pool is not executor:
            pool.shutdown(wait=all(future.done() for future in futures), cancel_futures=True)


def _failed(task: Task, error: BaseException) -> Outcome:
    """The outcome of a task that raised outside of the shape; exceptions that end the program are re-raised."""
    if not isinstance(error, Exception):
        raise error
    problem = (
        f"The shape {task.key!r} could not be sent to or from its worker ({type(error).__name__}: {error}); give "
        "shapes, levels, settings and a result that can be pickled."
    )
    if isinstance(error, BrokenExecutor):
        problem = (
            f"The shape {task.key!r} has no cages, since a worker died, or sent what cannot be read, before it was "
            "finished; make it again, with fewer workers if memory ran out."
        )
    failed = NestedCagesError(problem, code="batch.invalid")
    failed.__cause__ = error
    return Outcome(task.key, None, failed)


def _tasks(shapes: Shapes, levels: Levels, settings: Settings, keep: Keep | None) -> Iterator[Task]:
    shared = _reusable(levels)
    keyed: Iterable[tuple[Hashable, Any]] = shapes.items() if isinstance(shapes, Mapping) else enumerate(shapes)
    for key, shape in keyed:
        if isinstance(levels, Mapping) and key not in levels:
            raise NestedCagesError(f"The levels name no entry for the shape {key!r}; add one.", code="batch.invalid")
        yield Task(key, shape, _reusable(levels[key]) if isinstance(levels, Mapping) else shared, settings, keep)


def _reusable(levels: Any) -> Any:
    """Levels that can be read more than once; invalid ones are left for `nested_cages` to reject."""
    return list(levels) if isinstance(levels, Iterator) else levels
