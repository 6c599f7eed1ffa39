"""`nested-cages check` on files of every kind: exit 0 where all holds, 1 and a sentence where something does not."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from test_command import png, region

from nestedcages_core import (
    Feature,
    Mesh,
    animated_cages,
    features_from_geojson,
    frames_to_engine_json,
    from_svg,
    inner_cages,
    nested_cages,
    to_engine_json,
    to_geojson,
    to_svg,
)
from nestedcages_core.command import main
from support.marks import slow_after
from support.shapes import letter_a, ring, star

CURVED = '<svg viewBox="0 0 9 9"><path d="M1 1 C 4 0 8 1 8 5 S 5 8 4 8 S 1 4 1 1"/><path d="M6 6h2v2h-2z"/></svg>'


def checked(capsys: pytest.CaptureFixture, *words: object) -> tuple[int, str]:
    """Exit status, and all that is printed."""
    capsys.readouterr()
    status = main(["check", *map(str, words)])
    said = capsys.readouterr()
    assert bool(said.out) == (status == 0)
    assert bool(said.err) == (status != 0)
    return status, said.out + said.err


def test_drawings_and_outlines(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, svg, outline = tmp_path / "in.svg", tmp_path / "out.svg", tmp_path / "out.json"
    drawing.write_text(CURVED)
    assert main([str(drawing), "--levels", "16", "8", "--grid", "0.01", "-o", str(svg), "-o", str(outline)]) == 0
    said = "2 cages: everything holds.\nlevel 1: 16 vertices, 1 loop\nlevel 2: 8 vertices, 1 loop\n"
    assert checked(capsys, drawing, svg, "--decimals", "2", "--levels", "16", "50%") == (0, said)
    assert checked(capsys, svg, outline)[0] == 0
    fine = from_svg(CURVED)
    for cage, options, fault in (
        (nested_cages(fine, [16]).cages[0], ["--grid", "0.01"], "not multiples of 0.01"),
        (nested_cages(fine, [16]).cages[0], ["--clearance", "0.1"], "the distance is"),
        (nested_cages(fine, [16]).cages[0], ["--distance", "0.001"], "farther than 0.001"),
        (nested_cages(fine, [16]).cages[0], ["--symmetry", "x"], "no image"),
        (fine.moved(fine.vertices * 0.9), [], "meets the fine mesh"),
    ):
        outline.write_text(to_engine_json(cage))
        status, said = checked(capsys, drawing, outline, *options)
        assert status == 1
        assert fault in said
    both = {"D": fine, "C": nested_cages(fine, [16]).cages[0], "I": inner_cages(fine, [16]).cages[0]}
    svg.write_text(to_svg(both, levels=[0, 1, -1]))
    assert "\ninner level 1: 16 vertices" in checked(capsys, svg, svg)[1]
    named = {f"{owner} {what}": both[key] for owner in "ab" for what, key in (("Fine", "D"), ("Cage 1", "C"))}
    svg.write_text(to_svg(named, levels=[0, 1, 0, 1]))
    assert "\nlevel 1: 2 shapes, 32 vertices, 2 loops" in checked(capsys, svg, svg)[1]
    svg.write_text(to_svg({**both, "I": both["C"]}, levels=[0, 1, 1]))
    assert "has the level of another" in checked(capsys, svg, svg)[1]
    svg.write_text(to_svg({**both, "I": both["C"]}, levels=[0, 1, -1]))
    assert checked(capsys, svg, svg)[0] == 1
    svg.write_text(to_svg(both["C"], view_box=(0, 0, 9, 9)))
    assert "there is no cage" in checked(capsys, drawing, svg)[1]


CAGES = nested_cages(from_svg(CURVED), [16, 8]).cages
PICTURE = to_svg({"drawing": from_svg(CURVED), "cage-1": CAGES[0], "cage-2": CAGES[1]}, view_box=(0, 0, 9, 9))
FIRST = re.search(r' *<path id="cage-1".*?/>', PICTURE, re.DOTALL)[0]  # type: ignore[index]
BOTH = re.search(r' *<path id="cage-2".*/>', PICTURE.partition('  <path id="drawing"')[0], re.DOTALL)[0]  # type: ignore[index]
OTHER = f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9' data-outlines='decoration'>{BOTH}</svg>"


def in_place_of_first(path: str) -> str:
    return PICTURE.replace(FIRST, path)


def styled(style: str) -> str:
    return in_place_of_first(FIRST.replace("<path", f'<path style="{style}"'))


FORGED = {
    "in comments": (PICTURE.replace(BOTH, f"<!--{BOTH}-->"), "no cage"),
    "one in a comment": (in_place_of_first(f"<!--{FIRST}-->"), "no level 1"),
    "far away": (PICTURE.replace(BOTH, f'<g transform="translate(50 0)">{BOTH}</g>'), "outside of the cage"),
    "scaled": (in_place_of_first(FIRST.replace("<path", '<path transform="scale(.9)"')), "meets"),
    "scaled beyond numbers": (in_place_of_first(FIRST.replace("<path", '<path transform="scale(1e300)"')), "refused"),
    "moved by style": (styled("transform:translateX(2px)"), "meets"),
    "moved by what is not read": (styled("translate:3px 0"), "not judged: the element 'path', translate"),
    "another view box": (PICTURE.replace("0 0 9 9", "0 0 18 18"), "another view box"),
    "another page": (PICTURE.replace('viewBox', 'width="9" height="2" viewBox'), "another page"),
    "not displayed": (in_place_of_first(FIRST.replace("<path", '<path display="none"')), "no level 1"),
    "not displayed by style": (styled("display:none"), "no level 1"),
    "not displayed by a sheet": (PICTURE.replace("</svg>", "<style>#cage-1{display:none}</style></svg>"), "'style'"),
    "by a default of the document": (
        f'<!DOCTYPE svg [<!ATTLIST path display CDATA "none">]>{PICTURE}', "cages of 0"),
    "by another's sheet": ('<?xml-stylesheet href="a.css"?>' + PICTURE, "an instruction to programs"),
    "not visible": (PICTURE.replace(BOTH, f'<g visibility="hidden">{BOTH}</g>'), "no cage"),
    "not opaque": (PICTURE.replace(BOTH, f'<g opacity="0">{BOTH}</g>'), "no cage"),
    "no paint": (in_place_of_first(re.sub('(fill|stroke)="#', r'\1="none" a\1="#', FIRST)), "no level 1"),
    "as definitions": (PICTURE.replace(BOTH, f"<defs>{BOTH}</defs>"), "no cage"),
    "as a symbol": (PICTURE.replace(BOTH, f"<symbol>{BOTH}</symbol>"), "no cage"),
    "used elsewhere": (PICTURE.replace("</svg>", '<use href="#cage-1" x="40"/></svg>'), "the level of another"),
    "only used elsewhere": (
        PICTURE.replace(BOTH, f'<defs><g id="g">{BOTH}</g></defs><use href="#g" x="40"/>'), "outside of the cage"),
    "in a picture of its own": (
        PICTURE.replace(BOTH, f'<svg viewBox="0 0 3 3" width="9" height="9">{BOTH}</svg>'), "more than paths"),
    "clipped": (PICTURE.replace(BOTH, '<clipPath id="c"><path d="M0 0h1v1z"/></clipPath>'
                                f'<g clip-path="url(#c)">{BOTH}</g>'), "clip paths"),
    "clipped by a shape": (styled("clip-path:circle(1px)"), "clip path"),
    "masked": (PICTURE.replace(BOTH, f'<mask id="m"/><g mask="url(#m)">{BOTH}</g>'), "clip paths, masks"),
    "animated": (in_place_of_first(FIRST.replace("/>", '><set attributeName="d" to=""/></path>')), "'set'"),
    "scripted": (PICTURE.replace("</svg>", "<script>1</script></svg>"), "'script'"),
    "scripted by others": (
        PICTURE.replace("</svg>", "<h:script xmlns:h='http://www.w3.org/1999/xhtml'/></svg>"), "'script'"),
    "scripted by an event": (PICTURE.replace("<svg", '<svg onload="1"'), "onload"),
    "covered": (PICTURE.replace("</svg>", '<path d="M0 0h9v9h-9z" fill="#fff"/></svg>'), "its class is no level"),
    "covered by a picture": (PICTURE.replace("</svg>", '<image href="a.png" width="9" height="9"/></svg>'), "1 image"),
    "curved": (in_place_of_first(FIRST.replace("Z", "C 0 0 9 0 9 9 Z", 1)), "has curves"),
    "filled holes": (
        in_place_of_first(FIRST.replace("evenodd", "nonzero").replace(' d="', ' d="M1 1h1v1z')), "fill rule evenodd"),
    "of two levels": (in_place_of_first(FIRST.replace("level-1", "level-1 level-2")), "its class is no level"),
    "a level left out": (in_place_of_first(""), "There is a level 2, but no level 1"),
    "levels swapped": (re.sub("level-[12]", lambda k: f"level-{3 - int(k[0][-1])}", PICTURE), "level 2: "),
    "twice the same": (PICTURE.replace("</svg>", FIRST + "</svg>"), "the level of another"),
    "around another drawing": (
        re.sub('(?s)<path id="drawing".*?/>', '<path id="drawing" class="level-0" d="M0 0h8v8z"/>', PICTURE), "meets"),
    "not of a page": (PICTURE.replace('viewBox="0 0 9 9"', ""), "another view box"),
}  # fmt: skip


@pytest.mark.parametrize("forged", FORGED)
def test_what_a_viewer_does_not_show_so_is_refused(forged: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, result = tmp_path / "in.svg", tmp_path / "out.svg"
    drawing.write_text(CURVED)
    content, fault = FORGED[forged]
    result.write_text(content)
    status, said = checked(capsys, drawing, result)
    assert (status, fault if fault != "refused" else "") == (1, fault if fault in said else "")


@pytest.mark.parametrize(
    "picture",
    slow_after(
        2,
        [
            OTHER,
            PICTURE.replace(BOTH, f'<g transform="scale(2)"><g transform="scale(.5)">{BOTH}</g></g>'),
            PICTURE.replace(BOTH, f'<defs><g id="g">{BOTH}</g></defs><use href="#g"/>'),
            styled("stroke:red;-inkscape-stroke:none"),
        ],
    ),
)
def test_what_a_viewer_shows_holds(picture: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, result = tmp_path / "in.svg", tmp_path / "out.svg"
    drawing.write_text(CURVED)
    result.write_text(picture)
    assert checked(capsys, drawing, result, "--levels", "16 8")[0] == 0
    for levels, fault in (
        ("16", "2 levels, not 1"),
        ("16 8 4", "2 levels, not 3"),
        ("15 8", "level 1 has 16 vertices, not 15"),
        ("16 1%", "level 2 has 8"),
        ("+0.1% 8", "level 1 has an excess of"),
        ("0.001u 8", "level 1: the cage is farther"),
    ):
        assert fault in checked(capsys, drawing, result, "--levels", levels)[1]
    assert checked(capsys, drawing, result, "--levels", "+50% 9u")[0] == 0


ONE = Mesh.from_loops([[(1, 1), (2, 1), (2, 2), (1, 2)]])
AROUND = Mesh.from_loops([[(0, 0), (3, 0), (3, 3), (0, 3)]])


def features(*levels: object, ring: object = None) -> str:
    """A map of cages around `ONE` with some levels, each wider than the one before."""
    found = [Feature(AROUND.moved(AROUND.vertices * (1 + k) - k), {"level": x}) for k, x in enumerate(levels)]
    document = json.loads(to_geojson(found))
    if ring is not None:
        document["features"][0]["geometry"]["coordinates"] = ring
    return json.dumps(document)


SQUARE = [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]]
OUTLINE = json.loads(to_engine_json(AROUND, triangles=True, pieces=4))


def outline(**changed: object) -> str:
    return json.dumps({**OUTLINE, **changed})


@pytest.mark.parametrize(
    ("ending", "content", "fault"),
    [
        ("geojson", features(1, 2, 2), "the level of another"),
        ("geojson", features(2, 1), "no level 1"),
        ("geojson", features(1, 3), "no level 2"),
        ("geojson", features(1, True), "not a whole number"),
        ("geojson", features(1, "2"), "not a whole number"),
        ("geojson", features(0, 1), "not a whole number"),
        ("geojson", features(1, ring=[[*SQUARE[:4], [1.5, 1.5]]]), "meets"),
        ("geojson", features(1, ring=[SQUARE, [[4, 4], [5, 4], [5, 5], [4, 4]]]), "cannot be read"),
        ("geojson", features(1, ring=[SQUARE, SQUARE]), "cannot be read"),
        ("geojson", features(1).replace("Polygon", "LineString"), "cannot be read"),
        ("geojson", "[" * 200_000, "cannot be read"),
        ("geojson", '{"a":' * 200_000, "cannot be read"),
        ("json", "[" * 200_000, "cannot be read"),
        ("json", '{"format": "nested-cages outline", "polygons":' + "[" * 200_000, "cannot be read"),
        ("svg", f"<svg xmlns='http://www.w3.org/2000/svg'>{'<g>' * 50_000}{'</g>' * 50_000}</svg>", "cannot be read"),
        ("json", outline(triangles=OUTLINE["triangles"][:1]), "triangles of the collision outline do not fill"),
        ("json", outline(triangles=OUTLINE["triangles"] * 2), "do not fill"),
        ("json", outline(triangles=[t[::-1] for t in OUTLINE["triangles"]]), "do not fill"),
        ("json", outline(pieces=[[0, 1, 9]]), "do not fill"),
        ("json", outline(pieces=[]), "do not fill"),
        ("json", outline(points=[[9, 9], *OUTLINE["points"][1:]]), "do not fill"),
        ("json", outline(version=2), "version"),
        ("json", outline(format="nested-cages frames", frames=[]), "list of frames"),
        ("json", outline(format="nested-cages frames", frames=[{"polygons": OUTLINE["polygons"]}]), "only one"),
    ],
)  # fmt: skip
def test_forged_maps_and_outlines_are_refused(
    ending: str, content: str, fault: str, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / f"out.{ending}"
    drawing.write_text(to_geojson(ONE))
    for good, kind in ((features(1, 2), "geojson"), (outline(), "json"), (to_svg([ONE, AROUND], y_up=True), "svg")):
        (tmp_path / f"good.{kind}").write_text(good)
        assert kind != ending or checked(capsys, drawing, tmp_path / f"good.{kind}")[0] == 0
    result.write_text(content)
    status, said = checked(capsys, drawing, result)
    assert status == 1
    assert fault in said


def test_a_picture_shows_all_of_a_drawing_without_a_page(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.svg"
    drawing.write_text(to_geojson(ONE))
    for box, holds in (((-1, -4, 9, 9), True), ((5, 5, 9, 9), False), ((1.5, -4, 9, 9), False)):
        result.write_text(to_svg([ONE, AROUND], view_box=box, y_up=True))
        assert (checked(capsys, drawing, result)[0] == 0) is holds


def test_maps(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    drawing.write_text(json.dumps({"type": "FeatureCollection", "features": [region(0.0, "a"), region(5.0, None)]}))
    assert main([str(drawing), "--levels", "16", "8", "-o", str(result)]) == 0
    assert checked(capsys, drawing, result, "--levels", "16", "8")[1].startswith("4 cages: everything holds.\n")
    cages = list(features_from_geojson(result.read_text()))
    swapped = [cages[k] for k in (0, 1, 3, 2)]
    result.write_text(to_geojson(swapped[:2]))
    assert "2 shapes" in checked(capsys, drawing, result)[1]
    result.write_text(to_geojson([cages[k] for k in (2, 3, 0, 1)]))
    assert "shape 1: level 1: " in checked(capsys, drawing, result)[1]


def test_each_cage_may_have_fewer_loops_than_the_one_before(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """The finest one, which keeps them all, says nothing about coarser ones."""
    drawing, result = tmp_path / "in.svg", tmp_path / "out.svg"
    places = [(2.6 * (k % 3), 2.6 * (k // 3)) for k in range(6)]
    drawing.write_text(to_svg(Mesh.from_loops([ring(24, centre=place) for place in places])))
    assert main([str(drawing), "--levels", "40", "8", "-o", str(result)]) == 0
    status, said = checked(capsys, drawing, result)
    assert status == 0 and "level 1: 40 vertices, 6 loops" in said and "share one" in said
    assert "not 6" in checked(capsys, drawing, result, "--same-loops")[1]


@pytest.mark.slow
def test_pictures_and_motions(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    picture, result, frames = tmp_path / "in.png", tmp_path / "out.json", tmp_path / "frames.json"
    rows, columns = np.mgrid[:20, :24]
    picture.write_bytes(png(np.abs(np.hypot(rows - 9.5, columns - 11.5) - 6.0) < 2.0))
    assert main([str(picture), "--levels", "10", "-o", str(result)]) == 0
    assert checked(capsys, picture, result)[0] == 0
    other = picture.with_name("other.png")
    other.write_bytes(png(np.abs(np.hypot(rows - 8.5, columns - 9.5) - 5.0) < 2.0))
    for flip in ([], ["--flip-y"]):
        assert main([str(picture), "--levels", "10", *flip, "-o", str(result)]) == 0
        assert checked(capsys, picture, result, *flip)[0] == 0
        assert checked(capsys, other, result, *flip)[0] == 1
        assert main([str(picture), str(other), "--levels", "10", *flip, "-o", str(frames)]) == 0
        assert checked(capsys, picture, other, frames, *flip)[0] == 0
        assert "shape 1: " in checked(capsys, other, picture, frames, *flip)[1]
        assert "has 3 shapes" in checked(capsys, picture, other, other, frames, *flip)[1]
    assert "shape 2: " in checked(capsys, picture, other, frames)[1]

    fine, moves = star(5, 40), np.linspace(0.0, 0.4, 4)
    poses = [fine.vertices + np.array([x, 0.0]) for x in moves]
    moving = animated_cages(fine, poses, [12]).levels[0]
    frames.write_text(frames_to_engine_json([fine.moved(x) for x in moving.fine_steps]))
    result.write_text(frames_to_engine_json([moving.cage.moved(x) for x in moving.cage_steps]))
    assert checked(capsys, frames, result)[0] == 0
    far = np.stack([fine.vertices, fine.vertices * (-1.0, -1.0)])  # nested before and after, and turned inside out
    frames.write_text(frames_to_engine_json([fine.moved(x) for x in far]))
    result.write_text(frames_to_engine_json([fine.moved(1.2 * x) for x in far]))
    assert "between steps 0 and 1" in checked(capsys, frames, result)[1]
    result.write_text(frames_to_engine_json([nested_cages(fine, [count]).cages[0] for count in (20, 22)]))
    assert "numbers of vertices" in checked(capsys, frames, result)[1]


def test_what_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    good, bad = tmp_path / "good.svg", tmp_path / "bad.json"
    good.write_text(to_svg(letter_a()))
    for content in ("[", "[1]", "{}", '{"polygons": 3}', '{"features": [{"type": "Polygon"}]}'):
        bad.write_text(content)
        assert checked(capsys, good, bad)[0] == 1
    assert "No such file" in checked(capsys, good, tmp_path / "none.json")[1]
    with pytest.raises(SystemExit, match="2"):
        main(["check", str(good)])
