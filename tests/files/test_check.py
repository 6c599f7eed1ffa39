"""`nested-cages check`: exit 0 where everything in the files holds, 1 where something does not, and never a crash."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import nestedcages_core as core
from nestedcages_core import Feature, Mesh, frames_to_engine_json, from_svg, nested_cages, to_geojson, to_svg
from support.command import run
from support.documents import closed, collection, feature, png, svg
from support.marks import slow_after
from support.shapes import letter_a, ring, star

CURVED = svg('<path d="M1 1 C 4 0 8 1 8 5 S 5 8 4 8 S 1 4 1 1"/><path d="M6 6h2v2h-2z"/>', 'viewBox="0 0 9 9"')


def checked(*words: object, holds: bool = True) -> str:
    """All that the check says, once it has the right status and stream."""
    done = run("check", *words)
    assert done.status == (0 if holds else 1), done
    assert bool(done.out.strip()) == holds and bool(done.err.strip()) != holds and "Traceback" not in done.err
    return str(done.out + done.err)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing with its cages as the command writes them: in.svg, out.svg and out.json."""
    place = tmp_path_factory.mktemp("check")
    (place / "in.svg").write_text(CURVED)
    command = ["in.svg", "--levels", 16, 8, "--grid", 0.01, "-o", "out.svg", "-o", "out.json", "--quiet"]
    assert run(*command, cwd=place).status == 0
    return place


def test_what_the_command_writes_holds(folder: Path) -> None:
    said = checked(folder / "in.svg", folder / "out.svg", "--levels", 16, "50%", "--grid", 0.01)
    assert "16" in said and "8" in said and len(said.splitlines()) == 3  # how many, and each level
    checked(folder / "out.svg", folder / "out.json")
    for options in (["--levels", "16"], ["--levels", "16 8 4"], ["--levels", "15 8"], ["--levels", "16 1%"],
                    ["--levels", "+0.1% 8"], ["--levels", "0.001u 8"], ["--grid", "0.3"], ["--clearance", "0.1"],
                    ["--distance", "0.001"], ["--symmetry", "x"], ["--inside"]):  # fmt: skip
        checked(folder / "in.svg", folder / "out.svg", *options, holds=False)
    checked(folder / "in.svg", folder / "out.svg", "--levels", "+50% 9u", "--distance", 9, "--clearance", 1e-6)


def test_cages_of_other_places_and_levels_are_wrong(folder: Path, tmp_path: Path) -> None:
    fine, result = from_svg(CURVED), tmp_path / "out.svg"
    cage, inner = nested_cages(fine, [16]).cages[0], core.inner_cages(fine, [16]).cages[0]

    def judged(shapes: dict[str, Mesh], levels: list[int], *, holds: bool) -> str:
        result.write_text(to_svg(shapes, levels=levels, view_box=(0, 0, 9, 9)))
        return checked(folder / "in.svg", result, holds=holds)

    judged({"D": fine, "C": cage, "I": inner}, [0, 1, -1], holds=True)
    judged({"D": fine, "C": fine.moved(fine.vertices * 0.9)}, [0, 1], holds=False)
    judged({"D": fine, "C": cage, "B": cage}, [0, 1, 1], holds=False)
    judged({"D": fine, "C": cage, "I": cage}, [0, 1, -1], holds=False)
    judged({"D": fine}, [0], holds=False)
    named = {f"{owner} {what}": mesh for owner in "ab" for what, mesh in (("Fine", fine), ("Cage 1", cage))}
    result.write_text(to_svg(named, levels=[0, 1, 0, 1]))
    assert "2 shapes" in checked(result, result)


CAGES = nested_cages(from_svg(CURVED), [16, 8]).cages
PICTURE = to_svg({"drawing": from_svg(CURVED), "cage-1": CAGES[0], "cage-2": CAGES[1]}, view_box=(0, 0, 9, 9))
FIRST = re.search(r' *<path id="cage-1".*?/>', PICTURE, re.DOTALL)[0]  # type: ignore[index]
BOTH = re.search(r' *<path id="cage-2".*/>', PICTURE.partition('  <path id="drawing"')[0], re.DOTALL)[0]  # type: ignore[index]


def for_first(path: str) -> str:
    return PICTURE.replace(FIRST, path)


def with_attribute(attribute: str) -> str:
    return for_first(FIRST.replace("<path", f"<path {attribute}"))


FORGED = {
    "in comments": PICTURE.replace(BOTH, f"<!--{BOTH}-->"),
    "one in a comment": for_first(f"<!--{FIRST}-->"),
    "far away": PICTURE.replace(BOTH, f'<g transform="translate(50 0)">{BOTH}</g>'),
    "scaled": with_attribute('transform="scale(.9)"'),
    "scaled beyond numbers": with_attribute('transform="scale(1e300)"'),
    "moved by style": with_attribute('style="transform:translateX(2px)"'),
    "moved by what is not read": with_attribute('style="translate:3px 0"'),
    "another view box": PICTURE.replace("0 0 9 9", "0 0 18 18"),
    "another page": PICTURE.replace("viewBox", 'width="9" height="2" viewBox'),
    "not displayed": with_attribute('display="none"'),
    "not displayed by style": with_attribute('style="display:none"'),
    "not displayed by a sheet": PICTURE.replace("</svg>", "<style>#cage-1{display:none}</style></svg>"),
    "by a default of the document": f'<!DOCTYPE svg [<!ATTLIST path display CDATA "none">]>{PICTURE}',
    "by another's sheet": '<?xml-stylesheet href="a.css"?>' + PICTURE,
    "not visible": PICTURE.replace(BOTH, f'<g visibility="hidden">{BOTH}</g>'),
    "not opaque": PICTURE.replace(BOTH, f'<g opacity="0">{BOTH}</g>'),
    "no paint": for_first(re.sub('(fill|stroke)="#', r'\1="none" a\1="#', FIRST)),
    "as definitions": PICTURE.replace(BOTH, f"<defs>{BOTH}</defs>"),
    "as a symbol": PICTURE.replace(BOTH, f"<symbol>{BOTH}</symbol>"),
    "used elsewhere": PICTURE.replace("</svg>", '<use href="#cage-1" x="40"/></svg>'),
    "only used elsewhere": PICTURE.replace(BOTH, f'<defs><g id="g">{BOTH}</g></defs><use href="#g" x="40"/>'),
    "in a picture of its own": PICTURE.replace(BOTH, f'<svg viewBox="0 0 3 3" width="9" height="9">{BOTH}</svg>'),
    "clipped": PICTURE.replace(BOTH, f'<clipPath id="c"><path/></clipPath><g clip-path="url(#c)">{BOTH}</g>'),
    "clipped by a shape": with_attribute('style="clip-path:circle(1px)"'),
    "masked": PICTURE.replace(BOTH, f'<mask id="m"/><g mask="url(#m)">{BOTH}</g>'),
    "animated": for_first(FIRST.replace("/>", '><set attributeName="d" to=""/></path>')),
    "scripted": PICTURE.replace("</svg>", "<script>1</script></svg>"),
    "scripted by others": PICTURE.replace("</svg>", "<h:script xmlns:h='http://www.w3.org/1999/xhtml'/></svg>"),
    "scripted by an event": PICTURE.replace("<svg", '<svg onload="1"'),
    "covered": PICTURE.replace("</svg>", '<path d="M0 0h9v9h-9z" fill="#fff"/></svg>'),
    "covered by a picture": PICTURE.replace("</svg>", '<image href="a.png" width="9" height="9"/></svg>'),
    "curved": for_first(FIRST.replace("Z", "C 0 0 9 0 9 9 Z", 1)),
    "filled holes": for_first(FIRST.replace("evenodd", "nonzero").replace(' d="', ' d="M1 1h1v1z')),
    "of two levels": for_first(FIRST.replace("level-1", "level-1 level-2")),
    "a level left out": for_first(""),
    "levels swapped": re.sub("level-[12]", lambda k: f"level-{3 - int(k[0][-1])}", PICTURE),
    "twice the same": PICTURE.replace("</svg>", FIRST + "</svg>"),
    "around another drawing": re.sub(
        '(?s)<path id="drawing".*?/>', '<path id="drawing" class="level-0" d="M0 0h8v8z"/>', PICTURE
    ),
    "not of a page": PICTURE.replace('viewBox="0 0 9 9"', ""),
}


@pytest.mark.parametrize("forged", FORGED)
def test_what_a_viewer_does_not_show_so_is_refused(forged: str, folder: Path, tmp_path: Path) -> None:
    result = tmp_path / "out.svg"
    result.write_text(FORGED[forged])
    assert FORGED[forged] != PICTURE
    said = checked(folder / "in.svg", result, holds=False)
    assert "page" not in forged or result.name in said


def test_what_was_written_elsewhere_the_same_holds(folder: Path, tmp_path: Path) -> None:
    result = tmp_path / "out.svg"
    for picture in (PICTURE, with_attribute('style="-inkscape-stroke:none"')):
        result.write_text(picture)
        checked(folder / "in.svg", result, "--levels", "16 8")


# Maps and outlines

ONE = Mesh.from_loops([[(1, 1), (2, 1), (2, 2), (1, 2)]])
AROUND = Mesh.from_loops([[(0, 0), (3, 0), (3, 3), (0, 3)]])
SQUARE = [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]]
OUTLINE = json.loads(core.to_engine_json(AROUND, triangles=True, pieces=4))


def features(*levels: object, ring: object = None) -> str:
    """A map of cages around `ONE` with some levels, each wider than the one before."""
    found = [Feature(AROUND.moved(AROUND.vertices * (1 + k) - k), {"level": x}) for k, x in enumerate(levels)]
    document = json.loads(to_geojson(found))
    if ring is not None:
        document["features"][0]["geometry"]["coordinates"] = ring
    return json.dumps(document)


def outline(**changed: object) -> str:
    return json.dumps({**OUTLINE, **changed})


DEEP = "[" * 200_000
TRIANGLES = OUTLINE["triangles"]
FORGED_MAPS = [
    *(features(*levels) for levels in ((1, 2, 2), (2, 1), (1, 3), (1, True), (1, "2"), (0, 1))),
    *(features(1, ring=ring) for ring in ([[*SQUARE[:4], [1.5, 1.5]]], [SQUARE, [[4, 4], [5, 4], [5, 5], [4, 4]]],
                                          [SQUARE, SQUARE])),
    features(1).replace("Polygon", "LineString"), DEEP, '{"a":' * 200_000,
]  # fmt: skip
FORGED_OUTLINES = [
    *("[", "{}", '{"features": [{"type": "Polygon"}]}', DEEP, '{"format": "nested-cages outline", "polygons":' + DEEP),
    *(outline(triangles=wrong) for wrong in (TRIANGLES[:1], TRIANGLES * 2, [each[::-1] for each in TRIANGLES])),
    *(outline(pieces=wrong) for wrong in ([], [[0, 1, 9]])),
    outline(points=[[9, 9], *OUTLINE["points"][1:]]),
    outline(version=2),
    *(outline(format="nested-cages frames", frames=each) for each in ([], [{"polygons": OUTLINE["polygons"]}])),
]
FORGED_PAGES = [
    f"<svg xmlns='http://www.w3.org/2000/svg'>{'<g>' * 50_000}{'</g>' * 50_000}</svg>",
    *(to_svg([ONE, AROUND], view_box=box, y_up=True) for box in ((5, 5, 9, 9), (1.5, -4, 9, 9))),  # do not show it
]


@pytest.mark.parametrize(
    ("ending", "content"),
    [(ending, content) for ending, forged in
     (("geojson", FORGED_MAPS), ("json", FORGED_OUTLINES), ("svg", FORGED_PAGES)) for content in forged],
)  # fmt: skip
def test_forged_maps_and_outlines_are_refused(ending: str, content: str, tmp_path: Path) -> None:
    (tmp_path / "in.geojson").write_text(to_geojson(ONE))
    (tmp_path / f"out.{ending}").write_text(content)
    checked(tmp_path / "in.geojson", tmp_path / f"out.{ending}", holds=False)


def test_right_maps_and_outlines_hold(tmp_path: Path) -> None:
    (tmp_path / "in.geojson").write_text(to_geojson(ONE))
    drawn = to_svg([ONE, AROUND], view_box=(-1, -4, 9, 9), y_up=True)
    for good, kind in ((features(1, 2), "geojson"), (outline(), "json"), (drawn, "svg")):
        (tmp_path / f"good.{kind}").write_text(good)
        checked(tmp_path / "in.geojson", tmp_path / f"good.{kind}")


def test_each_shape_of_a_map_has_its_own_cages(tmp_path: Path) -> None:
    drawing, result = tmp_path / "in.geojson", tmp_path / "out.geojson"
    shapes = [feature([closed(star(5, 40).vertices + np.array([x, 0.0]))]) for x in (0.0, 5.0)]
    drawing.write_text(collection(*shapes))
    assert run(drawing, "--levels", 16, 8, "-o", result, "--quiet").status == 0
    assert checked(drawing, result, "--levels", 16, 8).startswith("4 ")  # two around each shape
    cages = list(core.features_from_geojson(result.read_text()))
    for order in ((0, 1), (2, 3, 0, 1), (0, 1, 3, 2)):
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
    picture, other, result, frames = (tmp_path / name for name in ("in.png", "other.png", "out.json", "frames.json"))
    rows, columns = np.mgrid[:20, :24]
    picture.write_bytes(png(np.abs(np.hypot(rows - 9.5, columns - 11.5) - 6.0) < 2.0))
    other.write_bytes(png(np.abs(np.hypot(rows - 8.5, columns - 9.5) - 5.0) < 2.0))
    assert run(picture, "--levels", 10, *flip, "-o", result).status == 0
    checked(picture, result, *flip)
    checked(other, result, *flip, holds=False)
    assert run(picture, other, "--levels", 10, *flip, "-o", frames).status == 0
    checked(picture, other, frames, *flip)
    for wrong in ((other, picture, frames, *flip), (picture, other, other, frames, *flip), (picture, frames, *flip)):
        checked(*wrong, holds=False)
    if flip:
        checked(picture, other, frames, holds=False)
        faint = np.maximum(np.hypot(rows - 9.5, columns - 11.5) < 6.0, 0.4 * (rows > 2) * (columns < 22))
        picture.write_bytes(png(faint))
        assert run(picture, "--levels", 10, "-o", result).status == 0
        checked(picture, result)
        checked(picture, result, "--threshold", 0.1, holds=False)


@pytest.mark.slow
def test_motions_are_judged_between_their_frames(tmp_path: Path) -> None:
    drawing, result = tmp_path / "in.json", tmp_path / "out.json"
    fine = star(5, 40)
    poses = [fine.vertices + np.array([x, 0.0]) for x in np.linspace(0.0, 0.4, 4)]
    moving = core.animated_cages(fine, poses, [12]).levels[0]

    def judged(fines: list[Mesh], cages: list[Mesh], *, holds: bool) -> None:
        drawing.write_text(frames_to_engine_json(fines))
        result.write_text(frames_to_engine_json(cages))
        checked(drawing, result, holds=holds)

    move: Callable[..., list[Mesh]] = lambda mesh, steps: [mesh.moved(x) for x in steps]  # noqa: E731
    judged(move(fine, moving.fine_steps), move(moving.cage, moving.cage_steps), holds=True)
    judged(move(fine, moving.fine_steps[::-1]), move(moving.cage, moving.cage_steps), holds=False)
    turned = np.stack([fine.vertices, fine.vertices * (-1.0, -1.0)])  # nested before and after, not in between
    judged(move(fine, turned), move(fine, 1.2 * turned), holds=False)
    judged(move(fine, turned[:1].repeat(2, 0)), [nested_cages(fine, [k]).cages[0] for k in (20, 22)], holds=False)


def test_what_is_not_there_or_wrongly_used(folder: Path) -> None:
    checked(folder / "in.svg", folder / "none.json", holds=False)
    (folder / "letter.svg").write_text(to_svg(letter_a()))
    checked(folder / "letter.svg", folder / "letter.svg", holds=False)
    for words in ([folder / "in.svg"], [folder / "in.svg", folder / "out.svg", "--levels", "many"],
                  [folder / "in.svg", folder / "out.svg", "--clearance", "-1"]):  # fmt: skip
        assert run("check", *words).status == 2
