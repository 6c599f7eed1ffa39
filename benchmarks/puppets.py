"""Puppets of layered characters: parents that are right, ranges of joints, folds, gaps, and skins, measured.

    python benchmarks/puppets.py                 # all tables
    python benchmarks/puppets.py graph --svg DIR # one table; and the characters as files
    python benchmarks/puppets.py --write         # puts them into docs/puppets.md

`cast` has the characters and says what a rigger would hang each part on.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np
import shapely
import shapely.affinity

import cast
from clone import ROOT
from needed.table import Table
from nestedcages_core import Mesh, nested_cages
from nestedcages_core.character import Linear, PreserveVolume, bone_weights, skinned, with_joints
from nestedcages_core.coordinates import Field, field_of, folded, holding
from nestedcages_core.exchange import puppet_parts
from nestedcages_core.geometry.predicates import winding_number
from nestedcages_core.geometry.triangulation import Triangulation
from nestedcages_core.puppet import BendField, Cap, Hold, Link, Puppet, PuppetDraft, PuppetPart, draft_puppet, puppet_of
from nestedcages_core.puppet.caps import caps_of, joint_radius
from page import measured

CHARACTERS = cast.TUNED | cast.NINTH
BENT = ("cat", "snake", "octopus", "dragon", "elephant", "crab")
"""Characters with many parts that bend, for what takes long."""
POSES = 40
"""Random poses of each character and each largest angle."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A character as one sheet that a cage bends."""

    shape: Mesh
    cage: Mesh
    field: Field
    weights: np.ndarray
    """Of bones at the cage's vertices."""
    held: np.ndarray
    """Which triangles of the field hold paint."""


def parts_of(name: str) -> tuple[PuppetPart, ...]:
    return puppet_parts(CHARACTERS[name]().svg())[0]


def wrong(draft: PuppetDraft, on: dict[str, str | None], names: list[str]) -> list[Link]:
    """Links to another parent than a rigger would choose; names: of the drawing, in stacking order."""
    parents = [None if link.parent is None else names[link.parent] for link in draft.links]
    return [link for name, link, parent in zip(names, draft.links, parents, strict=True) if parent != on[name]]


def graph() -> Table:
    """Parents that are right, with the names of the drawing and without any."""
    groups = {"fitted": cast.TUNED, "not fitted": cast.NINTH}
    rows, sums = [], np.zeros((len(groups), 3), dtype=int)
    links, bad_links = list[Link](), list[Link]()
    seconds = 0.0
    for name, draw in CHARACTERS.items():
        sheet, parts = draw(), parts_of(name)
        names = [part.name for part in parts]
        start = time.process_time()
        draft = draft_puppet(parts)
        seconds += time.process_time() - start
        bad = wrong(draft, sheet.on, names)
        if name in cast.TUNED:
            links += [link for link in draft.links if link.parent is not None]
            bad_links += [link for link in bad if link.parent is not None]
        bare = [replace(part, name=f"path{k}", identity="") for k, part in enumerate(parts)]
        own, without = len(bad), len(wrong(draft_puppet(bare), sheet.on, names))
        sums[[name in some for some in groups.values()]] += len(parts), own, without
        rows.append((name, str(len(parts)), str(len(parts) - own), str(len(parts) - without)))
    for label, (count, own, without) in zip(groups, sums.tolist(), strict=True):
        rows.append((label, str(count), *(f"{100.0 * (1.0 - part / count):.1f} %" for part in (own, without))))
    doubtful, doubted = (sum(link.is_doubtful for link in some) for some in (links, bad_links))
    return Table(
        ("character", "parts", "parents right", "without names"),
        rows,
        after=(
            f"Of {len(links)} links of fitted characters {doubtful} are marked as doubtful, and of {len(bad_links)} "
            f"wrong ones {doubted}. A draft took {20.0 * seconds / sums[:, 0].sum():.2f} s of CPU for twenty parts."
        ),
    )


def ranges() -> Table:
    """Ranges in which no triangle flips, proved, and those in which cages stay simple."""
    rows, turns = [], []
    seconds, count = 0.0, 0
    for name in CHARACTERS:
        draft = draft_puppet(parts_of(name))
        start = time.process_time()
        puppet = puppet_of(draft)
        seconds, count = seconds + time.process_time() - start, count + len(draft.parts)
        own = [each for each in puppet.ranges if each.low > -180.0]
        turns += [min(-each.low, each.high) for each in own]
        if own:
            least = [
                min(min(-each.low, each.high) for each in own),
                min(min(-e.simple_low, e.simple_high) for e in own),
            ]
            rows.append((name, str(len(puppet.bones)), str(len(own)), *(f"{each:.0f}°" for each in least)))
    return Table(
        ("character", "bones", "joints that bend", "least range without folds", "least with a simple cage"),
        rows,
        after=(
            f"Of {len(turns)} joints that bend, the least turns ±{min(turns):.0f}°, half of them at least "
            f"±{np.median(turns):.0f}°. Fields and proofs took {20.0 * seconds / count:.2f} s of CPU for twenty parts."
        ),
    )


def folds() -> Table:
    """Random poses of the characters with parts that bend."""
    rows = []
    puppets = [puppet_of(draft_puppet(parts_of(name))) for name in CHARACTERS]
    fields = [(puppet, list({id(each): each for each in puppet.fields if each}.values())) for puppet in puppets]
    for largest in (30.0, 60.0, 90.0, 120.0):
        random = np.random.default_rng(0)
        poses, flipped = 0, 0
        for puppet, own in fields:
            for _ in range(POSES if own else 0):
                turned = {
                    k: random.uniform(-largest, largest)
                    for k, bone in enumerate(puppet.bones)
                    if bone.parent is not None
                }
                poses += 1
                flipped += any(folded(posed(puppet, each, turned), each.grid.triangles).any() for each in own)
        rows.append((f"±{largest:.0f}°", str(poses), f"{100.0 * flipped / poses:.1f} %"))
    return Table(("all joints at random within", "poses", "with a triangle that flips"), rows)


def posed(puppet: Puppet, field: BendField, turned: dict[int, float]) -> np.ndarray:
    """Vertices of a field under a pose."""
    weights = np.zeros((len(field.grid.vertices), len(puppet.bones)))
    weights[:, field.first_bone : field.first_bone + len(field.bends) + 1] = field.weights
    return skinned(field.grid.vertices, weights, puppet.bones, turned, puppet.skin)


def against() -> Table:
    """The same bones in one cage around everything that is seen, as *Rig* does it, against parts that move alone."""
    rows = []
    puppets = [puppet_of(draft_puppet(parts_of(name))) for name in BENT]
    sheets = [one_cage(puppet) for puppet in puppets]
    for largest in (60.0, 90.0, 120.0):
        for label, measure in (("one cage", _strain_of_sheet), ("puppet", _strain_of_parts)):
            random = np.random.default_rng(0)
            found = []
            for puppet, sheet in zip(puppets, sheets, strict=True):
                joints = [k for k, bone in enumerate(puppet.bones) if bone.parent is not None]
                for _ in range(POSES):
                    turned = dict(zip(joints, random.uniform(-largest, largest, len(joints)).tolist(), strict=True))
                    found.append(measure(puppet, sheet, turned))
            flips, changed, outside = np.array(found).T
            shown = (100.0 * (flips > 0.0).mean(), 100.0 * changed.mean(), 100.0 * outside.mean())
            rows.append((f"±{largest:.0f}°", label, str(len(found)), *(f"{each:.1f} %" for each in shown)))
    return Table(
        ("all joints at random within", "", "poses", "with a flip", "area changed by half", "paint outside"), rows
    )


def one_cage(puppet: Puppet) -> Sheet:
    """A cage around all that is seen, its field, and the weights of a puppet's bones."""
    whole = shapely.union_all([part.solid for part in puppet.draft.parts])
    shape = Mesh.of(shapely.Polygon(max(shapely.get_parts(whole), key=lambda each: each.area).exterior).simplify(0.3))
    (level,) = nested_cages(shape, 40, clearance=0.01 * shape.diagonal)
    cage = with_joints(level.cage, puppet.bones)
    field = field_of(cage)
    return Sheet(shape, cage, field, bone_weights(cage, puppet.bones), holding(field.vertices, field.triangles, shape))


def _strain_of_sheet(puppet: Puppet, sheet: Sheet, turned: dict[int, float]) -> tuple[float, float, float]:
    cage = skinned(sheet.cage.vertices, sheet.weights, puppet.bones, turned)
    triangles = sheet.field.triangles[sheet.held]
    moved = sheet.field.weights @ cage
    ratio, area = _stretched(sheet.field.vertices, moved, triangles)
    grid = Triangulation(sheet.field.vertices, triangles, *([np.zeros(0, dtype=int)] * 2), np.zeros(0))
    shape = sheet.shape.vertices + grid.interpolation(sheet.shape.vertices) @ (moved - sheet.field.vertices)
    out = winding_number(shape, cage, cage[sheet.cage.successor]) == 0
    return float((ratio <= 0.0).any()), float(area[np.abs(ratio - 1.0) > 0.5].sum() / area.sum()), float(out.mean())


def _strain_of_parts(puppet: Puppet, sheet: Sheet, turned: dict[int, float]) -> tuple[float, float, float]:
    del sheet
    flips = changed = 0.0
    outside: list[np.ndarray] = []
    whole = sum(part.outline.area for part in puppet.draft.parts)
    for number, (field, part) in enumerate(zip(puppet.fields, puppet.draft.parts, strict=True)):
        if field is None:
            outside.append(np.zeros(len(part.outline.vertices), dtype=bool))
            continue
        moved = posed(puppet, field, turned)
        ratio, area = _stretched(field.grid.vertices, moved, field.grid.triangles)
        if puppet.draft.links[number].hold is not Hold.RIDES:
            flips += float((ratio <= 0.0).sum())
            changed += float(area[np.abs(ratio - 1.0) > 0.5].sum())
        points = puppet.moved(number, part.outline.vertices, {puppet.bones[k].name: turned[k] for k in turned})
        outside.append(winding_number(points, moved[field.rim[:, 0]], moved[field.rim[:, 1]]) == 0)
    return flips, changed / whole, float(np.concatenate(outside).mean())


def _stretched(rest: np.ndarray, moved: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Signed area over that at rest, and the latter."""
    now, area = (np.linalg.det(np.diff(points[triangles], axis=1)) for points in (moved, rest))
    return now / area, area


def gaps() -> Table:
    """Paint that opens around joints between parts: of what is painted in the limb's disc at rest."""
    drafts = [draft_puppet(parts_of(name)) for name in CHARACTERS]
    caps = [caps_of(draft) for draft in drafts]
    rows = []
    for label, reach in (("as far as outlines cross", joint_radius), ("as wide as the thinner part", _thinner)):
        for angle in (45.0, 90.0):
            for with_caps in ("no", "yes"):
                lost = [
                    opened(draft, own if with_caps == "yes" else (), reach, angle)
                    for draft, own in zip(drafts, caps, strict=True)
                ]
                some = np.fromiter(chain.from_iterable(lost), dtype=float)
                shown = (100.0 * np.median(some), 100.0 * some.max())
                share = f"{100.0 * (some <= 0.02).mean():.0f} %"
                rows.append((label, f"±{angle:.0f}°", with_caps, *(f"{each:.1f} %" for each in shown), share))
    count = sum(link.hold is Hold.JOINT for draft in drafts for link in draft.links)
    capped = sum(len({cap.part for cap in each}) for each in caps)
    return Table(
        ("disc", "turned by", "caps", "median", "most", "at most 2 %"),
        rows,
        after=f"Of {count} joints, {capped} have caps.",
    )


def _thinner(limb: PuppetPart, on: PuppetPart, link: Link) -> float:
    return max(link.radius, min(limb.disc[1], on.disc[1]))


def opened(
    draft: PuppetDraft, caps: Sequence[Cap], reach: Callable[[PuppetPart, PuppetPart, Link], float], angle: float
) -> Iterator[float]:
    """The part of the paint in a disc around each joint that a turn takes away, one way or the other."""
    for number, (limb, link) in enumerate(zip(draft.parts, draft.links, strict=True)):
        if link.hold is not Hold.JOINT or link.parent is None:
            continue
        on = draft.parts[link.parent]
        disc = shapely.Point(link.joint).buffer(reach(limb, on, link))
        rest = disc.intersection(limb.solid.union(on.solid))
        own = [cap.solid.intersection(limb.solid) for cap in caps if cap.part == number]
        still = shapely.union_all([on.solid, *own])
        turned = [shapely.affinity.rotate(limb.solid, turn, origin=link.joint) for turn in (angle, -angle)]
        yield max(1.0 - rest.intersection(each.union(still)).area / rest.area for each in turned)


def skins() -> Table:
    """How far linear blending is from keeping the volume, in widths of the limb, and what ranges it has."""
    rows = []
    for name in ("cat", "snake", "octopus", "elephant"):
        draft = draft_puppet(parts_of(name))
        volume, linear = puppet_of(draft, PreserveVolume()), puppet_of(draft, Linear())
        turns = [min(-each.low, each.high) for each in linear.ranges if each.low > -180.0]
        cells = []
        for angle in (60.0, 120.0):
            apart = []
            for field in {id(each): each for each in volume.fields if each}.values():
                for k, bend in enumerate(field.bends):
                    turned = {field.first_bone + k + 1: angle}
                    one, other = (
                        posed(replace(volume, skin=skin), field, turned) for skin in (PreserveVolume(), Linear())
                    )
                    apart.append(float(np.hypot(*(one - other).T).max()) / (2.0 * bend.width))
            cells.append(f"{np.median(apart):.2f}")
        rows.append((name, *cells, f"{min(turns):.0f}°"))
    return Table(("character", "apart at 60°", "apart at 120°", "least range, linear"), rows)


TABLES: dict[str, Callable[[], Table]] = {
    "graph": graph, "ranges": ranges, "folds": folds, "against": against, "gaps": gaps, "skins": skins,
}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"only these: {', '.join(TABLES)}")
    parser.add_argument("--svg", type=Path, help="write the characters into this folder")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/puppets.md")
    options = parser.parse_args()
    unknown = [name for name in options.tables if name not in TABLES]
    if unknown:
        parser.error(f"there is no table {unknown[0]!r}; there are {', '.join(TABLES)}")
    for name, draw in CHARACTERS.items() if options.svg else ():
        options.svg.mkdir(parents=True, exist_ok=True)
        (options.svg / f"{name}.svg").write_text(draw().svg(), encoding="utf-8")
    for name in options.tables or TABLES:
        made = TABLES[name]()
        print(f"{name}\n{made}\n", flush=True)
        if options.write:
            page = ROOT / "docs" / "puppets.md"
            measured(page, f"puppet_{name}", f"python benchmarks/puppets.py {name}", str(made), str(made))
    return 0


if __name__ == "__main__":
    sys.exit(main())
