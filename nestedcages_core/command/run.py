"""Make cages: read the files, run the method, write the outputs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TextIO

from ..errors import NestedCagesError
from ..formats import Limits
from ..levels import in_order
from .ground import on_ground
from .making import Result, make
from .options import STEM, STREAM, Metres, check_use, of_drawings
from .outputs import entry, frames_of, put, report, table, targets, text_of
from .progress import ProgressLine, sentence_of, tell
from .sources import Source, matching_files, read


def make_cages(options: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
    """Process all files and write what concerns them together; whether anything failed."""
    paths = matching_files(given.input)
    check_use(options, given, paths)
    out = sys.stderr if STREAM in (*given.output, given.report) else sys.stdout
    if in_order(given.levels) != given.levels:
        tell("note: The levels are made from the finest to the coarsest.", sys.stderr)
    several = len(paths) > 1
    frames = [path for path in given.output if several and path != STREAM and STEM not in path]
    given.output = [path for path in given.output if path not in frames]
    line = ProgressLine(sys.stderr, silent=given.quiet, files=len(paths))
    results: list[Result] = []
    entries: list[dict[str, Any]] = []
    try:
        for line.file, path in enumerate(paths):
            result, failures, written = _file(path, given, line, None if several else out)
            line.end()
            for failure in failures:
                known = failure.startswith(path) or not several
                tell(f"error: {failure if known else f'{path}: {failure}'}", sys.stderr)
            results.append(result)
            entries.append(entry(result, written, failures))
    finally:
        line.end()
    failed = any(said["errors"] for said in entries)
    if several:
        tell(table(entries), out)
    for file in frames:
        try:
            put({file: frames_of(results, flip_y=given.flip_y, pieces=given.pieces)})
            tell(f"Wrote {file}", out)
        except NestedCagesError as error:
            tell(f"error: {file}: {error}", sys.stderr)
            failed = True
    if given.report is not None:
        put({given.report: report(entries)})
    return failed


def _file(
    path: str, given: argparse.Namespace, line: ProgressLine, out: TextIO | None
) -> tuple[Result, Sequence[str], Sequence[str]]:
    """Process one file; returns its cages, a sentence for each failure, and what was written. out: None for silence."""
    result = Result(Source(path, "unknown"))
    prefix = f"{path}: " if line.files > 1 else ""
    try:
        source = read(path, replace(Limits(), **given.limits), of_drawings(given))
        outputs = targets(given.output, source)
        if isinstance(given.clearance, Metres):
            source = on_ground(source, given.clearance, inside=given.inside)
        for note in source.notes:
            tell(f"note: {prefix}{note}", sys.stderr)
        result = make(source, given, line)
        line.end()
        for note in result.notes:
            tell(f"note: {prefix}{note}", sys.stderr)
        tell(str(result), out)
        outputs = outputs if result.made else {}
        put({file: text_of(result, kind, flip_y=given.flip_y, pieces=given.pieces) for file, kind in outputs.items()})
        for file in outputs:
            if file != STREAM:
                tell(f"Wrote {file}", out)
        return result, result.failures, [*outputs]
    except (OSError, NestedCagesError) as error:
        return result, [*result.failures, sentence_of(error, path)], []
