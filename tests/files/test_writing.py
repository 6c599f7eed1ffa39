"""Files are written whole or not at all, whoever writes them."""

import math
import os
import re
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

import nestedcages_core as core
from nestedcages_core import Mesh, Settings, from_svg, nested_cages, to_geojson, to_svg, write_geojson, write_svg
from support.command import run
from support.documents import refusal, same, svg
from support.shapes import islands, letter_a, star
from support.sources import ROOT

FAILURES = [("os.fsync", OSError), ("os.replace", OSError), ("os.fsync", KeyboardInterrupt)]
SHAPES = [letter_a(1), islands(), star(5, 40)]
NARROW = Mesh.from_loops([[(0, 0), (4, 0), (4, 1), (7, 1), (7, 1 + 1e-7), (4, 1 + 1e-7), (4, 4), (0, 4)]])
FORMATS = [(write_svg, to_svg, from_svg), (write_geojson, to_geojson, core.from_geojson)]
WRITERS = (write_svg, write_geojson)
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="permissions, links, locks and kills of POSIX")


@pytest.mark.parametrize("mesh", SHAPES, ids=["letter", "islands", "star"])
@pytest.mark.parametrize(("write", "text", "read"), FORMATS, ids=["svg", "geojson"])
def test_what_is_written_is_read_back_to_the_last_bit(
    write: Any, text: Any, read: Any, mesh: Mesh, tmp_path: Path
) -> None:
    mesh, path = Mesh(mesh.vertices * math.pi, mesh.edges), tmp_path / "a.out"
    write(path, mesh)
    assert path.read_text(encoding="utf-8") == text(mesh)
    assert same(read(path.read_bytes()), mesh)
    assert same(read(text(mesh).encode("utf-8-sig")), mesh)
    assert same(read(text(NARROW)), NARROW)


@pytest.mark.parametrize("text", [to_svg, to_geojson])
def test_few_decimals_are_written_as_certified_or_not_at_all(text: Any) -> None:
    fine = letter_a(1)
    cage = nested_cages(fine, 24, Settings(grid=0.01, energy=core.Area())).cages[0]
    written = re.sub(r' (?!d=)[\w-]+="[^"]*"', "", text(cage, decimals=2))  # of SVG the data of paths alone
    assert max(len(number.partition(".")[2]) for number in re.findall(r"[-\d.]+(?:e-?\d+)?", written)) == 2
    for decimals in (16, True):
        assert refusal(text, fine, decimals=decimals).code == "file.invalid"
    error = refusal(text, fine, decimals=2)
    assert error.code == "numbers.unresolved"
    assert fine.vertices[error.data["vertex"]].tolist() == list(error.data["place"])


def test_a_drawing_beside_its_cage_is_written_as_it_is() -> None:
    fine = letter_a(1)
    cage = nested_cages(fine, 24, Settings(grid=0.01)).cages[0]
    text = to_svg({"drawing": fine, "cage": cage}, levels=[0, 1], decimals=2)
    assert same(from_svg(text, element="drawing"), fine)


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(("call", "kind"), FAILURES)
def test_a_failure_leaves_the_old_file_and_nothing_else(
    write: Callable[..., None], call: str, kind: type[BaseException], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.out"
    path.write_text("before")
    monkeypatch.setattr(call, Mock(side_effect=kind(28, "No space left on device")))
    with pytest.raises(kind) as raised:
        write(path, letter_a(1))
    if isinstance(raised.value, OSError):
        assert (raised.value.errno, raised.value.filename) == (28, str(path))
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


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
    assert refusal(write_svg, tmp_path / "a.svg", {"half \ud800": letter_a(1)}).code == "file.invalid"
    with pytest.raises(FileNotFoundError) as raised:
        write_svg(tmp_path / "no" / "a.svg", letter_a(1))
    assert raised.value.filename == str(tmp_path / "no" / "a.svg")
    assert list(tmp_path.iterdir()) == []


def test_what_killed_writers_leave_is_cleaned_and_what_is_being_written_is_not(tmp_path: Path) -> None:
    kill = "import os, sys; from nestedcages_core import Mesh, write_geojson; os.fsync = lambda _: os._exit(9)\n"
    kill += "write_geojson(sys.argv[1], Mesh.of([(0, 0), (1, 0), (0, 1)]))"
    for name in ("old.geojson", "new.geojson"):
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        subprocess.run([sys.executable, "-c", kill, str(tmp_path / name)], env=environment, check=False)
    old, new = sorted(tmp_path.iterdir(), key=lambda path: "new" in path.name)
    other = tmp_path / ".mine.part"
    other.write_text("of another program")
    for path in (old, other):
        os.utime(path, (0, 0))
    write_svg(tmp_path / "b.svg", letter_a(1))
    assert {*tmp_path.iterdir()} == {other, new, tmp_path / "b.svg"}


@pytest.mark.parametrize("failing", [("os.fsync", OSError, 0), ("os.fsync", OSError, 2), ("os.replace", OSError, 0),
                                     ("os.fsync", KeyboardInterrupt, 2)])  # fmt: skip
def test_several_files_are_written_together(failing: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The outputs for a drawing, and the files of a puppet, of which each is renamed after those it refers to."""
    call, kind, after = failing
    (tmp_path / "a.geojson").write_text(to_geojson(letter_a(1)))
    (tmp_path / "cat.svg").write_text(svg('<g id="a"><path d="M0 0h9v9h-9z"/></g><path d="M20 0h9v9h-9z"/>'))
    outputs = [tmp_path / f"out.{ending}" for ending in ("svg", "geojson")]
    atlas = [tmp_path / f"cat{ending}" for ending in (".png", ".atlas", ".json")]
    commands = [[tmp_path / "a.geojson", "--levels", 24, "--quiet", "-o", outputs[0], "-o", outputs[1]],
                ["puppet", tmp_path / "cat.svg", "-o", atlas[-1], "--pixels", 90]]  # fmt: skip
    for command, names in zip(commands, (outputs, atlas), strict=True):
        for path in names:
            path.write_text("before")
        before = {*tmp_path.iterdir()}
        real, renamed = os.replace, list[str]()
        with monkeypatch.context() as patch:
            error = kind(28, "No space left on device")
            effects = [None] * min(after, len(names) - 1)
            patch.setattr(call, Mock(side_effect=[*effects, error]))
            done = run(*command)
        assert done.status == (130 if kind is KeyboardInterrupt else 1) and "Traceback" not in done.err
        assert [path.read_text() for path in names] == ["before"] * len(names)
        assert {*tmp_path.iterdir()} == before
        monkeypatch.setattr("os.replace", lambda a, b, seen=renamed, real=real: (seen.append(str(b)), real(a, b)))
        assert run(*command).status == 0 and renamed == [str(path) for path in names]
        monkeypatch.undo()


def test_a_full_disk_ends_the_command_with_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.geojson").write_text(to_geojson(letter_a(1)))
    out = tmp_path / "out.svg"
    out.write_text("before")
    for problem in (OSError(28, "No space left on device"), OSError("odd")):
        monkeypatch.setattr("os.fsync", Mock(side_effect=problem))
        done = run(tmp_path / "a.geojson", "--levels", 24, "-o", out, "--quiet")
        assert (done.status, out.read_text()) == (1, "before")
        assert "out.svg" in done.err and "Traceback" not in done.err and "None" not in done.err
        assert len([*tmp_path.iterdir()]) == 2
