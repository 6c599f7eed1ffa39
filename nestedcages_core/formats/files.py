"""Files: read within limits, written whole or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path

from ..errors import invalid_file
from .limits import Limits

try:
    from fcntl import LOCK_EX, LOCK_NB, flock  # noqa: TID251 - guarded

    LOCKS = True
except ImportError:  # on Windows, where files that are open cannot be removed
    LOCKS = False

DEFAULT_MODE = 0o666
"""Permissions of a new file before the user's umask."""

UNFINISHED = ".nested-cages.part"
"""Ending of what is not yet whole; its writer holds a lock on it."""

_cleaned: set[Path] = set()
"""Folders without what killed writers have left."""


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
        _clean(target.parent)
        handle, beside = _locked(target)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
                os.chmod(beside, stat.S_IMODE(target.stat().st_mode) if target.exists() else DEFAULT_MODE & ~_umask())
                if LOCKS:
                    os.replace(beside, target)
            if not LOCKS:
                os.replace(beside, target)
        except BaseException:
            with suppress(OSError):
                os.unlink(beside)
            raise
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(given)) from error


def _locked(target: Path) -> tuple[int, str]:
    """A new file next to a target, open and locked, and its path."""
    while True:
        handle, beside = tempfile.mkstemp(prefix=f".{target.name[:40]}.", suffix=UNFINISHED, dir=target.parent)
        if LOCKS:
            with suppress(OSError):  # some network folders have no locks
                flock(handle, LOCK_EX)
        if not LOCKS or os.fstat(handle).st_nlink:
            return handle, beside
        os.close(handle)  # somebody cleaned it away before it was locked


def _clean(folder: Path) -> None:
    """Remove what killed writers have left in a folder, once in a process."""
    if folder in _cleaned:
        return
    _cleaned.add(folder)
    for left in folder.glob(f".*{UNFINISHED}"):
        with suppress(OSError), left.open("rb") as file:
            if LOCKS:
                flock(file, LOCK_EX | LOCK_NB)
                left.unlink()
        if not LOCKS:
            with suppress(OSError):
                left.unlink()


def _umask() -> int:
    """The user's umask; it can only be read by setting it."""
    current = os.umask(0)
    os.umask(current)
    return current
