"""Output: cages as SVG and GeoJSON, and the report as JSON."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import invalid_file
from ..formats import Feature, measures, to_geojson, to_svg, write_files
from ..formats.decimals import turned_over
from ..formats.pictures import corresponding
from ..geometry.mesh import Mesh
from .options import STREAM
from .printing import STANDARD_OUTPUT, drop
from .sources import DOWN, Made, Source


def svg_of(source: Source) -> str:
    """The shapes and their cages in the frame of the input: the page, the pixels, or a map with north up."""
    meshes, levels = dict[str, Mesh](), list[int]()
    for number, each in enumerate(source.made):
        prefix = f"{number}-" if len(source.made) > 1 else ""
        meshes[f"{prefix}drawing"] = each.fine
        meshes |= {f"{prefix}cage-{k}": level.cage for k, level in enumerate(each.levels, 1)}
        levels += [0, *(-k if level.inside else k for k, level in enumerate(each.levels, 1))]
    return to_svg(meshes, frame=source.frame, levels=levels, y_up=source.y_up)


def geojson_of(source: Source, given: Namespace) -> str:
    """A feature for each cage. Raises NestedCagesError where a map is to be turned over."""
    height, pixels = None, source.pixels
    if given.flip_y:
        if pixels is None:
            raise invalid_file("A map has the north up; --flip-y is for drawings and pictures.")
        height, pixels = float(pixels.get("height", 0.0)), {**pixels, "y": "down" if source.y_up else "up"}
    features = [_feature(each, k, height) for each in source.made for k in range(len(each.levels))]
    return to_geojson(features, indent=1, crs=source.crs, pixels=pixels, pieces=given.pieces)


def _feature(made: Made, k: int, height: float | None) -> Feature:
    """A cage as a feature, turned over at half of a height."""
    level = made.levels[k]
    mesh = level.cage if height is None else turned_over(level.cage, height)
    properties = {
        **measures(mesh),
        **made.shape.properties,
        "level": -k - 1 if level.inside else k + 1,
        "vertices": len(mesh.vertices),
        "excess": level.report.excess,
        "clearance": level.report.clearance,
    }
    return Feature(mesh, properties, made.shape.id if len(made.levels) == 1 else None)


def frames_of(sources: Sequence[Source], given: Namespace) -> Source:
    """Several pictures as one, with frames at the times 0, 1, …, with corresponding vertices in their cages.

    Raises NestedCagesError where a picture lacks cages, or the pictures are to be turned over and differ in size.
    """
    counts = [len(source.made[0].levels) if source.made else 0 for source in sources]
    missing = [Path(source.path).name for source, n in zip(sources, counts, strict=True) if n < (max(counts) or 1)]
    if missing:
        raise invalid_file(f"not written, since {', '.join(missing)} lacks cages.")
    differ = any(source.pixels != sources[0].pixels for source in sources)
    if differ and given.flip_y:
        raise invalid_file("the pictures differ in size, so their frames cannot be turned over together.")
    made = [source.made[0] for source in sources]
    rows = [corresponding([each.levels[k].cage for each in made]) for k in range(max(counts))]
    frames = []
    for time, (each, cages) in enumerate(zip(made, zip(*rows, strict=True), strict=True)):
        levels = [replace(level, cage=cage) for level, cage in zip(each.levels, cages, strict=True)]
        frames.append(Made(each.shape._replace(properties={"time": time}), each.fine, levels))
    return sources[0]._replace(made=frames, pixels=DOWN if differ else sources[0].pixels)


def put(texts: Mapping[str, str]) -> None:
    """Write files as one unit; after them the standard output."""
    write_files({path: text for path, text in texts.items() if path != STREAM})
    if STREAM not in texts:
        return
    if sys.stdout is None or sys.stdout.closed:
        raise invalid_file("The standard output is closed; name a file.")
    try:
        sys.stdout.buffer.write(texts[STREAM].encode("utf-8"))
        sys.stdout.buffer.flush()
    except OSError as error:
        drop(sys.stdout)
        raise OSError(error.errno, error.strerror or str(error), STANDARD_OUTPUT) from error


def certificates(source: Source) -> str:
    """What was made of a file, and what was written."""
    lines = []
    for each in source.made:
        lines.append(f"{each.shape.name}: {len(each.fine.vertices)} vertices, loops: {len(each.fine.loops)}")
        cages = ((k, len(level.cage.vertices), level.report) for k, level in enumerate(each.levels, 1))
        lines += [f"  Level {k}: {number} vertices, {report}" for k, number, report in cages]
    return "\n".join([*lines, *(f"Wrote {file}" for file in source.written if file != STREAM)])


def report(sources: Sequence[Source]) -> str:
    """What was read, made and written of each file, with all measures, as JSON."""
    inputs = []
    for source in sources:
        about = {"file": source.path, "kind": source.kind, "notes": source.notes, "errors": source.failures}
        shapes = [
            {
                "name": each.shape.name,
                "id": each.shape.id,
                "vertices": len(each.fine.vertices),
                "loops": len(each.fine.loops),
                "levels": [
                    {"vertices": len(level.vertices), **vars(level.report), "lost": level.report.lost._asdict()}
                    for level in each.levels
                ],
            }
            for each in source.made
        ]
        inputs.append({**about, "shapes": shapes, "written": source.written})
    document = {"format": "nested-cages report", "version": 2, "inputs": inputs}
    return json.dumps(document, indent=1, default=lambda value: value.item())
