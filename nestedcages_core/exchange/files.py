"""Files: read within limits, written whole or not at all, with few decimals exactly as certified or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from decimal import Context, Decimal
from pathlib import Path

import numpy as np

from ..errors import NestedCagesError, invalid_file
from ..geometry.arrays import FloatArray
from ..geometry.lattice import Grid
from ..geometry.mesh import Mesh
from ..geometry.vectors import place
from .limits import Limits

DEFAULT_MODE = 0o666
"""Permissions of a new file before the user's umask."""

MAX_DECIMALS = 15
"""Maximum number of decimals that every double can have."""

ENOUGH_DIGITS = Context(prec=60)
"""Digits for sums of decimals: enough for two doubles of comparable size."""


def read_whole(path: str | os.PathLike[str], limits: Limits) -> bytes:
    """The contents of a file. Raises NestedCagesError for one beyond the limit, OSError for one that can't be read."""
    with Path(path).open("rb") as file:
        content = file.read(limits.bytes + 1)
    if len(content) > limits.bytes:
        limits.check("bytes", max(os.stat(path).st_size, len(content)))
    return content


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a file, text as UTF-8. After an error the file is either the old or the new one, never a part.

    Raises OSError, with the name of the file, where it cannot be written; NestedCagesError for text that is no UTF-8.
    """
    given = Path(path)
    try:
        data = content.encode("utf-8") if isinstance(content, str) else content
    except UnicodeEncodeError as error:
        character = error.object[error.start]
        raise invalid_file(
            f"{given.name} cannot be written: the text has {character!a}, which is half a character; correct the name."
        ) from error
    target = Path(os.path.realpath(given))  # keep links
    if target.exists() and not target.is_file():  # devices and pipes have no content to lose
        target.write_bytes(data)
        return
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{target.name[:40]}.", suffix=".part", dir=target.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.chmod(beside, stat.S_IMODE(target.stat().st_mode) if target.exists() else DEFAULT_MODE & ~_umask())
            os.replace(beside, target)
        except BaseException:
            with suppress(OSError):
                os.unlink(beside)
            raise
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(given)) from error


def _umask() -> int:
    """The user's umask; it can only be read by setting it."""
    current = os.umask(0)
    os.umask(current)
    return current


def check_decimals(meshes: Iterable[Mesh], decimals: int | None) -> None:
    """Raise NestedCagesError if a vertex has more decimals, since rounding would invalidate the certificate."""
    if decimals is None:
        return
    if isinstance(decimals, bool) or not isinstance(decimals, int | np.integer) or not 0 <= decimals <= MAX_DECIMALS:
        raise invalid_file(f"The decimals must be a whole number from 0 to {MAX_DECIMALS}, not {decimals!r}.")
    grid = Grid.of_decimals(int(decimals))
    for mesh in meshes:
        off = (grid.points(grid.places(mesh.vertices)) != mesh.vertices).any(axis=1)
        if off.any() or not grid.resolves(mesh.vertices):
            vertex = int(off.argmax())
            raise NestedCagesError(
                f"Vertex {vertex} at {place(mesh.vertices[vertex])} has more than {decimals} decimals, and rounding "
                f"would undo what is certified; make the cage with Settings(grid={grid.spacing:g}).",
                code="numbers.unresolved",
                vertex=vertex,
                place=mesh.vertices[vertex],
            )


def subtracted(whole: float, numbers: FloatArray) -> FloatArray:
    """(n,) whole - numbers (n,) in decimal arithmetic, rounded once to doubles, so that few decimals stay few."""
    minuend = Decimal(repr(float(whole)))
    return np.array([float(ENOUGH_DIGITS.subtract(minuend, Decimal(repr(number)))) for number in numbers.tolist()])
