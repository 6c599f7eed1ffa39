"""Files are read within limits, and written whole or not at all."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from nestedcages_core import NestedCagesError
from nestedcages_core.exchange import (
    files,
    write_engine_json,
    write_geojson,
    write_svg,
    write_whole,
)
from support.shapes import letter_a

WRITERS = (write_svg, write_geojson, write_engine_json)


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize("call", ["os.fsync", "os.replace"])
def test_a_failure_leaves_the_old_file_and_nothing_else(
    write: object, call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "a.out"
    path.write_text("before")
    monkeypatch.setattr(call, full)
    with pytest.raises(OSError, match="No space") as raised:
        write(path, letter_a(1))
    assert raised.value.filename == str(path)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_an_interrupt_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path / "a.svg", "text")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="permissions and links of POSIX")
def test_permissions_and_links_stay(tmp_path: Path) -> None:
    real, link = tmp_path / "real.svg", tmp_path / "link.svg"
    real.write_text("before")
    real.chmod(0o640)
    link.symlink_to(real)
    write_whole(link, "after")
    assert link.is_symlink()
    assert real.read_text() == "after"
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    mask = os.umask(0o027)
    try:
        write_whole(tmp_path / "new.svg", b"new")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "new.svg").stat().st_mode) == 0o640
    write_whole("/dev/null", "text")  # a device is no file to be replaced
    assert not Path("/dev/null").is_file()


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    with pytest.raises(NestedCagesError, match=r"a.svg cannot be written: the text has '\\ud800'"):
        write_svg(tmp_path / "a.svg", {"half \ud800": letter_a(1)})
    with pytest.raises(FileNotFoundError) as raised:
        write_whole(tmp_path / "no" / "a.svg", "text")
    assert raised.value.filename == str(tmp_path / "no" / "a.svg")
    assert list(tmp_path.iterdir()) == []


KILLED = """
import os, signal, sys
from nestedcages_core.exchange import files
sync = files.os.fsync
files.os.fsync = lambda handle: (sync(handle), print("written", flush=True), sys.stdin.readline())
files.write_whole(sys.argv[1], "x" * 100_000)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="locks and kills of POSIX")
def test_what_a_killed_writer_leaves_is_cleaned_and_what_is_being_written_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other, mine = tmp_path / ".mine.part", tmp_path / "b.svg"
    other.write_text("of another program")
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", KILLED, str(tmp_path / name)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in ("killed.svg", "alive.svg")
    ]
    for writer in writers:
        assert writer.stdout.readline() == "written\n"
    writers[0].kill()
    writers[0].communicate()
    assert len(list(tmp_path.glob(f".*{files.UNFINISHED}"))) == 2
    monkeypatch.setattr(files, "_cleaned", set())
    write_whole(mine, "text")
    (left,) = tmp_path.glob(f".*{files.UNFINISHED}")
    assert left.name.startswith(".alive.svg.")
    writers[1].communicate("\n")
    assert {each.name for each in tmp_path.iterdir()} == {".mine.part", "b.svg", "alive.svg"}
    assert (tmp_path / "alive.svg").stat().st_size == 100_000
