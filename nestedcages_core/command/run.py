"""Run the command: read the files, make the cages, write the outputs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, TextIO

from ..errors import NestedCagesError
from ..formats import Limits
from ..levels import in_order
from .check import check_files
from .making import Result, make
from .options import check_use, of_drawings, parser
from .outputs import STEM, entry, frames_of, is_made, put, report, table, targets, text_of
from .progress import ProgressLine, tell
from .sources import STREAM, Source, kind_of, matching_files, read

DONE, FAILED, INTERRUPTED = 0, 1, 130
"""Exit statuses; the last is that of a program ended by Ctrl-C. Wrong use ends with 2, by argparse."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; the exit status."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words[:1] == ["check"]:
        return check_files(words[1:])
    if words[:1] == ["puppet"]:
        from .puppet import make_puppet  # imports what makes puppets, which others don't need

        return FAILED if make_puppet(words[1:]) else DONE
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError, OSError):  # a replaced stream, without an encoding
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    options = parser()
    given = options.parse_args(words)
    line = None
    try:
        paths = matching_files(given.input)
        check_use(options, given, paths)
        line = ProgressLine(sys.stderr, silent=given.quiet, files=len(paths))
        return FAILED if _all(paths, given, line) else DONE
    except (OSError, NestedCagesError) as error:
        problem, status = f"error: {_words(error, given.report or '')}", FAILED
    except KeyboardInterrupt:
        problem, status = "interrupted", INTERRUPTED
    if line is not None:
        line.end()
    tell(problem, sys.stderr)
    return status


def _all(paths: Sequence[str], given: argparse.Namespace, line: ProgressLine) -> bool:
    """Process all files and write what concerns them together; whether anything failed."""
    out = sys.stderr if STREAM in (*given.output, given.report) else sys.stdout
    if in_order(given.levels) != given.levels:
        tell("note: The levels are made from the finest to the coarsest.", sys.stderr)
    several = len(paths) > 1
    frames = [path for path in given.output if several and path != STREAM and STEM not in path]
    given.output = [path for path in given.output if path not in frames]
    results: list[Result] = []
    entries: list[dict[str, Any]] = []
    for number, path in enumerate(paths):
        line.next_file(number)
        if several and not frames and not given.again and is_made(path, given.output):
            tell(f"note: {path}: skipped, since its outputs are newer; --again makes them again", sys.stderr)
            entries.append(entry(Result(Source(path, kind_of(path) or "unknown")), (), (), skipped=True))
            continue
        result, said = _file(path, given, line, out, several=several)
        results.append(result)
        entries.append(said)
    failed = any(said["errors"] for said in entries)
    if several:
        tell(table(entries), out)
    for file in frames:
        try:
            put(file, frames_of(results, flip_y=given.flip_y))
            tell(f"Wrote {file}", out)
        except NestedCagesError as error:
            tell(f"error: {file}: {error}", sys.stderr)
            failed = True
    if given.report is not None:
        put(given.report, report(entries))
    return failed


def _file(
    path: str, given: argparse.Namespace, line: ProgressLine, out: TextIO | None, *, several: bool
) -> tuple[Result, dict[str, Any]]:
    """Process one file; returns its cages and its entry in the report, errors included."""
    result = Result(Source(path, "unknown"))
    written: list[str] = []
    failures: list[str] = []
    prefix = f"{path}: " if several else ""
    try:
        source = read(path, replace(Limits(), **given.limits), of_drawings(given))
        outputs = targets(given.output, source, given.format)
        for note in source.notes:
            tell(f"note: {prefix}{note}", sys.stderr)
        result = make(source, given, line)
        line.end()
        for made in result.made:
            name = f"{made.shape.name}: " if len(result.made) > 1 else ""
            for note in made.notes:
                tell(f"note: {prefix}{name}{note}", sys.stderr)
        if not several:
            _say(result, out)
        for file, kind in outputs if result.made else ():
            put(file, text_of(result, kind, flip_y=given.flip_y, triangles=given.triangles, pieces=given.pieces))
            written.append(file)
            if file != STREAM and not several:
                tell(f"Wrote {file}", out)
        failures = list(result.failures)
    except (OSError, NestedCagesError) as error:
        failures = [*result.failures, _words(error, path)]
    line.end()
    for failure in failures:
        tell(f"error: {failure if failure.startswith(path) else prefix + failure}", sys.stderr)
    return result, entry(result, written, failures)


def _words(error: OSError | NestedCagesError, path: str) -> str:
    """The message of an error; that of the operating system with its file."""
    if not isinstance(error, OSError):
        return str(error)
    name = error.filename if error.filename is not None else path
    return f"{name}: {error.strerror or error or type(error).__name__}"


def _say(result: Result, out: TextIO | None) -> None:
    """Print the certificate of every cage, and how far borders moved."""
    several = len(result.source.shapes) + len(result.source.failures) > 1
    for each in result.made:
        count = len(each.fine.loops)
        name = each.shape.name if several else "Drawing"
        tell(f"{name}: {len(each.fine.vertices)} vertices, {count} loop{'s' * (count != 1)}", out)
        for k, level in enumerate(each.levels, 1):
            tell(f"  Level {k}: {len(level.cage.vertices)} vertices, {level.report}", out)
    for k, coverage in enumerate(result.coverages, 1):
        tell(f"Level {k}: {coverage.points} points with all borders, which moved by {coverage.width:.3g} at most", out)
