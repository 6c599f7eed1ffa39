"""The workers of an executor, replaced when they die."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait

from ..errors import NestedCagesError
from .tasks import Outcome, Task

IN_FLIGHT = 2
"""Shapes in flight per worker: enough to keep all busy, few to retry when a worker dies."""

TRIES_ALONE = 2
"""Retries of a shape alone after a worker died, before it is blamed."""

MAX_DEATHS = 12
"""Consecutive deaths of workers without any outcome after which the batch gives up: no single shape is the cause."""


class Crew:
    """An executor, and its replacements when workers die."""

    def __init__(self, executor: Executor | Callable[[], Executor]) -> None:
        self.make = executor if not isinstance(executor, Executor) else None
        self.executor = executor if isinstance(executor, Executor) else executor()
        self.own = not isinstance(executor, Executor)
        self.waiting: deque[Task] = deque()
        self.alone: deque[tuple[Task, int]] = deque()
        """Tasks that were in flight when a worker died, with their numbers of tries alone."""
        self.under_way: dict[Future[Outcome], Task] = {}
        self.deaths = 0
        self.cause: BaseException | None = None
        """What broke the executor, if it says so: a result that cannot be unpickled rather than a dead worker."""

    def run(self, tasks: Sequence[Task]) -> Generator[Outcome, None, None]:
        """Yield outcomes as they come in; start no further task once the caller stops iterating."""
        self.waiting.extend(tasks)
        try:
            while self.waiting or self.alone or self.under_way:
                broken = not self._hand_out()
                done = wait(self.under_way, return_when=FIRST_COMPLETED).done if self.under_way else ()
                for future in done:
                    error = future.exception()
                    if isinstance(error, BrokenExecutor):
                        broken, self.cause = True, error.__cause__
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

    def _came_back(self, task: Task) -> None:
        self.deaths = 0
        if self.alone and self.alone[0][0] is task:
            self.alone.popleft()

    def _hand_out(self) -> bool:
        """Submit as many tasks as the workers can take; False if they are dead."""
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
        """Replace the executor and retry the tasks in flight one at a time, to find the one to blame."""
        for future, task in list(self.under_way.items()):  # some had finished before
            if future.done() and not isinstance(future.exception(), BrokenExecutor):
                del self.under_way[future]
                self._came_back(task)
                error = future.exception()
                yield future.result() if error is None else _failed(task, error)
        lost = list(self.under_way.values())
        self.under_way.clear()
        self.deaths += 1
        if self.deaths > MAX_DEATHS:
            raise NestedCagesError(
                f"The workers died {self.deaths} times in a row without one outcome; see whether they start at all.",
                code="batch.invalid",
            )
        if not self.alone:
            self.alone.extend((task, 0) for task in lost)
        elif lost:
            task, tries = self.alone.popleft()
            if tries + 1 < TRIES_ALONE:
                self.alone.appendleft((task, tries + 1))
            else:
                yield _failed(task, NestedCagesError(_blame(task, self.cause), code="batch.invalid"))
        self.executor = self._another()
        self.own = True

    def _another(self) -> Executor:
        """A new executor like the one that died."""
        from concurrent.futures import ProcessPoolExecutor  # imports multiprocessing, which few need

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
            "makes executors.",
            code="batch.invalid",
        )


def _blame(task: Task, cause: BaseException | None) -> str:
    """Why a task broke its executor each time."""
    if cause is None:
        return f"The worker died whenever it made the shape {task.key!r}; simplify it or add memory."
    words = str(cause).strip(" \n\"'").splitlines() or [type(cause).__name__]
    return f"The result of the shape {task.key!r} cannot be read back from its worker ({words[-1]}); keep less of it."


def _failed(task: Task, error: BaseException) -> Outcome:
    """The outcome of a task that raised outside of the shape; exceptions that end the program are re-raised."""
    if not isinstance(error, Exception):
        raise error
    if not isinstance(error, NestedCagesError):
        error = NestedCagesError(
            f"The shape {task.key!r} could not be sent to or from its worker ({type(error).__name__}: {error}); give "
            "shapes, levels, settings and a result that can be pickled.",
            code="batch.invalid",
        )
    return Outcome(task.key, None, error)
