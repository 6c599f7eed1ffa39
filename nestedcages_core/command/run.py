"""Run the command: read the files, make the cages, write the outputs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, TextIO

from ..errors import NestedCagesError
from ..exchange import Limits
from ..hierarchy import order_of
from .check import main as check_files
from .checks import check_use
from .making import Result, make
from .options import of_drawings, parser
from .outputs import STEM, check, entry, format_of, frames_of, put, report, table, target, text_of
from .progress import ProgressLine, tell
from .sources import STREAM, Source, expanded, read

DONE, FAILED, INTERRUPTED = 0, 1, 130
"""Exit statuses; the last is that of a program ended by Ctrl-C. Wrong use ends with 2, by argparse."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; the exit status."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words[:1] == ["check"]:
        return check_files(words[1:])
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError, OSError):  # a replaced stream, without an encoding
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    options = parser()
    given = options.parse_args(words)
    try:
        paths = expanded(given.input)
    except NestedCagesError as error:
        tell(f"error: {error}", sys.stderr)
        return FAILED
    check_use(options, given, paths)
    out = sys.stderr if STREAM in (*given.output, given.report) else sys.stdout
    line = ProgressLine(sys.stderr, silent=given.quiet, files=len(paths))
    order = order_of(given.levels)
    if order:
        tell(f"note: {order}", sys.stderr)
    entries: list[dict[str, Any]] = []
    failed = False
    try:
        frames = [path for path in given.output if len(paths) > 1 and path != STREAM and STEM not in path]
        given.output = [path for path in given.output if path not in frames]
        results: list[Result] = []
        for number, path in enumerate(paths):
            line.next_file(number)
            result, said = _file(path, given, line, out, several=len(paths) > 1)
            failed = failed or bool(said["errors"])
            entries.append(said)
            results.append(result)
        if len(paths) > 1:
            rows = zip(paths, results, (said["errors"] for said in entries), strict=True)
            tell(table(list(rows)), out)
        for file in frames:
            failed = not _animation(file, results, given, out) or failed
        if given.report is not None:
            put(given.report, report(entries))
    except (OSError, NestedCagesError) as error:
        line.end()
        tell(f"error: {_of_system(error, given.report or '') if isinstance(error, OSError) else error}", sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        line.end()
        tell("interrupted", sys.stderr)
        return INTERRUPTED
    return FAILED if failed else DONE


def _animation(path: str, results: Sequence[Result], given: argparse.Namespace, out: TextIO | None) -> bool:
    """Write the outlines of several pictures as frames of one animation; returns whether it succeeded."""
    try:
        put(path, frames_of(results, flip_y=given.flip_y))
    except NestedCagesError as error:
        tell(f"error: {path}: {error}", sys.stderr)
        return False
    tell(f"Wrote {path}", out)
    return True


def _file(
    path: str, given: argparse.Namespace, line: ProgressLine, out: TextIO | None, *, several: bool
) -> tuple[Result, dict[str, Any]]:
    """Process one file; returns its cages and its entry in the report, errors included."""
    result = Result(Source(path, "unknown"))
    written: list[str] = []
    failures: list[str] = []
    try:
        source = read(path, replace(Limits(), **given.limits), of_drawings(given))
        outputs = [(target(each, source), format_of(each, source, given.format)) for each in given.output]
        for file, kind in outputs:
            check(file, source, kind)
        for note in source.notes:
            tell(f"note: {path}: {note}" if several else f"note: {note}", sys.stderr)
        result = make(source, given, line)
        line.end()
        for made in result.made:
            for note in made.notes:
                name = f"{path}: " if several else ""
                tell(f"note: {name}{f'{made.shape.name}: ' if len(result.made) > 1 else ''}{note}", sys.stderr)
        if not several:
            _say(result, out)
        for file, kind in outputs if result.made else ():
            outline = {"flip_y": given.flip_y, "triangles": given.triangles, "pieces": given.pieces}
            put(file, text_of(result, kind, **outline))
            written.append(file)
            if file != STREAM and not several:
                tell(f"Wrote {file}", out)
        failures = list(result.failures)
    except NestedCagesError as error:
        failures = [*result.failures, str(error)]
    except OSError as error:
        failures = [*result.failures, _of_system(error, path)]
    line.end()
    for failure in failures:
        prefix = f"{path}: " if several and not failure.startswith(path) else ""
        tell(f"error: {prefix}{failure}", sys.stderr)
    return result, {**entry(result, written), "errors": failures}


def _of_system(error: OSError, path: str) -> str:
    """The message for an error of the operating system."""
    name = error.filename if error.filename is not None else path
    return f"{name}: {error.strerror or error or type(error).__name__}"


def _say(result: Result, out: TextIO | None) -> None:
    """Print the certificate of every cage, and what is to be said of borders."""
    several = len(result.source.shapes) + len(result.source.failures) > 1
    for each in result.made:
        fine = each.fine
        name = each.shape.name if several else "Drawing"
        tell(f"{name}: {len(fine.vertices)} vertices, {_counted(len(fine.loops), 'loop')}", out)
        for k, cage in enumerate(each.cages):
            tell(f"  Level {k + 1}: {len(cage.mesh.vertices)} vertices, {cage.report}", out)
    for k, level in enumerate(result.borders):
        tell(
            f"Level {k + 1} at its borders: {level['points']} points that cover {100.0 * level['overlap']:.3g} % of "
            f"the land, instead of {level['points_uncut']} that cover {100.0 * level['overlap_uncut']:.3g} %, of "
            f"{level['points_read']} read",
            out,
        )


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
