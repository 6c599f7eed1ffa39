"""Output: cages as SVG, GeoJSON and collision outlines, and the report as JSON."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import invalid_file
from ..formats import Coverage, Feature, frames_to_engine_json, to_engine_json, to_geojson, to_svg, write_whole
from ..formats.pictures import corresponding
from ..geometry.mesh import Mesh
from ..levels import Level
from .making import Made, Result
from .sources import STREAM, Source

WRITTEN = {".svg": "svg", ".geojson": "geojson", ".json": "json"}
"""Output formats by file extension."""

STEM = "{stem}"
"""Placeholder in an output's name: the input's name without its extension."""

REPORT_FORMAT, REPORT_VERSION = "nested-cages report", 1
"""Identifies the reports."""


def targets(paths: Sequence[str], source: Source, chosen: str | None) -> list[tuple[str, str]]:
    """The files to write for a source and their formats: by extension; for the standard output as chosen.

    Raises NestedCagesError, before any cage is made, for a format that the source cannot be written in.
    """
    stem = "stdin" if source.path == STREAM else Path(source.path).stem
    own = {"map": "geojson", "outline": "json"}.get(source.kind, "svg")
    kinds = [chosen or own if path == STREAM else WRITTEN[Path(path).suffix.lower()] for path in paths]
    several = len(source.shapes) + len(source.failures)
    if "json" in kinds and several > 1:
        raise invalid_file(
            f"A collision outline is made of one feature, but {Path(source.path).name} has {several}; write "
            ".geojson or .svg instead."
        )
    return [(path.replace(STEM, stem), kind) for path, kind in zip(paths, kinds, strict=True)]


def is_made(path: str, outputs: Sequence[str]) -> bool:
    """Whether all outputs of an input file exist and are newer than it."""
    try:
        read = os.stat(path).st_mtime_ns
        made = [os.stat(each.replace(STEM, Path(path).stem)).st_mtime_ns for each in outputs]
    except OSError:
        return False
    return bool(made) and min(made) > read


def text_of(result: Result, kind: str, *, flip_y: bool, triangles: bool, pieces: int | None) -> str:
    """The text of an output."""
    if kind == "svg":
        return _svg(result)
    if kind == "geojson":
        features = _regions(result) or [
            _feature(each, k, level) for each in result.made for k, level in enumerate(each.levels, 1)
        ]
        return to_geojson(features, indent=1, crs=result.source.crs)
    flip = result.source.height if flip_y else None
    return to_engine_json(result.made[0].levels[-1], flip_y=flip, triangles=triangles, pieces=pieces, indent=1)


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


def put(path: str, text: str) -> None:
    """Write a file whole or not at all, or the standard output."""
    if path != STREAM:
        write_whole(path, text)
        return
    if sys.stdout is None or sys.stdout.closed:
        raise invalid_file("The standard output is closed; name a file.")
    sys.stdout.buffer.write(text.encode("utf-8"))
    sys.stdout.buffer.flush()


def report(entries: Sequence[Mapping[str, Any]]) -> str:
    """The report on all files as JSON."""
    return json.dumps({"format": REPORT_FORMAT, "version": REPORT_VERSION, "inputs": list(entries)}, indent=1)


def entry(result: Result, written: Sequence[str], errors: Sequence[str], *, skipped: bool = False) -> dict[str, Any]:
    """The report's entry for a file; skipped: its outputs are newer."""
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
        "borders": [_borders(result, coverage) for coverage in result.coverages],
        "written": list(written),
        "skipped": skipped,
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
                f"{failed} failed" if failed else "skipped" if said["skipped"] else "",
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


def _borders(result: Result, coverage: Coverage) -> dict[str, Any]:
    read = [each.content.vertices for each in result.source.shapes if isinstance(each.content, Mesh)]
    points = len(np.unique(np.concatenate(read), axis=0))
    return {"points_read": points, "points": coverage.points, "width": coverage.width}


def _svg(result: Result) -> str:
    """The shapes and their cages in the frame of the input: the page, the pixels, or a map with north up."""
    meshes: dict[str, Mesh] = {}
    levels: list[int] = []
    regions = [coverage.regions for coverage in result.coverages]
    if regions:
        drawn = [[each.content for each in result.source.shapes], *regions]
        levels = [level for level, shown in enumerate(drawn) for _ in shown]
        named = {f"{k}-cage-{level}" if level else f"{k}-drawing": mesh
                 for level, shown in enumerate(drawn) for k, mesh in enumerate(shown)}  # fmt: skip
        return to_svg(named, frame=result.source.frame, levels=levels, y_up=True)
    for number, each in enumerate(result.made):
        prefix = f"{number}-" if len(result.made) > 1 else ""
        meshes[f"{prefix}drawing"] = each.fine
        meshes.update({f"{prefix}cage-{k}": level.cage for k, level in enumerate(each.levels, 1)})
        levels += range(1 + len(each.levels))
    return to_svg(meshes, frame=result.source.frame, levels=levels, y_up=result.source.kind == "map")


def _regions(result: Result) -> list[Feature]:
    """The regions of all levels, each with the properties that it had."""
    return [
        Feature(
            mesh,
            {**shape.properties, "level": k, "vertices": len(mesh.vertices)},
            shape.id if len(result.coverages) == 1 else None,
        )
        for k, coverage in enumerate(result.coverages, 1)
        for shape, mesh in zip(result.source.shapes, coverage.regions, strict=True)
    ]


def _feature(made: Made, number: int, level: Level) -> Feature:
    said = {"excess": level.report.excess, "clearance": level.report.clearance}
    properties = {**made.shape.properties, "level": number, "vertices": len(level.cage.vertices), **said}
    return Feature(level.cage, properties, made.shape.id if len(made.levels) == 1 else None)
