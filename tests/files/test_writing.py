"""Files are written whole or not at all, whoever writes them."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from nestedcages_core import NestedCagesError, to_geojson, to_svg, write_engine_json, write_geojson, write_svg
from support.command import run
from support.shapes import letter_a
from support.sources import ROOT

WRITERS = (write_svg, write_geojson, write_engine_json)
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="permissions, links, locks and kills of POSIX")


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize("call", ["os.fsync", "os.replace"])
def test_a_failure_leaves_the_old_file_and_nothing_else(
    write: Callable[..., None], call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "a.out"
    path.write_text("before")
    monkeypatch.setattr(call, full)
    with pytest.raises(OSError) as raised:
        write(path, letter_a(1))
    assert (raised.value.errno, raised.value.filename) == (28, str(path))
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("write", WRITERS)
def test_an_interrupt_leaves_nothing_behind(
    write: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "a.svg", letter_a(1))
    assert list(tmp_path.iterdir()) == []


@POSIX
def test_permissions_and_links_stay(tmp_path: Path) -> None:
    real, link = tmp_path / "real.svg", tmp_path / "link.svg"
    real.write_text("before")
    real.chmod(0o640)
    link.symlink_to(real)
    write_svg(link, letter_a(1))
    assert link.is_symlink()
    assert real.read_text() == to_svg(letter_a(1))
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    mask = os.umask(0o027)
    try:
        write_geojson(tmp_path / "new.geojson", letter_a(1))
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "new.geojson").stat().st_mode) == 0o640
    write_svg("/dev/null", letter_a(1))  # a device is no file to be replaced
    assert not Path("/dev/null").is_file()


def test_what_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(NestedCagesError) as error:
        write_svg(tmp_path / "a.svg", {"half \ud800": letter_a(1)})
    assert error.value.code == "file.invalid"
    with pytest.raises(FileNotFoundError) as raised:
        write_svg(tmp_path / "no" / "a.svg", letter_a(1))
    assert raised.value.filename == str(tmp_path / "no" / "a.svg")
    assert list(tmp_path.iterdir()) == []


WRITER = """
import os, sys
from nestedcages_core import Mesh, write_geojson
sync = os.fsync
os.fsync = lambda handle: (sync(handle), print("written", flush=True), sys.stdin.readline())
write_geojson(sys.argv[1], Mesh.of([(0, 0), (1, 0), (0, 1)]))
"""


@pytest.mark.slow
@POSIX
def test_what_a_killed_writer_leaves_is_cleaned_and_what_is_being_written_is_not(tmp_path: Path) -> None:
    other = tmp_path / ".mine.part"
    other.write_text("of another program")
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path / name)], env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )
        for name in ("killed.geojson", "alive.geojson")
    ]  # fmt: skip
    for writer in writers:
        assert writer.stdout is not None and writer.stdout.readline() == "written\n"
    before = {*tmp_path.iterdir()} - {other}
    assert len(before) == 2 and not {"killed.geojson", "alive.geojson"} & {path.name for path in before}
    writers[0].send_signal(signal.SIGKILL)
    writers[0].communicate()
    write_svg(tmp_path / "b.svg", letter_a(1))
    (left,) = before & {*tmp_path.iterdir()}
    assert "alive" in left.name
    writers[1].communicate("\n")
    assert {each.name for each in tmp_path.iterdir()} == {".mine.part", "b.svg", "alive.geojson"}
    assert (tmp_path / "alive.geojson").read_text().endswith("}")


def test_a_full_disk_ends_the_command_with_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.geojson").write_text(to_geojson(letter_a(1)))
    out = tmp_path / "out.svg"
    out.write_text("before")
    for problem in (OSError(28, "No space left on device"), OSError("odd")):

        def full(*_: object, problem: OSError = problem) -> None:
            raise problem

        monkeypatch.setattr("os.fsync", full)
        done = run(tmp_path / "a.geojson", "--levels", 24, "-o", out, "--quiet")
        assert (done.status, out.read_text()) == (1, "before")
        assert "out.svg" in done.err and "Traceback" not in done.err and "None" not in done.err
        assert len([*tmp_path.iterdir()]) == 2
