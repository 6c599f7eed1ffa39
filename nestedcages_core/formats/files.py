"""Files: read within limits; written whole or not at all, several of them as one unit."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from time import time
from typing import TypeVar

from ..errors import invalid_file
from .limits import Limits

FilePath = TypeVar("FilePath", bound=str | os.PathLike[str])

UNFINISHED = ".nested-cages.part"
"""Ending of what is not yet whole."""

ABANDONED = 3600.0
"""Seconds after which an unfinished file is one that a killed writer has left."""


def read_whole(path: str | os.PathLike[str], limits: Limits) -> bytes:
    """The contents of a file. Raises NestedCagesError for one beyond the limit, OSError for one that can't be read."""
    with Path(path).open("rb") as file:
        content = file.read(limits.bytes + 1)
    if len(content) > limits.bytes:
        limits.check("bytes", max(os.stat(path).st_size, len(content)))
    return content


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a file as `write_files` does."""
    write_files({path: content})


def write_files(contents: Mapping[FilePath, str | bytes]) -> None:
    """Write files that belong together, text as UTF-8.

    All are whole and on the disk, next to their places, before the first takes its place. They do so in the given
    order: a file stands after those that it refers to. After an error each file is either the old or the new one.

    Raises OSError, with the name of the file, where one cannot be written; NestedCagesError for text that is no UTF-8.
    """
    data = {Path(path): _encoded(path, content) for path, content in contents.items()}
    staged = dict[Path, Path]()
    try:
        for path, content in data.items():
            target = Path(os.path.realpath(path))  # keep links
            with _naming(path):
                if target.exists() and not target.is_file():  # devices and pipes have no content to lose
                    target.write_bytes(content)
                else:
                    staged[path] = target.with_name(f".{target.name[:40]}.{token_hex(8)}{UNFINISHED}")
                    _stage(staged[path], content, target)
        for path, beside in staged.items():
            with _naming(path):
                os.replace(beside, os.path.realpath(path))
    finally:
        for beside in staged.values():
            with suppress(OSError):
                beside.unlink()


def _stage(beside: Path, content: bytes, target: Path) -> None:
    """Write a file next to its place, whole and on the disk. Remove what killed writers have left there."""
    for left in target.parent.glob(f".*{UNFINISHED}"):
        with suppress(OSError):
            if time() - left.stat().st_mtime > ABANDONED:
                left.unlink()
    with beside.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    if target.exists():
        beside.chmod(stat.S_IMODE(target.stat().st_mode))


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Errors of the operating system name the file that was to be written."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error


def _encoded(path: str | os.PathLike[str], content: str | bytes) -> bytes:
    try:
        return content.encode("utf-8") if isinstance(content, str) else content
    except UnicodeEncodeError as error:
        half = f"the text has {error.object[error.start]!a}, which is half a character; correct the name."
        raise invalid_file(f"{Path(path).name} cannot be written: {half}") from error
