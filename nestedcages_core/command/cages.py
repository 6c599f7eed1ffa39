"""Make cages: read the files, run the method, write the outputs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..errors import NestedCagesError
from ..levels import Settings
from .making import make, settings_of
from .options import STEM, STREAM, check_use, format_of
from .outputs import certificates, frames_of, geojson_of, put, report, svg_of
from .printing import ProgressLine, sentence_of, tell
from .sources import Source, matching_files, read


def run(options: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
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
    line, sources = ProgressLine(len(paths)), list[Source]()
    for line.file, path in enumerate(paths):
        try:
            source = _of_file(path, given, settings, line)
        finally:
            line.end()
        name = f"{path}: " if several else ""
        for kind, sentences in (("note", source.notes), ("error", source.failures)):
            for sentence in sentences:
                tell(f"{kind}: {sentence if sentence.startswith(path) else f'{name}{sentence}'}", sys.stderr)
        if said := certificates(source):
            tell(f"{name}{said}", out)
        sources.append(source)
    failed = any(source.failures for source in sources)
    for file in frames:
        try:
            put({file: geojson_of(frames_of(sources, given), given)})
            tell(f"Wrote {file}", out)
        except NestedCagesError as error:
            tell(f"error: {file}: {error}", sys.stderr)
            failed = True
    if given.report is not None:
        put({given.report: report(sources)})
    return failed


def _of_file(path: str, given: argparse.Namespace, settings: Settings, line: ProgressLine) -> Source:
    """Read a file, make its cages and write them."""
    source = Source(path, "unknown")
    try:
        source = make(read(path, given), given, settings, (lambda *_: None) if given.quiet else line.show)
        texts: dict[str, str] = {}
        for name in given.output if source.made else ():
            file = name.replace(STEM, "stdin" if path == STREAM else Path(path).stem)
            texts[file] = svg_of(source) if format_of(name, source.kind) == "svg" else geojson_of(source, given)
        put(texts)
        return source._replace(written=[*texts])
    except (OSError, NestedCagesError) as error:
        return source._replace(failures=[*source.failures, sentence_of(error, path)])
