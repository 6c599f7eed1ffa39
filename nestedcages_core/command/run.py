"""Make cages: read the files, run the method, write the outputs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ..errors import NestedCagesError
from ..levels import Settings
from .making import Result, make, settings_of
from .options import STEM, STREAM, check_use, format_of
from .outputs import entry, frames_of, geojson_of, put, report, summary, svg_of
from .printing import ProgressLine, sentence_of, tell
from .sources import Source, matching_files, read


def make_cages(options: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
    """Process all files and write what concerns them together; whether anything failed."""
    paths = matching_files(given.input)
    check_use(options, given, paths)
    try:
        settings = settings_of(given)
    except NestedCagesError as error:
        options.error(str(error))
    out = sys.stderr if STREAM in (*given.output, given.report) else sys.stdout
    several = len(paths) > 1
    frames = [path for path in given.output if several and path != STREAM and STEM not in path]
    given.output = [path for path in given.output if path not in frames]
    line, results, entries, failed = ProgressLine(len(paths)), list[Result](), [], False
    try:
        for line.file, path in enumerate(paths):
            result, failures, written = _file(path, given, settings, line)
            line.end()
            for failure in failures:
                known = failure.startswith(path) or not several
                tell(f"error: {failure if known else f'{path}: {failure}'}", sys.stderr)
            if result.made or several:
                tell(summary(result, failures) if several else str(result), out)
            for file in written:
                tell(f"Wrote {file}", out if file != STREAM else None)
            results.append(result)
            entries.append(entry(result, written, failures))
            failed |= bool(failures)
    finally:
        line.end()
    for file in frames:
        try:
            put({file: frames_of(results, given)})
            tell(f"Wrote {file}", out)
        except NestedCagesError as error:
            tell(f"error: {file}: {error}", sys.stderr)
            failed = True
    if given.report is not None:
        put({given.report: report(entries)})
    return failed


def _file(
    path: str, given: argparse.Namespace, settings: Settings, line: ProgressLine
) -> tuple[Result, Sequence[str], Sequence[str]]:
    """Process one file; returns its cages, a sentence for each failure, and what was written."""
    result, prefix = Result(Source(path, "unknown")), f"{path}: " if line.files > 1 else ""
    try:
        source = read(path, given)
        for note in source.notes:
            tell(f"note: {prefix}{note}", sys.stderr)
        result = make(source, given, settings, (lambda *_: None) if given.quiet else line.show)
        line.end()
        for note in result.notes:
            tell(f"note: {prefix}{note}", sys.stderr)
        texts: dict[str, str] = {}
        for name in given.output if result.made else ():
            file = name.replace(STEM, "stdin" if path == STREAM else Path(path).stem)
            texts[file] = svg_of(result) if format_of(name, source.kind) == "svg" else geojson_of(result, given)
        put(texts)
        return result, result.failures, [*texts]
    except (OSError, NestedCagesError) as error:
        return result, [*result.failures, sentence_of(error, path)], []
