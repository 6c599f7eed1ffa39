"""From the files that come in to those that go out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from ..batch import nested_cages_many
from ..errors import NestedCagesError
from ..exchange import (
    Feature,
    Record,
    from_engine_json,
    is_engine_json,
    read_svg,
    records_from_geojson,
    to_engine_json,
    to_geojson,
    to_svg,
)
from ..exchange.pictures import picture_cages, read_png
from ..geometry.mesh import Mesh
from ..hierarchy import Hierarchy, Level, Settings, nested_cages
from .options import INPUTS, OUTPUTS, parser
from .progress import ProgressLine

DONE, FAILED, INTERRUPTED = 0, 1, 130
"""Exit statuses; the last is that of a program ended by Ctrl-C. Wrong use ends with 2, by argparse."""


@dataclass(frozen=True, eq=False)
class Made:
    """The cages of one drawing, or of one feature of a map."""

    name: str
    hierarchy: Hierarchy
    properties: Mapping[str, Any] = field(default_factory=dict)
    id: str | int | None = None
    height: float = 0.0
    """Of a picture, in pixels: what its y is turned over in."""


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
    line = ProgressLine(sys.stderr, silent=given.quiet)
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


def _make(given: argparse.Namespace, line: ProgressLine) -> tuple[list[Made], list[str]]:
    """The cages, and a sentence for each feature that has none."""
    settings = Settings(clearance=given.clearance)
    kind = given.input.suffix.lower()
    if kind == ".png":
        picture = read_png(given.input)
        if picture[:, :, 3].min() > 0:
            print("note: no pixel is fully transparent, so the whole picture may count as opaque", file=sys.stderr)
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
    return _make_map(given, settings, line)


def _make_map(given: argparse.Namespace, settings: Settings, line: ProgressLine) -> tuple[list[Made], list[str]]:
    """The same for each feature of a map; a collision outline counts as one."""
    text = given.input.read_bytes()
    if is_engine_json(text):
        drawing = from_engine_json(text)
        return [Made("drawing", nested_cages(drawing, given.levels, settings, progress=line.of_run))], []
    records = records_from_geojson(text)
    if not records:
        raise NestedCagesError(f"{given.input.name} has no polygons; give a map with Polygon or MultiPolygon features.")
    if len(records) > 1 and any(path.suffix.lower() == ".json" for path in given.output):
        raise NestedCagesError(
            f"A collision outline is made of one feature, but {given.input.name} has {len(records)}; write .geojson or "
            ".svg instead."
        )
    meshes: dict[int, Mesh] = {}
    failures = []
    for k, record in enumerate(records):
        try:
            meshes[k] = record.mesh()
        except NestedCagesError as error:
            failures.append(f"{record.name}: {error}")
    if len(records) == 1 and meshes:
        return [_of_record(records[0], nested_cages(meshes[0], given.levels, settings, progress=line.of_run))], []
    outcomes = nested_cages_many(
        meshes,
        {k: _no_more_than(given.levels, mesh) for k, mesh in meshes.items()},
        settings,
        executor=(lambda: ProcessPoolExecutor(given.jobs)) if given.jobs > 1 else None,
        progress=line.of_batch,
    )
    made = []
    for k, outcome in zip(meshes, outcomes, strict=True):
        if outcome.error is None:
            made.append(_of_record(records[k], outcome.result))
        else:
            failures.append(f"{records[k].name}: {outcome.error}")
    return made, failures


def _no_more_than(levels: Sequence[int], mesh: Mesh) -> list[int]:
    """The levels, none with more vertices than the mesh: features are of many sizes."""
    return [min(level, len(mesh.vertices)) for level in levels]


def _of_record(record: Record, hierarchy: Hierarchy) -> Made:
    return Made(record.name, hierarchy, record.properties, record.id)


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
