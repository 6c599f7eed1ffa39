"""The options of the command: what they accept, which of them go together, and the help."""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from sys import modules
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import NestedCagesError

if TYPE_CHECKING:  # what values of options are read by is imported when there are some: the help is quick without
    from ..constraints.axis_aligned import AxisAligned
    from ..constraints.box import Box
    from ..geometry.symmetry import DetectSymmetry, Mirror, Rotation

STREAM = "-"
"""Stands for the standard input or output."""

STEM = "{stem}"
"""Placeholder in an output's name: the input's name without its extension."""

KINDS = {".svg": "drawing", ".png": "picture",
         **dict.fromkeys((".geojson", ".json", ".shp", ".gpkg", ".topojson"), "map")}  # fmt: skip
"""The content of an input file by its extension."""

WRITTEN = {".svg": "svg", ".geojson": "geojson", ".json": "geojson"}
"""Output formats by extension."""

GEOJSON = (".geojson", ".json", STREAM)
"""Ends of the names of outputs that are GeoJSON, or may be."""

METRES = {"m": 1.0, "km": 1000.0, "mi": 1609.344}
"""Units of lengths on the ground."""

AXES = {"x": (0.0, 1.0), "y": (1.0, 0.0)}
"""Directions of the mirrors that turn over a coordinate."""

HELP_WIDTH = 79
"""Columns of the help: no wider than the narrowest usual terminal."""

USAGE = "nested-cages FILE [FILE ...] --levels N [N ...] [-o FILE] [options]"

DESCRIPTION = """\
Wraps drawings, maps and sprites in nested cages: coarse outlines that strictly
enclose them, never cross themselves, and have an area at a local minimum. Each
one is certified by exact predicates before it is written."""

MORE = """\
more: --help shape, drawings, maps, pictures, outlines, files (formats, limits,
exit status, examples) or all
nested-cages check DRAWING RESULT checks what was written
nested-cages puppet PAINTING -o SCENE makes a game puppet of a layered painting
"""

FILES = """\
input files, several of them or patterns such as "icons/*.svg"; - reads the standard input:
  .svg            what is painted; curves become chords within --tolerance, overlapping shapes are united
  .geojson .json  polygons; every feature gets its own cages, which hold all its rings exactly. Polygons that touch
                  or cross are united, and each change is named
  .shp .gpkg .topojson  as maps, through pyogrio
  .png            opaque pixels, in pixels with y downwards

output files (by extension, all lengths and places in the units of the input):
  .svg            the drawing and its cages, as paths with the ids "drawing", "cage-1", "cage-2", ...; a picture's lie
                  on its pixels, a map has the north up
  .geojson .json  one feature per cage, with its level, vertices, excess, clearance, area and centroid; coordinates of
                  pictures are pixels, which a member "pixels" says
  -               the standard output: SVG of a drawing, GeoJSON of a map or a picture
  The files of an input are written together, whole or not at all. For several input files name outputs with {stem},
  such as cages/{stem}.svg; a .geojson without it takes the cages of several pictures as the frames of one animation,
  each with its "time"

exit status:
  0  all cages were made, certified and written
  1  a cage could not be made or a file not be read or written; the message says why. What worked is written
  2  wrong use of the options
  130  interrupted

examples:
  nested-cages logo.svg --levels 64 24 -o cages.svg
  nested-cages "icons/*.svg" --levels 20% 8% -o "cages/{stem}.svg" --report report.json
  nested-cages sprite.png --levels 16 --clearance 2 -o outline.geojson --flip-y
  nested-cages regions.geojson --levels 200 50 --clearance 5km --jobs 4 -o simple.geojson
  curl ... | nested-cages - --levels 50% -o - > simple.geojson
"""

Value = TypeVar("Value")


class Metres(float):
    """A length on the ground, in metres."""


def kind_of(path: str) -> str | None:
    """The content of a file by its name; None if it cannot be read. For a stream it is guessed later."""
    return "stream" if path == STREAM else KINDS.get(Path(path).suffix.lower())


def _number(what: str, holds: Callable[[float], bool], kind: type = float) -> Callable[[str], Any]:
    """A reader of numbers that hold; what: these in words."""

    def read(text: str) -> Any:
        try:
            value = float(text)
        except ValueError:
            value = nan
        if not holds(value):
            raise argparse.ArgumentTypeError(f"{what} is needed, not {text!r}")
        return kind(value)

    return read


def at_least(least: int) -> Callable[[str], Any]:
    return _number(f"a whole number of at least {least}", lambda value: value >= least and value % 1 == 0, int)


length = _number("a length above 0", lambda value: 0.0 < value < inf)


def clearance(text: str) -> float:
    """A length in units of the input, or in metres."""
    unit = text.lstrip("0123456789.eE+-").strip()
    return Metres(length(text.removesuffix(unit)) * METRES[unit]) if unit in METRES else float(length(text))


def symmetry(text: str) -> Mirror | Rotation | DetectSymmetry:
    from ..geometry.symmetry import DetectSymmetry, Mirror, Rotation

    if text == "found":
        return DetectSymmetry()
    order = _number("x, y, found or a whole number of at least 2", lambda value: value >= 2 and value % 1 == 0, int)
    return Mirror(None, AXES[text]) if text in AXES else Rotation(None, order(text))


def directions(text: str) -> AxisAligned:
    from ..constraints.axis_aligned import TRANSIT, AxisAligned

    words = {"axes": AxisAligned(), "transit": AxisAligned(TRANSIT)}
    return words[text] if text in words else _made(AxisAligned, text, "axes, transit or angles such as 0,60,120")


def box(text: str) -> Box:
    from ..constraints.box import Box

    def between(corners: tuple[float, ...]) -> Box:
        x, y, u, v = corners
        return Box((min(x, u), min(y, v)), (max(x, u), max(y, v)))

    return _made(between, text, "two corners such as 0,0,640,480")


def _made(maker: Callable[[tuple[float, ...]], Value], text: str, what: str) -> Value:
    """What a maker makes of numbers between commas; what: these in words."""
    try:
        return maker(tuple(float(word) for word in text.split(",")))
    except (TypeError, ValueError, NestedCagesError):
        raise argparse.ArgumentTypeError(f"{what} are needed, not {text!r}") from None


def _limit(text: str) -> tuple[str, int]:
    from ..formats import Limits

    name, _, number = text.partition("=")
    if name not in vars(Limits()):
        known = ", ".join(vars(Limits()))
        raise argparse.ArgumentTypeError(f"{known} can be limited, as in pixels=1000000, not {text!r}")
    return name, int(at_least(1)(number))


def _option(*names: str, metavar: str | None = None, **how: Any) -> tuple[tuple[str, ...], dict[str, Any]]:
    """An option with a value of this name, or one that is on or off."""
    return names, {**how, "metavar": metavar} if metavar else {"action": "store_true", **how}


MAIN = "options"

OPTIONS = {
    MAIN: (
        _option("--levels", nargs="+", metavar="N", required=True, help="what each cage has, innermost "
                "first: a number of vertices, 32; a share of the shape's vertices, 8%%; or the fewest within a "
                "distance, 2px, or an excess of area, +25%%"),
        _option("-o", "--output", action="append", default=[], metavar="FILE", help=".svg or .geojson to write, "
                "or - for the standard output; may be repeated"),
        _option("--clearance", type=clearance, metavar="LENGTH", help="smallest distance of a cage from what it "
                "encloses, in units of the input; of a map also in m, km or mi, as in 5km"),
        _option("--inside", help="make cages inside the shapes instead"),
        _option("--loops", action="store", choices=("auto", "keep", "one"), default="auto", help="auto: holes are "
                "filled and parts share a loop where that is tighter; keep: every loop has its own; one: a silhouette"),
        _option("--seconds", type=_number("a time above 0", lambda value: 0.0 < value < inf), metavar="S",
                help="time for each shape; the levels made by then are kept"),
        _option("--report", metavar="FILE", help="write all measures and messages as JSON"),
        _option("--quiet", help="no progress"),
    ),
    "shape": (
        _option("--convex", help="convex cages: this many vertices around each part, holes filled"),
        _option("--symmetry", type=symmetry, metavar="WHAT", help="x (left and right alike), y (top and bottom alike), "
                "both about the middle of the drawing, a number (rotations of that order about its centroid), or found "
                "(the drawing's own)"),
        _option("--min-edge", type=length, metavar="LENGTH", help="no cage edge is shorter, where there is room"),
        _option("--min-angle", type=_number("an angle above 0 and below 60 degrees", lambda value: 0.0 < value < 60.0),
                metavar="DEGREES", help="no angle between cage edges is sharper than this, where there is room; below "
                "60"),
        _option("--directions", type=directions, metavar="WHAT", help="edges are along the axes (axes), also along "
                "both diagonals (transit), or at these angles in degrees, such as 0,60,120"),
        _option("--box", type=box, metavar="X,Y,X,Y", help="cages stay between two corners, as in --box=-8,0,8,9"),
        _option("--grid", type=length, metavar="LENGTH", help="cage vertices are multiples of this length: 1 for whole "
                "pixels, 1e-6 for six decimals"),
    ),
    "drawings": (
        _option("--tolerance", type=length, metavar="LENGTH", help="greatest distance between a curve and its chords "
                "(default: 1/2000 of the drawing's diagonal); a clearance of at least as much encloses the curves "
                "themselves"),
        _option("--element", "--only", metavar="ID", help="read only the element with this id"),
        _option("--layers", nargs="+", metavar="NAME", help="read only these layers: of a drawing by label or "
                "id, of a map file by name (default: the first with polygons)"),
        _option("--no-strokes", help="leave strokes out"),
        _option("--no-crop", help="keep what lies outside the page"),
    ),
    "maps": (
        _option("--jobs", type=at_least(1), metavar="N", help="processes for the features (default: 1)"),
    ),
    "pictures": (
        _option("--threshold", type=_number("a number from 0 to 1", lambda value: 0.0 <= value <= 1.0), metavar="ALPHA",
                help="opacity from 0 to 1 above which a pixel counts as opaque (default: 0.5)"),
    ),
    "outlines": (
        _option("--flip-y", help="turn y over; that of a picture then counts upwards from its lower edge"),
        _option("--pieces", type=at_least(3), metavar="N", help="add convex pieces of at most N vertices, which tile "
                "each cage, as features with a number as \"piece\"; Box2D takes 8"),
    ),
    "files": (
        _option("--limit", dest="limits", type=_limit, action="append", default=[], metavar="WHAT=N", help="raise or "
                "lower a limit of reading: bytes, elements, points, seconds or pixels (SECURITY.md has the defaults)"),
    ),
}  # fmt: skip
"""The options by topic of the help."""

ALSO_FOR = {"layers": {"map"}, "inside": {"drawing", "map"}}
"""Kinds of files other than those of the topic that an option is for."""

APART = (("inside", "jobs"), *(("convex", other) for other in ("inside", "min_edge", "min_angle", "directions")))
"""Options that exclude each other."""


class _Help(argparse.Action):
    """Prints the help on a topic, or that on all that most people need."""

    def __call__(self, options: argparse.ArgumentParser, _: Any, values: Any, __: str | None = None) -> None:
        topics = list(OPTIONS) if values == "all" else [values or MAIN]
        print(parser(topics, files=values in ("all", "files")).format_help())
        options.exit()


def parser(shown: Collection[str] = tuple(OPTIONS), *, files: bool = True) -> argparse.ArgumentParser:
    """The parser; shown: topics, for the help on these. files: whether the help tells of formats and exit statuses."""
    options = argparse.ArgumentParser(
        prog="nested-cages",
        usage=USAGE,
        description=DESCRIPTION if MAIN in shown else None,
        epilog=FILES if files else MORE if MAIN in shown else "",
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, width=HELP_WIDTH, max_help_position=22),
        add_help=False,
    )
    options.add_argument("input", nargs="+", metavar="FILE", help=argparse.SUPPRESS)
    for topic in shown:
        group = options.add_argument_group(topic)
        for names, how in OPTIONS[topic]:
            group.add_argument(*names, **how)
        if topic == MAIN:
            version = f"nested-cages {modules[__name__.rpartition('.command.')[0]].__version__}"
            group.add_argument("--version", action="version", version=version, help="print the version")
    topics = [*list(OPTIONS)[1:], "all"]
    options.add_argument("-h", "--help", action=_Help, nargs="?", choices=topics, help=argparse.SUPPRESS)
    return options


def of_drawings(given: argparse.Namespace) -> dict[str, Any]:
    """The options of drawings as `SvgOptions`."""
    from ..formats import DRAWING_LIMITS

    return {
        **{name: getattr(given, name) for name in ("tolerance", "element", "inside")},
        **{name: not getattr(given, f"no_{name}") for name in ("strokes", "crop")},
        "layers": tuple(given.layers or ()),
        "limits": replace(DRAWING_LIMITS, **given.limits),
    }


def check_use(options: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[str]) -> None:
    """Exit with a message if the options contradict each other or do not apply to the files; fill in defaults."""
    from ..levels import level_words, parse_level

    for path in paths:
        if kind_of(path) is None:
            options.error(f"{Path(path).name}: a file is read if it ends in {', '.join(KINDS)}")
    try:
        given.levels = [parse_level(word) for word in level_words(" ".join(given.levels))]
    except NestedCagesError as error:
        options.error(f"argument --levels: {error}")
    if not given.levels:
        options.error("argument --levels: at least one level is needed")
    kinds = {kind_of(path) for path in paths}
    named = [(topic[:-1], names[0]) for topic in ("drawings", "maps", "pictures") for names, _ in OPTIONS[topic]]
    for owner, name in [*named, ("drawing", "--inside")]:
        word = _word(name)
        if _is_given(given, word) and not kinds & {owner, "stream", *ALSO_FOR.get(word, ())}:
            options.error(f"{name} is for a {owner}, and there is none among the input")
    if isinstance(given.clearance, Metres) and not kinds & {"map", "stream"}:
        options.error("--clearance in metres is for a map, and there is none among the input; give it without a unit")
    for one, other in APART:
        if _is_given(given, one) and _is_given(given, other):
            both = f"--{one} and --{other}".replace("_", "-")
            options.error(f"{both} do not go together; give only one of them")
    if [*given.output, given.report].count(STREAM) > 1 or (STREAM in given.output and len(paths) > 1):
        options.error("the standard output takes one of the outputs and the report, and the cages of one file")
    for name in (names[0] for names, _ in OPTIONS["outlines"]):
        if _is_given(given, _word(name)) and not any(path.lower().endswith(GEOJSON) for path in given.output):
            options.error(f"{name} is for GeoJSON; write it with -o FILE.geojson")
    _check_files(options, given, paths)
    given.jobs = given.jobs or 1
    given.limits = dict(given.limits)


def _is_given(given: argparse.Namespace, word: str) -> bool:
    value = getattr(given, word)
    return value is not None and value is not False


def _word(name: str) -> str:
    """The attribute of an option."""
    return name.lstrip("-").replace("-", "_")


def _check_files(options: argparse.ArgumentParser, given: argparse.Namespace, paths: Sequence[str]) -> None:
    """Exit with a message if an output cannot be written, is written twice, or is read; links are followed."""
    stems = Counter(Path(path).stem.casefold() for path in paths)  # Windows and macOS take both cases for one file
    doubled = next((Path(path).stem for path in paths if stems[Path(path).stem.casefold()] > 1), None)
    if given.output and doubled is not None:
        options.error(f"two input files are called {doubled}; run them one by one")
    taken = {os.path.realpath(path): f"is the input {path}; write to another file" for path in paths if path != STREAM}
    for path in [*given.output, given.report]:
        if path in (None, STREAM):
            continue
        suffix = Path(path).suffix.lower()
        if path != given.report and suffix not in WRITTEN:
            options.error(f"{Path(path).name or repr(path)}: a file is written if it ends in {', '.join(WRITTEN)}")
        animation = suffix in GEOJSON and all(kind_of(each) == "picture" for each in paths)
        if path != given.report and len(paths) > 1 and STEM not in path and not animation:
            options.error(f"{path}: each of several input files needs its own; put {STEM} into the name")
        if not Path(path).parent.is_dir():
            options.error(f"{path}: there is no folder {Path(path).parent}")
        for stem in {Path(each).stem for each in paths} if STEM in path else {""}:
            place = os.path.realpath(path.replace(STEM, stem))
            if place in taken:
                options.error(f"{path} {taken[place]}")
            taken[place] = f"is written twice, as {path} too; give each its own name"
