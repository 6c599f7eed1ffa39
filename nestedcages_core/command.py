"""The command for shells: a drawing, a map or a picture goes in, certified cages come out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

from .batch import BatchProgress, nested_cages_many
from .errors import NestedCagesError
from .exchange import Feature, features_from_geojson, read_svg, to_engine_json, to_geojson, to_svg
from .hierarchy import Hierarchy, Level, Progress, Settings, nested_cages
from .mesh import Mesh
from .pictures import picture_cages, read_png

DONE, FAILED, WRONG_USE, INTERRUPTED = 0, 1, 2, 130
"""Exit statuses; the last is that of a program ended by Ctrl-C."""

MAPS = (".geojson", ".json")
INPUTS = (".svg", *MAPS, ".png")
OUTPUTS = (".svg", ".geojson", ".json")

BAR = 24
"""Characters of the progress bar."""

DESCRIPTION = """\
Wraps a drawing, a map or a sprite in nested cages: coarse outlines that strictly enclose it, never cross themselves,
and hug it as tightly as their vertices allow. Every cage is certified by exact predicates before it is written."""

EPILOG = """\
input files:
  .svg            filled areas; curves become chords within --tolerance, overlapping shapes are united
  .geojson .json  polygons; every feature gets its own cages
  .png            opaque pixels, in pixels with y downwards

output files (by extension, all lengths and places in the units of the input):
  .svg            the drawing and its cages, as paths with the ids "drawing", "cage-1", "cage-2", ...
  .geojson        one feature per cage, with its level, vertices, excess and clearance
  .json           a collision outline for game engines: the coarsest cage as outer loops and holes

exit status:
  0  all cages were made, certified and written
  1  a cage could not be made or a file not be read; the message says why. Of several features those that worked are
     written
  2  wrong use of the options
  130  interrupted

examples:
  python -m nestedcages_core logo.svg --levels 64 24 -o cages.svg
  python -m nestedcages_core sprite.png --levels 16 --padding 2 -o outline.json --flip-y
  python -m nestedcages_core regions.geojson --levels 200 50 --jobs 4 -o simple.geojson
"""


@dataclass(frozen=True, eq=False)
class Made:
    """The cages of one drawing, or of one feature of a map."""

    name: str
    hierarchy: Hierarchy
    properties: Mapping[str, Any] = field(default_factory=dict)
    id: str | int | None = None
    height: float = 0.0
    """Of a picture, in pixels: what its y is turned over in."""


def parser() -> argparse.ArgumentParser:
    """The options."""
    options = argparse.ArgumentParser(
        prog="python -m nestedcages_core",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("input", type=Path, help="the file to read: .svg, .geojson or .png")
    options.add_argument(
        "--levels", type=_count, nargs="+", required=True, metavar="N",
        help="vertices of each cage, from the finest to the coarsest",
    )
    options.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="FILE",
        help="file to write: .svg, .geojson or .json; may be given several times; without it the cages are only made "
        "and certified",
    )
    options.add_argument(
        "--clearance", type=_length, metavar="LENGTH",
        help="smallest distance between a cage and what it encloses (default: 1e-5 of the drawing's diagonal)",
    )
    options.add_argument("--quiet", action="store_true", help="no progress")
    drawings = options.add_argument_group("drawings (.svg)")
    drawings.add_argument(
        "--tolerance", type=_length, metavar="LENGTH",
        help="greatest distance between a curve and its chords (default: 1/2000 of the drawing's diagonal); a "
        "clearance of at least as much encloses the curves themselves",
    )
    drawings.add_argument("--element", metavar="ID", help="read only the element with this id")
    maps = options.add_argument_group("maps (.geojson)")
    maps.add_argument("--jobs", type=_count, default=1, metavar="N", help="processes for the features (default: 1)")
    sprites = options.add_argument_group("pictures (.png)")
    sprites.add_argument("--padding", type=_length, metavar="PIXELS", help="the clearance; parts closer are joined")
    sprites.add_argument(
        "--threshold", type=_share, default=0.0, metavar="ALPHA",
        help="opacity from 0 to 1 above which a pixel counts as opaque (default: 0)",
    )
    sprites.add_argument("--holes", action="store_true", help="keep holes open (default: closed)")
    engines = options.add_argument_group("collision outlines (.json)")
    engines.add_argument(
        "--flip-y", action="store_true", help="turn y over; that of a picture then counts upwards from its lower edge"
    )
    engines.add_argument("--triangles", action="store_true", help="add the triangles of the outline")
    return options


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; the exit status."""
    options = parser()
    given = options.parse_args(arguments)
    if given.input.suffix.lower() not in INPUTS:
        options.error(f"{given.input.name}: a file is read if it ends in {', '.join(INPUTS)}")
    for path in given.output:
        if path.suffix.lower() not in OUTPUTS:
            options.error(f"{path.name}: a file is written if it ends in {', '.join(OUTPUTS)}")
        if not path.parent.is_dir():
            options.error(f"{path}: there is no folder {path.parent}")
    if given.padding is not None and given.clearance is not None:
        options.error("--padding is the clearance of pictures; give only one of them")
    line = _ProgressLine(sys.stderr, silent=given.quiet)
    try:
        made, failures = _make(given, line)
        line.end()
        for each in made:
            _report(each, several=len(made) + len(failures) > 1)
        for failure in failures:
            print(f"error: {failure}", file=sys.stderr)
        texts = {path: _written(path.suffix.lower(), made, given) for path in given.output} if made else {}
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8")
            print(f"Wrote {path}")
        return FAILED if failures else DONE
    except NestedCagesError as error:
        line.end()
        print(f"error: {error}", file=sys.stderr)
        return FAILED
    except OSError as error:
        line.end()
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        line.end()
        print("interrupted", file=sys.stderr)
        return INTERRUPTED


def _make(given: argparse.Namespace, line: _ProgressLine) -> tuple[list[Made], list[str]]:
    """The cages, and a sentence for each feature that has none."""
    settings = Settings(clearance=given.clearance)
    kind = given.input.suffix.lower()
    if kind == ".png":
        picture = read_png(given.input)
        hierarchy = picture_cages(
            picture,
            given.levels,
            padding=given.padding or given.clearance or 0.0,
            threshold=given.threshold,
            holes=given.holes,
            progress=line.of_run,
        )
        return [Made("drawing", hierarchy, height=float(len(picture)))], []
    if kind == ".svg":
        drawing = read_svg(given.input, tolerance=given.tolerance, element=given.element)
        return [Made("drawing", nested_cages(drawing, given.levels, settings, progress=line.of_run))], []
    features = features_from_geojson(given.input.read_bytes())
    if not features:
        raise NestedCagesError(f"{given.input.name} has no polygons; give a map with Polygon or MultiPolygon features.")
    if len(features) == 1:
        hierarchy = nested_cages(features[0].mesh, given.levels, settings, progress=line.of_run)
        return [_of_feature(features[0], 0, hierarchy)], []
    outcomes = nested_cages_many(
        [feature.mesh for feature in features],
        {k: _no_more_than(given.levels, feature.mesh) for k, feature in enumerate(features)},
        settings,
        executor=(lambda: ProcessPoolExecutor(given.jobs)) if given.jobs > 1 else None,
        progress=line.of_batch,
    )
    made = [
        _of_feature(feature, k, outcome.result)
        for k, (feature, outcome) in enumerate(zip(features, outcomes, strict=True))
        if outcome.error is None
    ]
    failures = [
        f"{_name(feature, k)}: {outcome.error}"
        for k, (feature, outcome) in enumerate(zip(features, outcomes, strict=True))
        if outcome.error is not None
    ]
    return made, failures


def _no_more_than(levels: Sequence[int], mesh: Mesh) -> list[int]:
    """The levels, none with more vertices than the mesh: features are of many sizes."""
    return [min(level, len(mesh.vertices)) for level in levels]


def _of_feature(feature: Feature, number: int, hierarchy: Hierarchy) -> Made:
    return Made(_name(feature, number), hierarchy, feature.properties, feature.id)


def _name(feature: Feature, number: int) -> str:
    known = feature.properties.get("name") or feature.properties.get("NAME") or feature.id
    return f"feature {number}" + (f" ({known})" if known is not None else "")


def _report(made: Made, several: bool) -> None:
    """The certificate of every cage."""
    before = made.hierarchy.fine
    title = f"{made.name}: " if several else "Drawing: "
    print(f"{title}{len(before.vertices)} vertices, {_counted(len(before.loops), 'loop')}")
    for k, level in enumerate(made.hierarchy.levels):
        print(f"  Level {k + 1}: {len(level.cage.vertices)} vertices, {level.report}")


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _written(kind: str, made: Sequence[Made], given: argparse.Namespace) -> str:
    """The text of an output file."""
    if kind == ".svg":
        several = len(made) > 1
        meshes: dict[str, Mesh] = {}
        for number, each in enumerate(made):
            prefix = f"{number}-" if several else ""
            meshes[f"{prefix}drawing"] = each.hierarchy.fine
            meshes.update({f"{prefix}cage-{k + 1}": cage for k, cage in enumerate(each.hierarchy.cages)})
        return to_svg(meshes)
    if kind == ".geojson":
        return to_geojson(
            [_feature(each, k, level) for each in made for k, level in enumerate(each.hierarchy.levels)], indent=1
        )
    outline = made[0].hierarchy.cages[-1]
    if len(made) > 1:
        raise NestedCagesError("A collision outline is made of one feature; write .geojson or .svg instead.")
    flip = made[0].height if given.flip_y else None
    return to_engine_json(outline, flip_y=flip, triangles=given.triangles, indent=1)


def _feature(made: Made, number: int, level: Level) -> Feature:
    known = {
        "level": number + 1,
        "vertices": len(level.cage.vertices),
        "excess": level.report.excess,
        "clearance": level.report.clearance,
    }
    return Feature(level.cage, {**made.properties, **known}, made.id if len(made.hierarchy.levels) == 1 else None)


class _ProgressLine:
    """Progress for people: a bar that moves on a terminal, a line per stage elsewhere."""

    def __init__(self, stream: TextIO, *, silent: bool) -> None:
        self.stream = stream
        self.silent = silent
        self.moving = stream.isatty()
        self.last = ""
        self.seen: set[str] = set()

    def of_run(self, progress: Progress) -> None:
        stage = f"level {progress.level + 1}, {progress.stage}"
        self._show(progress.fraction, progress.message if self.moving else stage)

    def of_batch(self, progress: BatchProgress) -> None:
        self._show(progress.fraction, f"{progress.finished} of {progress.total} features")

    def _show(self, fraction: float, text: str) -> None:
        if self.silent:
            return
        if self.moving:
            full = round(BAR * fraction)
            shown = f"[{'#' * full}{'.' * (BAR - full)}] {100 * fraction:3.0f} % {text}"
            self.stream.write("\r" + shown.ljust(len(self.last)))
            self.last = shown
        elif text not in self.seen:
            self.stream.write(f"{100 * fraction:3.0f} % {text}\n")
            self.seen.add(text)
        self.stream.flush()

    def end(self) -> None:
        """Leave the line."""
        if self.moving and self.last:
            self.stream.write("\n")
        self.last = ""


def _number(text: str, what: str, holds: Callable[[float], bool]) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not holds(value):
        raise argparse.ArgumentTypeError(f"{what}, not {text!r}")
    return value


def _count(text: str) -> int:
    return int(_number(text, "a whole number of at least 1 is needed", lambda value: value >= 1 and value % 1 == 0))


def _length(text: str) -> float:
    return _number(text, "a length above 0 is needed", lambda value: 0.0 < value < float("inf"))


def _share(text: str) -> float:
    return _number(text, "a number from 0 to 1 is needed", lambda value: 0.0 <= value <= 1.0)
