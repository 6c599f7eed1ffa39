"""`nested-cages check`: exit 0 where everything in the files holds, 1 where something does not, and never a crash."""

import itertools
import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import nestedcages_core as core
from nestedcages_core import Feature, Mesh, from_svg, nested_cages, to_geojson, to_svg
from support.command import run
from support.documents import closed, collection, feature, png, svg
from support.marks import slow_after
from support.shapes import annulus, islands, letter_a, ring, star

CURVED = svg('<path d="M1 1 C 4 0 8 1 8 5 S 5 8 4 8 S 1 4 1 1"/><path d="M6 6h2v2h-2z"/>', 'viewBox="0 0 9 9"')


def checked(*words: object, holds: bool = True) -> str:
    """All that the check says, once it has the right status and stream."""
    done = run("check", *words)
    assert done.status == (0 if holds else 1), done
    assert bool(done.out.strip()) == holds and bool(done.err.strip()) != holds and "Traceback" not in done.err
    return str(done.out + done.err)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing with its cages as the command writes them: in.svg, out.svg and out.geojson."""
    place = tmp_path_factory.mktemp("check")
    (place / "in.svg").write_text(CURVED)
    command = ["in.svg", "--levels", 16, 8, "--grid", 0.01, "--pieces", 5, "-o", "out.svg", "-o", "out.geojson"]
    assert run(*command, "--quiet", cwd=place).status == 0
    return place


@pytest.mark.parametrize("result", ["out.svg", "out.geojson"])
def test_what_the_command_writes_holds(result: str, folder: Path) -> None:
    said = checked(folder / "in.svg", folder / result, "--levels", "50%", 16, "--grid", 0.01)
    assert "16" in said and "8" in said and len(said.splitlines()) == 3  # how many, and each level
    for options in (["--levels", "16"], ["--levels", "16 8 4"], ["--levels", "15 8"], ["--levels", "16 1%"],
                    ["--levels", "+0.1% 8"], ["--levels", "0.001u 8"], ["--grid", "0.3"], ["--clearance", "0.1"],
                    ["--distance", "0.001"], ["--symmetry", "x"], ["--inside"]):  # fmt: skip
        checked(folder / "in.svg", folder / result, *options, holds=False)
    checked(folder / "in.svg", folder / result, "--levels", "+50% 9u", "--distance", 9, "--clearance", 1e-6)
    checked(folder / "out.svg", folder / result)


def test_cages_of_other_places_and_levels_are_wrong(folder: Path, tmp_path: Path) -> None:
    fine, result = from_svg(CURVED), tmp_path / "out.svg"
    cage, inner = nested_cages(fine, [16]).cages[0], core.inner_cages(fine, [16]).cages[0]

    def judged(shapes: dict[str, Mesh], levels: list[int], *, holds: bool) -> None:
        result.write_text(to_svg(shapes, levels=levels, view_box=(0, 0, 9, 9)))
        checked(folder / "in.svg", result, holds=holds)

    judged({"D": fine, "C": cage, "I": inner}, [0, 1, -1], holds=True)
    judged({"D": fine, "C": fine.moved(fine.vertices * 0.9)}, [0, 1], holds=False)
    judged({"D": fine, "C": cage, "B": cage}, [0, 1, 1], holds=False)
    judged({"D": fine, "C": cage, "I": cage}, [0, 1, -1], holds=False)
    judged({"D": fine}, [0], holds=False)
    judged({"C": cage}, [1], holds=False)
    judged({"D": inner, "C": cage}, [0, 1], holds=False)  # another drawing
    named = {f"{owner} {what}": mesh for owner in "ab" for what, mesh in (("Fine", fine), ("Cage 1", cage))}
    result.write_text(to_svg(named, levels=[0, 1, 0, 1]))
    assert "2 shapes" in checked(result, result)


# Forgeries: one change each to what is written

ATTRIBUTES = [
    *(f'transform="{what}"' for what in ("scale(.9)", "translate(3 0)", "rotate(5)", "matrix(1 0 0 1 0 9)", "none")),
    *(f'style="{what}"' for what in (
        "display:none", "opacity:0", "transform:scale(.5)", "translate:3px 0", "fill:none", "fill:red;stroke:red",
        "visibility:hidden", "clip-path:circle(1px)", "mask:url(#m)", "filter:blur(9px)", "d:path('M0 0h1v1z')",
        "stroke-width:9", "scale:.5", "offset-path:path('M0 0h9')", "content-visibility:hidden", "rotate:9deg")),
    *(f'{name}="{value}"' for name, value in (
        ("display", "none"), ("visibility", "hidden"), ("opacity", "0"), ("opacity", "1"), ("clip-path", "url(#c)"),
        ("mask", "url(#m)"), ("filter", "url(#f)"), ("onload", "1"), ("onclick", "alert(1)"), ("pathLength", "0"),
        ("stroke-dasharray", "1 99"), ("stroke-opacity", "0"), ("vector-effect", "non-scaling-stroke"),
        ("systemLanguage", "xx"), ("requiredExtensions", "x"), ("marker-mid", "url(#m)"), ("xml:space", "preserve"),
        ("xmlns", "http://www.w3.org/1999/xhtml"), ("data-x", "1"), ("overflow", "hidden"), ("tabindex", "1"))),
]  # fmt: skip
ELEMENTS = [
    "<style>path{display:none}</style>", "<style>#cage-1{opacity:0}</style>", "<script>1</script>", "<!-- -->",
    '<path d="M0 0h9v9h-9z" fill="#fff"/>', '<use href="#cage-1" x="4"/>', '<image href="a.png" width="9" height="9"/>',
    '<rect width="9" height="9"/>', "<text>no</text>", "<foreignObject/>", '<set attributeName="d" to=""/>', "<?a b?>",
    '<animate attributeName="opacity" to="0"/>', "<title>another</title>", "<g/>", "<defs/>", "&#60;", "&amp;", "text",
    "<h:script xmlns:h='http://www.w3.org/1999/xhtml'/>", '<path d="M1 1h1v1z" class="level-1"/>', "<desc/>", " ", "\n",
]  # fmt: skip
WRAPPERS = [
    ("<g>", "</g>"), ('<g opacity="0">', "</g>"), ('<g transform="translate(50 0)">', "</g>"), ("<defs>", "</defs>"),
    ("<!--", "-->"), ("<symbol>", "</symbol>"), ('<svg viewBox="0 0 3 3">', "</svg>"), ('<a href="x">', "</a>"),
    ('<clipPath id="c">', "</clipPath>"), ('<mask id="m">', "</mask>"), ("<switch>", "</switch>"),
    ("<![CDATA[", "]]>"), ('<g display="none">', "</g>"), ('<g visibility="hidden">', "</g>"),
    ('<g clip-path="url(#c)">', "</g>"), ('<x:g xmlns:x="http://a">', "</x:g>"), ("<pattern>", "</pattern>"),
]  # fmt: skip
BEFORE = [
    "<?xml-stylesheet href='a.css'?>", '<?xml version="1.0" encoding="utf-16"?>', " ", "\n", "<!-- -->", "\ufeff",
    '<!DOCTYPE svg [<!ATTLIST path display CDATA "none">]>', "<!DOCTYPE svg [<!ENTITY a 'b'>]>",
]  # fmt: skip


def forged_pictures(picture: str) -> Iterator[str]:
    """Pictures that show something else than one, or are not known to show the same."""
    paths = re.findall(r"  <path .*?/>\n", picture, re.DOTALL)
    for path in paths:
        yield from (picture.replace(path, path.replace("<path", f"<path {each}")) for each in ATTRIBUTES)
        yield from (picture.replace(path, path.replace("/>", f">{each}</path>")) for each in ELEMENTS[:12])
        yield from (picture.replace(path, f"{start}{path}{end}") for start, end in WRAPPERS)
        yield from (picture.replace(path, changed) for changed in ("", path + path, path.replace("<path", "<x")))
        for name, value in re.findall(r'([\w-]+)="([^"]*)"', path)[1:]:  # names are not shown
            yield from (picture.replace(path, path.replace(f' {name}="{value}"', each)) for each in (
                "", f' {name}=""', f' {name}="none"', f' {name}="0"', f' {name.upper()}="{value}"'))  # fmt: skip
        data = path.partition(' d="')[2].partition('"')[0]
        number = data.split()[1]
        for changed in (
            *(data.replace(number, each, 1) for each in (f"{number}e1", f"-{number}", f"{number}0", "nan", "")),
            *(data.replace(one, new, 1) for one, new in (("L", "l"), ("L", "C"), ("Z", ""), ("L", "M"), (" ", ","))),
            f"{data} M 0 0 L 9 0 L 9 9 Z", f"{data} Z", f"M 0 0 {data}", data.rpartition(" L")[0] + " Z",
        ):  # fmt: skip
            yield picture.replace(data, changed)
    yield from (picture.replace("</svg>", f"{each}</svg>") for each in ELEMENTS)
    yield from (picture.replace("<svg", f"<svg {each}", 1) for each in (*ATTRIBUTES, 'width="9"', 'height="2%"'))
    yield from (each + picture for each in BEFORE)
    for one, other in (("level-1", "level-2"), ("#0072b2", "#009e73"), ("0.15", "0.9")):
        yield re.sub(f"{one}|{other}", lambda found, pair=(one, other): pair[found[0] == pair[0]], picture)  # type: ignore[misc]
        yield from (picture.replace(one, other), picture.replace(other, one))
    yield picture.replace(paths[0] + paths[1], paths[1] + paths[0])
    for one, other in (('viewBox="0 0 9 9"', 'viewBox="0 0 18 18"'), ('viewBox="0 0 9 9"', ""), ("decoration", ""),
                       ('"visible"', '"hidden"'), ("2000/svg", "2000/svg/"), ("evenodd", "nonzero"), ("round", "miter"),
                       ('viewBox="0 0 9 9"', 'viewBox="0 0 9 9" preserveAspectRatio="none"'), ("</svg>", ""),
                       ('viewBox="0 0 9 9"', 'width="9" height="9" viewBox="0 0 9 9"'), ("svg", "s:svg")):  # fmt: skip
        yield picture.replace(one, other)


RINGS: list[Callable[[list[Any]], object]] = [
    lambda rings: [rings[0][:-1], *rings[1:]], lambda rings: [*rings, [[20, 20], [21, 20], [21, 21], [20, 20]]],
    lambda rings: [*rings, rings[0]], lambda rings: rings * 2, lambda rings: [], lambda rings: [rings[0][:2]],
    lambda rings: rings[0], lambda rings: [[*rings[0][:-1], rings[0][1], rings[0][0]], *rings[1:]],
    lambda rings: [[[x * 0.9, y * 0.9] for x, y in rings[0]]], lambda rings: [[[*map(str, p)] for p in rings[0]]],
    lambda rings: [[[y, x] for x, y in rings[0]]], lambda rings: [[p[:1] for p in rings[0]]], lambda rings: None,
    lambda rings: [[[x + 360, y] for x, y in rings[0]]], lambda rings: [[[True, False], *rings[0][1:]]],
    lambda rings: [[[x, y] for x, y in rings[0] for _ in "ab"]], lambda rings: [[*rings[0][:2], rings[0][0]]],
    lambda rings: [[[-x, y] for x, y in rings[0]]], lambda rings: [[[1e300, 0], *rings[0][1:-1], [1e300, 0]]],
]  # fmt: skip


def forged_maps(text: str) -> Iterator[str]:
    """Maps that show something else than one, or in another place, or that programs show in different ways."""
    whole = json.loads(text)

    def changed(place: list[Any], value: Any) -> str:
        document = json.loads(text)
        node = document
        for key in place[:-1]:
            node = node[key]
        node[place[-1]] = value
        return json.dumps(document)

    for name, value in (("crs", {"type": "name", "properties": {"name": "EPSG:3857"}}), ("pixels", {"y": "left"}),
                        ("pixels", None), ("pixels", 5), ("pixels", {"y": "down", "height": 9}), ("type", "Feature"),
                        ("bbox", [0, 0, 1, 1]), ("bbox", "all"), ("geometries", []), ("features", []),
                        ("pixels", {"y": "up"}), ("transform", {"scale": [2, 2]}), ("features", {})):  # fmt: skip
        yield changed([name], value)
    yield from (changed(["features"], whole["features"] + [each]) for each in (
        whole["features"][0], None, {}, {"type": "Feature", "properties": {}, "geometry": None},
        *({"type": "Feature", "properties": {}, "geometry": {"type": kind, "coordinates": [[0, 0], [9, 9]]}}
          for kind in ("LineString", "MultiPoint", "Polygon")), whole))  # fmt: skip
    for number, each in enumerate(whole["features"]):
        place, geometry, own = ["features", number], each["geometry"], each["properties"]
        yield changed(["features"], [other for k, other in enumerate(whole["features"]) if k != number])
        yield from (changed([*place, "properties", name], value) for name, value in (
            ("level", own["level"] + 1), ("level", 0), ("level", -own["level"]), ("level", "1"), ("level", True),
            ("vertices", 5), ("piece", 7), ("piece", 1), ("fill-opacity", 0), ("stroke", "#fff"), ("time", 5),
            ("stroke-width", 99)) if own.get(name) != value and (name != "vertices" or name in own))  # fmt: skip
        yield from (changed([*place, name], value) for name, value in (
            ("type", "Polygon"), ("geometries", []), ("coordinates", []), ("bbox", [0, 0, 0, 0]), ("properties", []),
            ("style", {"display": "none"}), ("geometry", {"type": "GeometryCollection", "geometries": [geometry]}),
            ("geometry", [geometry]), ("geometry", {**geometry, "type": "LineString"}), ("geometry", None),
            ("geometry", {**geometry, "geometries": []}), ("geometry", {**geometry, "bbox": [0, 0, 0, 0]}),
            ("geometry", {**geometry, "crs": {}}), ("geometry", {**geometry, "type": "polygon"})))  # fmt: skip
        if geometry["type"] == "Polygon":
            rings = geometry["coordinates"]
            yield from (changed([*place, "geometry", "coordinates"], change(rings)) for change in RINGS)
        here = json.dumps(each)
        for name in ("type", "geometry", "properties"):  # twice
            yield json.dumps(whole).replace(here, f'{{"{name}": {json.dumps(each[name])}, {here[1:]}')
        yield json.dumps(whole).replace(here, here.replace("]]", ", NaN]]", 1))
        yield json.dumps(whole).replace(here, re.sub(r"\[\d+(\.\d+)?", "[1e999", here, count=1))


@pytest.mark.parametrize(("result", "part"), slow_after(2, itertools.product(["out.svg", "out.geojson"], range(8))))
def test_no_forgery_is_accepted(result: str, part: int, folder: Path, tmp_path: Path) -> None:
    text, path = (folder / result).read_text(), tmp_path / result
    forged = list(forged_pictures(text) if result.endswith("svg") else forged_maps(text))
    assert len(forged) > 300
    for number, each in enumerate(forged[part::8]):
        assert each != text, (number, part)
        path.write_text(each, encoding="utf-8")
        done = run("check", folder / "in.svg", path)
        assert done.status == 1 and done.err.strip() and not done.out, (number, part, each)


# What holds

SHAPES = {"letter": letter_a(), "ring": annulus(20), "islands": islands(), "star": star(5, 30)}


@pytest.mark.parametrize("levels", slow_after(1, [[24, 12], ["50%", "+40%"], ["3px", 16]]))
@pytest.mark.parametrize("name", SHAPES)
def test_no_result_is_refused(name: str, levels: list[object], tmp_path: Path) -> None:
    """Drawings and maps, as pictures and as GeoJSON, with pieces, turned over, inside, on a grid."""
    mesh = SHAPES[name]
    drawing, chart, result, other = (tmp_path / each for each in ("in.svg", "in.geojson", "out.svg", "out.geojson"))
    drawing.write_text(to_svg(mesh))
    chart.write_text(to_geojson([Feature(mesh, {"name": "<&>", "fill": "#123", "area": 5})]))
    for options in ([], ["--inside"], ["--loops", "keep"]):
        for source in (drawing, chart):
            more = [] if options else ["--pieces", 6, *(["--flip-y"] if source == drawing else [])]
            words = ["--levels", *levels, *options]
            if run(source, *words, *more, "-o", result, "-o", other, "--quiet").status == 0:
                asked = ["--levels", *levels, *options[:1], *(["--same-loops"] if "keep" in options else [])]
                asked = [word for word in asked if word != "--loops"]
                for path in (result, other):
                    checked(source, path, *asked)


def test_maps_of_any_program_are_read_as_polygons(tmp_path: Path) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    drawing.write_text(to_geojson(ONE))
    square: dict[str, Any] = {"type": "Polygon", "coordinates": [SQUARE[::-1]]}  # clockwise, as many have it
    plain = {"type": "Feature", "properties": None, "geometry": square}
    named = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    for good in (
        square, plain, {**plain, "id": 3, "bbox": [0, 0, 3, 3]}, shapely.geometry.mapping(shapely.box(0, 0, 3, 3)),
        {"type": "FeatureCollection", "name": "cages", "crs": named, "generator": "x", "features": [plain]},
        {"type": "MultiPolygon", "coordinates": [square["coordinates"], [[[9, 9], [10, 9], [9, 10], [9, 9]]]]},
        {"type": "Polygon", "coordinates": [[[*point, 7] for point in SQUARE]]},
    ):  # fmt: skip
        result.write_text(json.dumps(good))
        checked(drawing, result, "--any-loops")


def test_the_coordinates_must_be_those_of_the_drawing(folder: Path, tmp_path: Path) -> None:
    text = (folder / "out.geojson").read_text()
    metres = {"type": "name", "properties": {"name": "EPSG:3857"}}
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    for pixels, own in itertools.product((None, {"y": "down"}, {"y": "down", "width": 9, "height": 9}), repeat=2):
        drawing.write_text(to_geojson(ONE, pixels=pixels))
        result.write_text(to_geojson(AROUND, pixels=own))
        checked(drawing, result, holds=pixels == own)
    for style, own in itertools.product(({}, {"fill-opacity": 0}), repeat=2):
        drawing.write_text(to_geojson([Feature(ONE, style)]))
        result.write_text(to_geojson([Feature(AROUND, own)]))
        checked(drawing, result, holds=style == own)
    for crs, own in itertools.product((None, metres), repeat=2):
        drawing.write_text(to_geojson(ONE, crs=crs))
        result.write_text(to_geojson(AROUND, crs=own))
        checked(drawing, result, holds=crs == own)
    (tmp_path / "x.geojson").write_text(json.dumps({**json.loads(text), "pixels": {"y": "up"}}))
    checked(folder / "in.svg", tmp_path / "x.geojson", holds=False)


ONE = Mesh.from_loops([[(1, 1), (2, 1), (2, 2), (1, 2)]])
AROUND = Mesh.from_loops([[(0, 0), (3, 0), (3, 3), (0, 3)]])
SQUARE = [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]]


@pytest.mark.parametrize("spike", [1e-3, 1e-7, 1e-12])
def test_rings_are_held_as_they_were_given(spike: float, tmp_path: Path) -> None:
    """A valid part that touches another one, so that readers repair it, must not lose what sticks out of it."""
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    pier = [(0, 0), (1, 0), (1, 0.5), (3, 0.5 + spike / 2), (1, 0.5 + spike), (1, 1), (0, 1)]
    beside = [(-1, -1), (0, -1), (0, 0), (-1, 0)]
    drawing.write_text(collection(feature(*([closed(np.array(part, float))] for part in (pier, beside)))))
    for right, holds in ((3.1, True), (2.9, False)):
        result.write_text(to_geojson(Mesh.from_loops([[(-2, -2), (right, -2), (right, 2), (-2, 2)]])))
        checked(drawing, result, holds=holds)


@pytest.mark.parametrize("page", [(5, 5, 9, 9), (1.5, -4, 9, 9), None])
def test_a_page_must_show_everything(page: Any, tmp_path: Path) -> None:
    (tmp_path / "in.geojson").write_text(to_geojson(ONE))
    (tmp_path / "out.svg").write_text(to_svg([ONE, AROUND], view_box=page, y_up=True))
    checked(tmp_path / "in.geojson", tmp_path / "out.svg", holds=page is None)
    (tmp_path / "out.svg").write_text(to_svg([ONE, AROUND]))
    checked(tmp_path / "in.geojson", tmp_path / "out.svg", holds=False)  # upside down


@pytest.mark.parametrize("text", ["[", "{}", "[" * 200_000, '{"a":' * 200_000, "\x00", "null", "5"])
@pytest.mark.parametrize("name", ["out.geojson", "out.svg"])
def test_what_cannot_be_read_is_a_sentence(text: str, name: str, folder: Path, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    checked(folder / "in.svg", tmp_path / name, holds=False)
    checked(tmp_path / name, folder / "out.svg", holds=False)


@pytest.mark.slow
def test_clearances_in_metres_hold_on_the_ground(tmp_path: Path) -> None:
    drawing, result, shape = tmp_path / "in.geojson", tmp_path / "out.geojson", star(5, 12)
    drawing.write_text(to_geojson(shape.moved(0.1 * shape.vertices + (10.0, 60.0))))
    assert run(drawing, "--levels", 8, "--clearance", "5km", "-o", result, "-o", tmp_path / "out.svg").status == 0
    checked(drawing, result, "--clearance", "5km", "--levels", 8)
    checked(drawing, tmp_path / "out.svg", "--clearance", "4.9km")
    checked(drawing, result, "--clearance", "20km", holds=False)


def test_each_shape_of_a_map_has_its_own_cages(tmp_path: Path) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    shapes = [feature([closed(star(5, 40).vertices + np.array([x, 0.0]))]) for x in (0.0, 5.0)]
    drawing.write_text(collection(*shapes))
    assert run(drawing, "--levels", 16, 8, "-o", result, "-o", tmp_path / "out.svg", "--quiet").status == 0
    checked(drawing, tmp_path / "out.svg")
    assert checked(drawing, result, "--levels", 16, 8).startswith("4 ")  # two around each shape
    cages = list(core.features_from_geojson(result.read_text()))
    for order in ((0, 1), (2, 3, 0, 1), (0, 2, 1, 3)):
        result.write_text(to_geojson([cages[k] for k in order]))
        checked(drawing, result, holds=False)


@pytest.mark.slow
def test_each_cage_may_have_fewer_loops_than_the_one_before(tmp_path: Path) -> None:
    """The finest one, which keeps them all, says nothing about coarser ones."""
    drawing, result = tmp_path / "in.svg", tmp_path / "out.svg"
    places = [(2.6 * (k % 3), 2.6 * (k // 3)) for k in range(6)]
    drawing.write_text(to_svg(Mesh.from_loops([ring(24, centre=place) for place in places])))
    assert run(drawing, "--levels", 40, 8, "-o", result, "--quiet").status == 0
    checked(drawing, result)
    checked(drawing, result, "--any-loops")
    checked(drawing, result, "--same-loops", holds=False)


@pytest.mark.slow
@pytest.mark.parametrize("flip", slow_after(0, [["--flip-y"], []], thorough_after=1))
def test_pictures_and_their_frames(flip: list[str], tmp_path: Path) -> None:
    picture, other, result, frames = (tmp_path / n for n in ("in.png", "other.png", "out.geojson", "frames.geojson"))
    rows, columns = np.mgrid[:20, :24]
    picture.write_bytes(png(np.abs(np.hypot(rows - 9.5, columns - 11.5) - 6.0) < 2.0))
    other.write_bytes(png(np.abs(np.hypot(rows - 8.5, columns - 9.5) - 5.0) < 2.0))
    assert run(picture, "--levels", 10, *flip, "-o", result, "-o", tmp_path / "out.svg").status == 0
    checked(picture, result)
    checked(picture, tmp_path / "out.svg")
    checked(other, result, holds=False)
    assert run(picture, other, "--levels", 10, *flip, "-o", frames).status == 0
    checked(picture, other, frames)
    for wrong in ((other, picture, frames), (picture, other, other, frames), (picture, frames)):
        checked(*wrong, holds=False)
    if flip:
        faint = np.maximum(np.hypot(rows - 9.5, columns - 11.5) < 6.0, 0.4 * (rows > 2) * (columns < 22))
        picture.write_bytes(png(faint))
        assert run(picture, "--levels", 10, "-o", result).status == 0
        checked(picture, result)
        checked(picture, result, "--threshold", 0.1, holds=False)


@pytest.mark.slow
def test_motions_are_judged_between_their_frames(tmp_path: Path) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    fine = star(5, 40)
    poses = [fine.vertices + np.array([x, 0.0]) for x in np.linspace(0.0, 0.4, 4)]
    moving = core.animated_cages(fine, poses, [12]).levels[0]

    def judged(fines: list[Mesh], cages: list[Mesh], times: Any = range(4), *, holds: bool) -> None:
        drawing.write_text(to_geojson([Feature(mesh, {"time": k}) for k, mesh in enumerate(fines)]))
        result.write_text(to_geojson([Feature(mesh, {"time": k}) for k, mesh in zip(times, cages, strict=False)]))
        checked(drawing, result, holds=holds)

    move: Callable[..., list[Mesh]] = lambda mesh, steps: [mesh.moved(x) for x in steps]  # noqa: E731
    judged(move(fine, moving.fine_steps), move(moving.cage, moving.cage_steps), holds=True)
    judged(move(fine, moving.fine_steps), move(moving.cage, moving.cage_steps), [0, 1, 2, 5], holds=False)
    judged(move(fine, moving.fine_steps[::-1]), move(moving.cage, moving.cage_steps), holds=False)
    turned = np.stack([fine.vertices, fine.vertices * (-1.0, -1.0)])  # nested before and after, not in between
    judged(move(fine, turned), move(fine, 1.2 * turned), holds=False)
    judged(move(fine, turned[:1].repeat(2, 0)), [nested_cages(fine, [k]).cages[0] for k in (20, 22)], holds=False)


def test_checks_of_very_much_are_refused_at_once(tmp_path: Path) -> None:
    for name, shape in (("in", ONE), ("out", AROUND)):
        many = [Feature(shape.moved(shape.vertices + np.array([9.0 * k, 0.0]))) for k in range(1100)]
        (tmp_path / f"{name}.geojson").write_text(to_geojson(many if name == "out" else many[:400]))
    words = [tmp_path / "in.geojson", tmp_path / "out.geojson"]
    assert "allowed" in checked(*words, "--limit", "seconds=1", holds=False)
    assert "1100" in checked(*words, holds=False)


def test_what_is_not_there_or_wrongly_used(folder: Path) -> None:
    checked(folder / "in.svg", folder / "none.geojson", holds=False)
    (folder / "letter.svg").write_text(to_svg(letter_a()))
    checked(folder / "letter.svg", folder / "letter.svg", holds=False)
    for words in ([folder / "in.svg"], [folder / "in.svg", folder / "out.svg", "--levels", "many"],
                  [folder / "in.svg", folder / "out.svg", "--clearance", "-1"]):  # fmt: skip
        assert run("check", *words).status == 2


def test_an_animation_is_checked_where_shapely_is_missing() -> None:
    """As in a Blender alone; of a file that is not there, its name is all that is said."""
    alone = (
        "import runpy, sys; sys.modules['shapely'] = None; runpy.run_module('nestedcages_core', run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", alone, "check", "no.blend"], capture_output=True, text=True)
    assert (done.returncode, "no.blend" in done.stderr, "shapely" in done.stderr) == (1, True, False)
