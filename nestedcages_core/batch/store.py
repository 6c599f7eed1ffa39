"""Outcomes on disk, one file each: arrays as npz, everything else as JSON. Reading runs no code from the files."""

from __future__ import annotations

import hashlib
import io
import json
import os
from collections.abc import Iterator, MutableMapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from ..contact.reinflation import Reinflation
from ..errors import NestedCagesError
from ..exchange import write_whole
from ..flow import FlowResult
from ..geometry.mesh import Mesh
from ..hierarchy import Hierarchy, Level, NestingReport
from .tasks import Outcome

OUTCOME_FORMAT, OUTCOME_VERSION = "nested-cages outcome", 1
"""Identifies the files."""

ENDING = ".npz"

RECORDS = {kind.__name__: kind for kind in (Hierarchy, Level, NestingReport, FlowResult, Reinflation)}
"""Dataclasses that can be stored, by name."""


class OutcomeFolder(MutableMapping[Any, Outcome]):
    """Outcomes by key in a folder, for ``nested_cages_many(…, finished=OutcomeFolder("cages"))``.

    Keys are strings and integers. Results may be a Hierarchy, meshes, arrays, numbers, strings, and lists, tuples and
    dicts of these; outcomes with an error are not stored. A file is written whole or not at all. A truncated or
    foreign file raises KeyError as if it were missing, and is replaced once its shape is done.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def __setitem__(self, key: Any, outcome: Outcome) -> None:
        if outcome.error is not None:
            return
        arrays: list[Any] = []
        known = {
            "format": OUTCOME_FORMAT,
            "version": OUTCOME_VERSION,
            "key": _checked(key),
            "seconds": outcome.seconds,
            "made_of": outcome.made_of,
            "result": _packed(outcome.result, arrays),
        }
        file = io.BytesIO()
        named = {f"a{k}": array for k, array in enumerate(arrays)}
        np.savez_compressed(file, outcome=np.array(json.dumps(known)), **named)
        write_whole(self._path(key), file.getvalue())

    def __getitem__(self, key: Any) -> Outcome:
        known, outcome = _read(self._path(key))
        if known != key:
            raise KeyError(key)
        return outcome

    def __delitem__(self, key: Any) -> None:
        try:
            self._path(key).unlink()
        except FileNotFoundError:
            raise KeyError(key) from None

    def __iter__(self) -> Iterator[Any]:
        for path in sorted(self.folder.glob(f"*{ENDING}")):
            try:
                yield _read(path)[0]
            except KeyError:
                continue

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _path(self, key: Any) -> Path:
        text = json.dumps(_checked(key))
        return self.folder / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}{ENDING}"


def _read(path: Path) -> tuple[Any, Outcome]:
    """Key and outcome of a file. Raises KeyError for one that is missing, truncated or foreign."""
    try:
        with np.load(path) as arrays:  # rejects pickled objects
            known = json.loads(str(arrays["outcome"]))
            if (known["format"], known["version"]) != (OUTCOME_FORMAT, OUTCOME_VERSION):
                raise KeyError(path.name)
            key = known["key"]
            return key, Outcome(key, _unpacked(known["result"], arrays), None, known["seconds"], known["made_of"])
    except Exception as error:  # a truncated or foreign file may raise anything
        raise KeyError(path.name) from error


def _checked(key: Any) -> Any:
    if isinstance(key, bool) or not isinstance(key, str | int):
        raise NestedCagesError(
            f"The key {key!r} cannot name a file; give texts or whole numbers as keys.", code="batch.invalid"
        )
    return key


def _packed(value: Any, arrays: list[Any]) -> Any:
    """A value as JSON; its arrays are appended to the list and referred to by index."""

    def stored(array: Any) -> dict[str, Any]:
        arrays.append(array)
        return {"array": len(arrays) - 1}

    if isinstance(value, Mesh):
        return {"mesh": [stored(value.vertices), stored(value.edges)]}
    if isinstance(value, np.ndarray) and value.dtype.kind in "buifc":
        return stored(value)
    if isinstance(value, np.generic):
        return _packed(value.item(), arrays)
    if value is None or isinstance(value, bool | int | float | str):
        return {"value": value}
    if isinstance(value, list | tuple):
        return {type(value).__name__: [_packed(item, arrays) for item in value]}
    if isinstance(value, dict):
        return {"dict": [[_packed(key, arrays), _packed(item, arrays)] for key, item in value.items()]}
    if RECORDS.get(type(value).__name__) is type(value):
        parts = {field.name: _packed(getattr(value, field.name), arrays) for field in fields(value)}
        return {"record": type(value).__name__, "parts": parts}
    raise NestedCagesError(
        f"a {type(value).__name__} cannot be stored; keep meshes, arrays, numbers, texts, and lists of these.",
        code="batch.invalid",
    )


def _unpacked(packed: Any, arrays: Any) -> Any:
    """The value of its JSON; meshes are validated."""
    if "array" in packed:
        return arrays[f"a{packed['array']}"]
    if "mesh" in packed:
        return Mesh(*(_unpacked(part, arrays) for part in packed["mesh"]))
    if "value" in packed:
        return packed["value"]
    if "dict" in packed:
        return {_unpacked(key, arrays): _unpacked(item, arrays) for key, item in packed["dict"]}
    if "record" in packed:
        parts = {name: _unpacked(part, arrays) for name, part in packed["parts"].items()}
        return RECORDS[packed["record"]](**parts)
    kind = tuple if "tuple" in packed else list
    return kind(_unpacked(item, arrays) for item in packed[kind.__name__])
