"""Cages for many shapes, over any executor of concurrent.futures: threads, processes, Dask, MPI."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from time import perf_counter
from typing import Any, TypeAlias

from .errors import NestedCagesError
from .geometry.mesh import Mesh
from .hierarchy import Hierarchy, Settings, nested_cages

__all__ = ["BatchProgress", "Outcome", "nested_cages_many"]

IN_FLIGHT = 2
"""Shapes handed out per worker and not yet back: enough to keep all busy, few to look through when a worker dies."""

TRIES_ALONE = 2
"""Times that a shape is tried with no other beside it after a worker died, before it is held to be the cause."""

GREATEST_DEATHS = 12
"""Deaths of workers without one outcome between, after which the batch gives up: the cause is no single shape."""

Level: TypeAlias = int | Mesh
Levels: TypeAlias = Sequence[Level] | Mapping[Hashable, Sequence[Level]] | Callable[[Mesh], Sequence[Level]]
Shapes: TypeAlias = Iterable[Any] | Mapping[Any, Any]
Keep: TypeAlias = Callable[[Hierarchy], Any]


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of one shape."""

    key: Hashable
    """Its key, or its number in the input."""
    result: Any = None
    """Its Hierarchy, or what was kept of it; None after an error."""
    error: Exception | None = None
    seconds: float = 0.0
    """Time that it took where it was made."""

    def unwrap(self) -> Any:
        """The result; raises the error if there is one."""
        if self.error is not None:
            raise self.error
        return self.result


@dataclass(frozen=True)
class BatchProgress:
    """How far a batch is."""

    finished: int
    total: int
    outcome: Outcome
    """The one that has just come in."""

    @property
    def fraction(self) -> float:
        """Of the whole batch, from 0 to 1."""
        return self.finished / self.total


@dataclass(frozen=True, eq=False)
class _Task:
    """One shape on its way to a worker."""

    key: Hashable
    shape: Any
    levels: Any
    settings: Settings
    keep: Keep | None

    def run(self) -> Outcome:
        """The outcome; errors are part of it, so that none ends the batch."""
        began = perf_counter()
        try:
            mesh = self.shape if isinstance(self.shape, Mesh) else Mesh.from_geometry(self.shape)
            levels = self.levels(mesh) if callable(self.levels) else self.levels
            hierarchy = nested_cages(mesh, levels, self.settings)
            result = hierarchy if self.keep is None else self.keep(hierarchy)
            return Outcome(self.key, result, None, perf_counter() - began)
        except Exception as error:
            return Outcome(self.key, None, error, perf_counter() - began)


def nested_cages_many(
    shapes: Shapes,
    levels: Levels,
    settings: Settings | None = None,
    *,
    executor: Executor | Callable[[], Executor] | None = None,
    progress: Callable[[BatchProgress], None] | None = None,
    finished: MutableMapping[Any, Outcome] | None = None,
    keep: Keep | None = None,
) -> list[Outcome]:
    """Cages around many shapes, in the order of the input; a shape that fails has its error in its outcome.

    shapes: meshes or anything with `__geo_interface__`, in a sequence or by key. levels: as in `nested_cages`, for all
    shapes, by key, or a function of the mesh. executor: where the work is done, one shape after the other in this
    process unless given; a function that makes an executor is called again should a worker die, and what it made is
    shut down at the end. A ProcessPoolExecutor with a dead worker is replaced by one of its kind: nothing is lost.

    progress: called for every outcome; it may raise to cancel, then nothing new is begun. finished: outcomes by key,
    added to as they come in, such as a dict or a shelf; shapes that are there without an error are not made again.
    keep: what of a Hierarchy is kept, such as `lambda made: made.cages[-1]`; all of it unless given. For processes
    this function and that of the levels are defined in a module.
    """
    tasks = list(_tasks(shapes, levels, settings if settings is not None else Settings(), keep))
    store: MutableMapping[Any, Outcome] = {} if finished is None else finished
    known = {task.key: store[task.key] for task in tasks if task.key in store and store[task.key].error is None}
    open_ = [task for task in tasks if task.key not in known]
    outcomes = dict(known)
    with closing(_run_here(open_) if executor is None else _Crew(executor).run(open_)) as incoming:
        for outcome in incoming:
            outcomes[outcome.key] = store[outcome.key] = outcome
            if progress is not None:
                progress(BatchProgress(len(outcomes), len(tasks), outcome))
    return [outcomes[task.key] for task in tasks]


def _tasks(shapes: Shapes, levels: Levels, settings: Settings, keep: Keep | None) -> Iterator[_Task]:
    keyed: Iterable[tuple[Hashable, Any]] = shapes.items() if isinstance(shapes, Mapping) else enumerate(shapes)
    for key, shape in keyed:
        if isinstance(levels, Mapping):
            if key not in levels:
                raise NestedCagesError(f"The levels name no entry for the shape {key!r}; add one.")
            yield _Task(key, shape, levels[key], settings, keep)
        else:
            yield _Task(key, shape, levels, settings, keep)


def _run_here(tasks: Iterable[_Task]) -> Generator[Outcome, None, None]:
    for task in tasks:
        yield task.run()


def _failed(task: _Task, error: BaseException) -> Outcome:
    if not isinstance(error, Exception):
        raise error
    return Outcome(task.key, None, error)


class _Crew:
    """An executor, and others after it should its workers die."""

    def __init__(self, executor: Executor | Callable[[], Executor]) -> None:
        self.make = executor if not isinstance(executor, Executor) else None
        self.executor = executor if isinstance(executor, Executor) else executor()
        self.own = not isinstance(executor, Executor)
        self.waiting: deque[_Task] = deque()
        self.alone: deque[tuple[_Task, int]] = deque()
        """Tasks that were under way when a worker died, and how often each has been tried alone."""
        self.under_way: dict[Future[Outcome], _Task] = {}
        self.deaths = 0

    def run(self, tasks: Sequence[_Task]) -> Generator[Outcome, None, None]:
        """Outcomes as they come in; nothing new is begun once the reader has gone."""
        self.waiting.extend(tasks)
        try:
            while self.waiting or self.alone or self.under_way:
                broken = not self._hand_out()
                done = wait(self.under_way, return_when=FIRST_COMPLETED).done if self.under_way else ()
                for future in done:
                    error = future.exception()
                    if isinstance(error, BrokenExecutor):
                        broken = True
                        continue
                    task = self.under_way.pop(future)
                    self._came_back(task)
                    yield future.result() if error is None else _failed(task, error)
                if broken:
                    yield from self._after_a_death()
        finally:
            for future in self.under_way:
                future.cancel()
            if self.own:
                self.executor.shutdown(wait=not self.under_way, cancel_futures=True)

    def _came_back(self, task: _Task) -> None:
        self.deaths = 0
        if self.alone and self.alone[0][0] is task:
            self.alone.popleft()

    def _hand_out(self) -> bool:
        """Give the workers what they can take; False if they are dead."""
        try:
            if self.alone:
                if not self.under_way:
                    task = self.alone[0][0]
                    self.under_way[self.executor.submit(task.run)] = task
                return True
            workers = getattr(self.executor, "_max_workers", None)  # executors without a number take all at once
            most = IN_FLIGHT * workers if isinstance(workers, int) else len(self.waiting) + len(self.under_way)
            while self.waiting and len(self.under_way) < most:
                future = self.executor.submit(self.waiting[0].run)
                self.under_way[future] = self.waiting.popleft()
        except BrokenExecutor:
            return False
        return True

    def _after_a_death(self) -> Iterator[Outcome]:
        """Replace the executor; try what was under way again, each alone, so that the cause shows itself."""
        for future, task in list(self.under_way.items()):  # some came back before the death
            if future.done() and not isinstance(future.exception(), BrokenExecutor):
                del self.under_way[future]
                self._came_back(task)
                error = future.exception()
                yield future.result() if error is None else _failed(task, error)
        lost = list(self.under_way.values())
        self.under_way.clear()
        self.deaths += 1
        if self.deaths > GREATEST_DEATHS:
            raise NestedCagesError(
                f"The workers died {self.deaths} times in a row without one outcome; see whether they start at all."
            )
        if not self.alone:
            self.alone.extend((task, 0) for task in lost)
        elif lost:
            task, tries = self.alone.popleft()
            if tries + 1 < TRIES_ALONE:
                self.alone.appendleft((task, tries + 1))
            else:
                sentence = f"The worker died whenever it made the shape {task.key!r}; simplify it or add memory."
                yield _failed(task, NestedCagesError(sentence))
        self.executor = self._another()
        self.own = True

    def _another(self) -> Executor:
        """A new executor like the one that died."""
        from concurrent.futures import ProcessPoolExecutor  # brings multiprocessing, which few need

        dead = self.executor
        if self.own:
            dead.shutdown(wait=False, cancel_futures=True)
        if self.make is not None:
            return self.make()
        if isinstance(dead, ProcessPoolExecutor):
            given = vars(dead)
            return ProcessPoolExecutor(
                given.get("_max_workers"),
                given.get("_mp_context"),
                given.get("_initializer"),
                given.get("_initargs", ()),
                max_tasks_per_child=given.get("_max_tasks_per_child"),
            )
        raise NestedCagesError(
            f"The workers of the {type(dead).__name__} died, and another one cannot be made; give a function that "
            "makes executors."
        )
