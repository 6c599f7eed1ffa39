"""Runs measurements on several cores and keeps each, so that a comparison that was interrupted goes on where it was."""

from __future__ import annotations

import pickle
import re
import sys
import time
from collections.abc import Callable, Hashable, Mapping
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class Bench:
    """Where measurements are made and kept."""

    jobs: int = 0
    """Processes; 0: this one."""
    store: Path | None = None
    """Folder of the measurements that are there already, of these very sources; None keeps none."""
    _took: dict[tuple[str, Hashable], float] = field(default_factory=dict, init=False, repr=False)
    _pool: ProcessPoolExecutor | None = field(default=None, init=False, repr=False)

    def each(
        self,
        experiment: str,
        function: Callable[..., Any],
        tasks: Mapping[Hashable, tuple[Any, ...]],
        told: Callable[[Any], str] = lambda _: "done",
    ) -> dict[Any, Any]:
        """The function of every task's arguments, in the order of the tasks; says how far it has come."""
        found = self._known(experiment)
        missing = {key: arguments for key, arguments in tasks.items() if key not in found}
        for done, (key, seconds, value) in enumerate(self._results(function, missing), 1):
            found[key] = value
            self._took[experiment, key] = seconds
            self._keep(experiment, key, seconds, value)
            name = ": ".join(map(str, key)) if isinstance(key, tuple) else str(key)
            place = f"{experiment} {done}/{len(missing)}"
            print(f"{seconds:7.2f} s  {place}: {name}: {told(value)}", file=sys.stderr, flush=True)
        return {key: found[key] for key in tasks}

    @property
    def seconds(self) -> float:
        """CPU seconds of all measurements, divided among the processes."""
        return sum(self._took.values()) / max(self.jobs, 1)

    def close(self) -> None:
        """End the processes."""
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)
            self._pool = None

    def _results(self, function: Callable[..., Any], tasks: Mapping[Hashable, tuple[Any, ...]]) -> Any:
        """(key, CPU seconds, value) of every task as it is done."""
        if not self.jobs:
            for key, arguments in tasks.items():
                yield key, *_timed(function, arguments)
            return
        self._pool = self._pool or ProcessPoolExecutor(self.jobs)
        waiting: dict[Future[Any], Hashable] = {
            self._pool.submit(_timed, function, arguments): key for key, arguments in tasks.items()
        }
        for future in as_completed(waiting):
            yield waiting[future], *future.result()

    def _file(self, experiment: str) -> Path | None:
        return self.store / f"{re.sub(r'[^a-z0-9]+', '-', experiment.lower())}.pickle" if self.store else None

    def _known(self, experiment: str) -> dict[Any, Any]:
        """What was measured before; a last entry that was cut off does not count."""
        path, found = self._file(experiment), dict[Any, Any]()
        if path is None or not path.is_file():
            return found
        with path.open("rb") as file:
            while True:
                try:
                    key, seconds, value = pickle.load(file)
                except (EOFError, pickle.UnpicklingError):
                    return found
                found[key] = value
                self._took[experiment, key] = seconds

    def _keep(self, experiment: str, key: Hashable, seconds: float, value: Any) -> None:
        path = self._file(experiment)
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("ab") as file:
                pickle.dump((key, seconds, value), file)


def _timed(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[float, Any]:
    began = time.process_time()
    value = function(*arguments)
    return time.process_time() - began, value
