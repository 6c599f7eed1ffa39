"""Files are read within limits, and written whole or not at all."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

import pytest

from nestedcages_core import NestedCagesError
from nestedcages_core.exchange import (
    write_engine_json,
    write_geojson,
    write_svg,
    write_whole,
)
from shapes import letter_a

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
