"""SVG that is written: parsed as XML, each property of it, exact coordinates, and pages as those of the source."""

import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from tinycss2.color3 import parse_color

from nestedcages_core import Mesh, from_svg, nested_cages, read_svg_drawing, svg_drawing, to_svg, verify
from support.documents import refusal, same, svg
from support.shapes import islands, letter_a, ring, star

NAMESPACE = "{http://www.w3.org/2000/svg}"
SHAPES = {"letter": letter_a(1), "islands": islands(), "star": star(5, 40)}
SQUARE = Mesh.from_loops([[(0, 0), (4, 0), (4, 3), (0, 3)]])


def paths(text: str) -> list[ET.Element]:
    return list(ET.fromstring(text).iter(f"{NAMESPACE}path"))


def rings_of(data: str) -> list[list[tuple[float, float]]]:
    """The loops of a path of straight lines with absolute coordinates, by a reader of a few lines."""
    assert not set(re.sub(r"[eE]", "", data)) - set("MLZ0123456789.,- +\n")
    loops = [re.findall(r"[-+\d.eE]+", part) for part in data.split("M")[1:]]
    return [list(zip(map(float, loop[::2]), map(float, loop[1::2]), strict=True)) for loop in loops]


@pytest.mark.parametrize("name", SHAPES)
def test_paths_have_the_very_coordinates(name: str) -> None:
    mesh = Mesh(SHAPES[name].vertices * math.pi, SHAPES[name].edges)
    (path,) = paths(to_svg(mesh))
    assert same(Mesh.from_loops([np.array(loop) for loop in rings_of(path.attrib["d"])]), mesh)
    assert path.attrib["d"].upper().count("Z") == len(mesh.loops)
    assert path.attrib["fill-rule"] == "evenodd"


def test_cages_hold_after_writing_and_reading() -> None:
    fine = letter_a(2)
    hierarchy = nested_cages(fine, [60, 30])
    text = to_svg({"drawing": fine, "inner": hierarchy.cages[0], "outer": hierarchy.cages[1]})
    read = {name: from_svg(text, element=name) for name in ("drawing", "inner", "outer")}
    assert [same(read["drawing"], fine), *map(same, (read["inner"], read["outer"]), hierarchy.cages)] == [True] * 3
    assert verify(read["inner"], read["drawing"]) and verify(read["outer"], read["inner"])
    assert same(from_svg(text), hierarchy.cages[1])  # all painted together
    apart = svg_drawing(text, each=None)
    assert [name for name, _ in apart.shapes] == ["outer", "inner", "drawing"]
    assert all(same(mesh, read[name]) for name, mesh in apart.shapes)
    for shapes, ids in (
        (hierarchy, ["cage-2", "cage-1", "shape"]),
        (hierarchy[0], ["cage-1", "shape"]),
        ([fine, hierarchy.cages[0]], ["cage-1", "shape"]),
        (fine.vertices[fine.loops[0]], ["shape"]),
    ):
        assert [path.attrib["id"] for path in paths(to_svg(shapes))] == ids


def test_levels_are_styled_apart_and_cages_lie_below() -> None:
    meshes = {name: Mesh.from_loops([ring(8, r)]) for name, r in (("a", 1.0), ("a-1", 2.0), ("b", 1.5), ("b-1", 3.0))}
    written = {path.attrib["id"]: path.attrib for path in paths(to_svg(meshes, levels=[0, 1, 0, 1]))}
    assert [*written] in (["a-1", "b-1", "a", "b"], ["b-1", "a-1", "b", "a"])
    assert {name: path["class"] for name, path in written.items()} == {
        "a": "level-0", "b": "level-0", "a-1": "level-1", "b-1": "level-1",
    }  # fmt: skip
    assert written["a"]["fill"] == written["b"]["fill"] != written["a-1"]["fill"] == written["b-1"]["fill"]
    for path in written.values():
        for name in ("fill", "stroke"):
            assert parse_color(path[name]).alpha == 1.0
        assert 0.0 < float(path["fill-opacity"]) <= 1.0 and float(path["stroke-width"]) > 0.0
    inside = paths(to_svg([Mesh.of(ring(8)), Mesh.of(ring(8, 0.5))], levels=[0, -1]))
    assert [path.attrib["class"] for path in inside] == ["level-0", "inner-1"]
    for wrong, levels in ((meshes, [0, 1]), ({}, None), ([], None)):
        assert refusal(to_svg, wrong, levels=levels).code == "file.invalid"


def test_maps_are_written_with_y_pointing_up() -> None:
    text = to_svg(Mesh.from_loops([[(0, 0), (4, 0), (0, 3)]]), y_up=True)
    (path,) = paths(text)
    assert sorted(rings_of(path.attrib["d"])[0]) == [(0, 0), (0, 3), (4, 0)]  # as in the map
    assert np.ravel(from_svg(text).bounds).tolist() == [0.0, -3.0, 4.0, 0.0]
    x, y, width, height = map(float, ET.fromstring(text).attrib["viewBox"].split())
    assert x < 0 < 4 < x + width and y < -3 < 0 < y + height


def page(text: str) -> dict[str, str]:
    """What says where a document is shown."""
    found = ET.fromstring(text).attrib
    return {key: found[key] for key in ("viewBox", "width", "height", "preserveAspectRatio") if key in found}


@pytest.mark.parametrize(
    "given",
    [{"viewBox": "3 4 50 20", "width": "5cm", "height": "20mm", "preserveAspectRatio": "xMinYMin"},
     {"width": "40", "height": "30"}, {"viewBox": "0 0 20 10"}],
)  # fmt: skip
def test_output_has_the_page_of_its_source(given: dict[str, str], tmp_path: Path) -> None:
    attributes = " ".join(f'{key}="{value}"' for key, value in given.items())
    (tmp_path / "a.svg").write_text(svg('<rect x="5" y="5" width="15" height="5"/>', attributes))
    drawing = read_svg_drawing(tmp_path / "a.svg")
    text = to_svg(drawing.mesh, frame=drawing.frame)
    assert page(text) == given
    again = svg_drawing(text)
    assert again.frame == drawing.frame
    assert same(again.mesh, drawing.mesh)


def test_a_view_box_and_a_size_on_paper() -> None:
    assert page(to_svg(SQUARE, view_box=(-1, -2, 10, 20))) == {"viewBox": "-1 -2 10 20"}
    sized = page(to_svg(SQUARE, view_box=(0, 0, 10, 20), size=(0.5, "mm")))
    assert sized == {"viewBox": "0 0 10 20", "width": "5mm", "height": "10mm"}
    x, y, width, height = map(float, page(to_svg(SQUARE))["viewBox"].split())
    assert [x, y, x + width, y + height] == pytest.approx([-0.1, -0.1, 4.1, 3.1])  # all, with a margin of 2 %


def test_a_cage_beyond_the_page_is_read_back_whole() -> None:
    mesh = letter_a(1)
    drawing = svg_drawing(svg('<rect width="1" height="1"/>', 'viewBox="0 0 1 1"'))
    assert from_svg(to_svg(mesh, frame=drawing.frame)).area == mesh.area
    body = '<rect x="-30" y="-30" width="70" height="70"/><path d="M0 0h1"/>'
    cut = svg_drawing(svg(body, 'viewBox="0 0 10 10" width="20" height="10"'))
    assert from_svg(to_svg(cut.mesh, frame=cut.frame)).area == pytest.approx(200.0)


def test_names_that_xml_cannot_hold_are_mended() -> None:
    (path,) = paths(to_svg({'a\x00"<b>&': SQUARE}))
    assert path.attrib["id"] == 'a_"<b>&'
    assert from_svg(to_svg({'a\x00"<b>': SQUARE}), element='a_"<b>').area == SQUARE.area
