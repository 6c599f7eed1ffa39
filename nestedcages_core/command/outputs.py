"""Output: cages as SVG, GeoJSON and collision outlines, and the report as JSON."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import invalid_file
from ..formats import Feature, frames_to_engine_json, to_engine_json, to_geojson, to_svg, write_files
from ..formats.pictures import corresponding
from ..geometry.mesh import Mesh
from ..levels import Level
from .making import Made, Result
from .options import STEM, STREAM, WRITTEN
from .sources import Source

REPORT_FORMAT, REPORT_VERSION = "nested-cages report", 1
"""Identifies the reports."""


def targets(paths: Sequence[str], source: Source) -> dict[str, str]:
    """The files to write for a source, with their formats: by extension; SVG of a drawing on the standard output.

    Raises NestedCagesError for a format that the source cannot be written in.
    """
    stem = "stdin" if source.path == STREAM else Path(source.path).stem
    own = {"drawing": "svg", "outline": "json"}.get(source.kind, "geojson")
    named = {path.replace(STEM, stem): own if path == STREAM else WRITTEN[Path(path).suffix.lower()] for path in paths}
    several = len(source.shapes) + len(source.failures)
    if "json" in named.values() and several > 1:
        raise invalid_file(
            f"A collision outline is made of one feature, but {Path(source.path).name} has {several}; write "
            ".geojson or .svg instead."
        )
    return named


def text_of(result: Result, kind: str, *, flip_y: bool, pieces: int | None) -> str:
    """The text of an output."""
    if kind == "svg":
        return _svg(result)
    if kind == "geojson":
        features = [_feature(each, k, level) for each in result.made for k, level in enumerate(each.levels, 1)]
        return to_geojson(features, indent=1, crs=result.source.crs)
    flip = result.source.height if flip_y else None
    return to_engine_json(result.made[0].levels[-1], flip_y=flip, pieces=pieces, indent=1)


def frames_of(results: Sequence[Result], *, flip_y: bool) -> str:
    """The last cages of several pictures as frames of an animation, with corresponding vertices in the same order.

    Raises NestedCagesError where a picture has no cage, or the pictures are to be flipped and differ in height.
    """
    missing = [Path(result.source.path).name for result in results if not result.made]
    if missing:
        raise invalid_file(f"not written, since {', '.join(missing)} has no outline.")
    heights = {result.source.height for result in results}
    if flip_y and len(heights) > 1:
        raise invalid_file("the pictures differ in height, so their frames cannot be flipped together.")
    outlines = corresponding([result.made[0].levels[-1].cage for result in results])
    return frames_to_engine_json(outlines, flip_y=heights.pop() if flip_y else None, indent=1)


def put(texts: Mapping[str, str]) -> None:
    """Write files as one unit; after them the standard output."""
    write_files({path: text for path, text in texts.items() if path != STREAM})
    if STREAM not in texts:
        return
    if sys.stdout is None or sys.stdout.closed:
        raise invalid_file("The standard output is closed; name a file.")
    sys.stdout.buffer.write(texts[STREAM].encode("utf-8"))
    sys.stdout.buffer.flush()


def report(entries: Sequence[Mapping[str, Any]]) -> str:
    """The report on all files as JSON."""
    return json.dumps({"format": REPORT_FORMAT, "version": REPORT_VERSION, "inputs": list(entries)}, indent=1)


def entry(result: Result, written: Sequence[str], errors: Sequence[str]) -> dict[str, Any]:
    """The report's entry for a file."""
    source = result.source
    return {
        "file": source.path,
        "kind": source.kind,
        "notes": list(source.notes),
        "errors": list(errors),
        "shapes": [
            {
                "name": each.shape.name,
                "id": each.shape.id,
                "vertices": len(each.fine.vertices),
                "loops": len(each.fine.loops),
                "levels": [_measures(level) for level in each.levels],
            }
            for each in result.made
        ],
        "written": list(written),
    }


def table(entries: Sequence[Mapping[str, Any]]) -> str:
    """One line per file of the report: shapes, vertices, those of the levels, excess at most, seconds, failures."""
    rows = [("file", "shapes", "vertices", "cages", "excess", "seconds", "")]
    for said in entries:
        shapes, failed = said["shapes"], len(said["errors"])
        count = max((len(shape["levels"]) for shape in shapes), default=0)
        levels = [[shape["levels"][k] for shape in shapes if k < len(shape["levels"])] for k in range(count)]
        rows.append(
            (
                said["file"],
                str(len(shapes)),
                str(sum(shape["vertices"] for shape in shapes)),
                ", ".join(str(sum(cage["vertices"] for cage in level)) for level in levels),
                ", ".join(f"{100.0 * max(cage['excess'] for cage in level):.3g} %" for level in levels),
                f"{sum(cage['seconds'] for level in levels for cage in level):.1f}",
                f"{failed} failed" if failed else "",
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(lines)


def _measures(level: Level) -> dict[str, Any]:
    said = level.report
    return {
        "vertices": len(level.cage.vertices),
        **{name: bool(getattr(said, name)) for name in ("strict", "simple")},
        **{name: float(getattr(said, name)) for name in ("clearance", "wanted_clearance", "excess")},
        "grid": said.grid,
        "start": said.start,
        "iterations": dict(said.iterations),
        "seconds": sum(said.seconds.values()),
        "filled": list(said.lost.filled),
        "joined": [list(loops) for loops in said.lost.joined],
        "notes": list(said.notes),
    }


def _svg(result: Result) -> str:
    """The shapes and their cages in the frame of the input: the page, the pixels, or a map with north up."""
    meshes: dict[str, Mesh] = {}
    levels: list[int] = []
    for number, each in enumerate(result.made):
        prefix = f"{number}-" if len(result.made) > 1 else ""
        meshes[f"{prefix}drawing"] = each.fine
        meshes.update({f"{prefix}cage-{k}": level.cage for k, level in enumerate(each.levels, 1)})
        levels += range(1 + len(each.levels))
    return to_svg(meshes, frame=result.source.frame, levels=levels, y_up=result.source.kind == "map")


def _feature(made: Made, number: int, level: Level) -> Feature:
    said = {"excess": level.report.excess, "clearance": level.report.clearance}
    properties = {**made.shape.properties, "level": number, "vertices": len(level.cage.vertices), **said}
    return Feature(level.cage, properties, made.shape.id if len(made.levels) == 1 else None)
