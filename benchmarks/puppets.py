"""Puppets of 94 layered characters: parents, ranges of joints, folds, one cage instead, gaps at joints, skins."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain

import numpy as np
import shapely
import shapely.affinity

from common import DETAILS, HERE, Options, Server, parts, table
from nestedcages_core import (
    Mesh,
    Puppet,
    PuppetDraft,
    PuppetPart,
    bone_weights,
    draft_puppet,
    nested_cages,
    puppet_of,
    puppet_parts,
    with_joints,
)
from nestedcages_core.coordinates import Field, field_of, folded, holding
from nestedcages_core.geometry.predicates import winding_number
from nestedcages_core.geometry.triangulation import Triangulation
from nestedcages_core.puppets import BendField, Cap, Hold, Linear, Link, PreserveVolume, skinned
from nestedcages_core.puppets.caps import caps_of, joint_radius

CAST = json.loads((HERE / "cast" / "parents.json").read_text(encoding="utf-8"))
"""Of each character its set, and of each part the one that a rigger would hang it on, None for the root.

The weights of the graph are fitted to sets 1 to 8, each drawn when those before had been measured. Set 9 was measured
once and is fitted to nothing.
"""

NOT_FITTED = 9
BENT = ("cat", "snake", "octopus", "dragon", "elephant", "crab")
"""Characters with many parts that bend, for what takes long."""
POSES, FEW = 40, 4
"""Random poses of each character and each largest angle, and those of a quick run."""


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


def names_of(options: Options) -> list[str]:
    """The characters to measure."""
    return list(CAST)[3::18] if options.quick else list(CAST)


def drawing(name: str) -> tuple[PuppetPart, ...]:
    return puppet_parts((HERE / "cast" / f"{name}.svg").read_text(encoding="utf-8"))[0]


@cache
def drafted(name: str) -> tuple[PuppetDraft, float]:
    """The draft of a character, and the CPU seconds that it took."""
    drawn = drawing(name)
    start = time.process_time()
    return draft_puppet(drawn), time.process_time() - start


@cache
def made(name: str) -> tuple[Puppet, float]:
    """The puppet of a character, and the CPU seconds that it took after the draft."""
    draft = drafted(name)[0]
    start = time.process_time()
    return puppet_of(draft), time.process_time() - start


def wrong(draft: PuppetDraft, name: str) -> list[Link]:
    """Links to another parent than a rigger would choose."""
    parents = CAST[name]["parents"]
    found = [None if link.parent is None else list(parents)[link.parent] for link in draft.links]
    return [link for own, link, parent in zip(parents, draft.links, found, strict=True) if parent != parents[own]]


def graph(options: Options) -> str:
    """Parents that are right, with the names of the drawing and without any."""
    rows, sums = [], np.zeros((2, 3), dtype=int)
    links, bad_links = list[Link](), list[Link]()
    for name in names_of(options):
        draft = drafted(name)[0]
        bad, new = wrong(draft, name), CAST[name]["set"] == NOT_FITTED
        if not new:
            links += [link for link in draft.links if link.parent is not None]
            bad_links += [link for link in bad if link.parent is not None]
        bare = [replace(part, name=f"path{k}") for k, part in enumerate(draft.parts)]
        own, without = len(bad), len(wrong(draft_puppet(bare), name))
        sums[int(new)] += len(bare), own, without
        rows.append((name, len(bare), len(bare) - own, len(bare) - without))
    doubtful, doubted = (sum(link.is_doubtful for link in some) for some in (links, bad_links))
    seconds = sum(drafted(name)[1] for name in names_of(options))
    shares = [
        (label, count, *(f"{100.0 * (1.0 - part / count):.1f} %" for part in (own, without)))
        for label, (count, own, without) in zip(("fitted", "not fitted"), sums.tolist(), strict=True)
        if count
    ]
    head = ("parts", "parents right", "without names")
    return (
        f"{table(('characters', *head), shares)}\n\n"
        f"Of {len(links)} links of fitted characters {doubtful} are marked as doubtful, and of {len(bad_links)} wrong\n"
        f"ones {doubted}. A draft took {20.0 * seconds / sums[:, 0].sum():.2f} s of CPU for twenty parts.\n\n"
        f"{DETAILS}\n\n{table(('character', *head), rows)}"
    )


def ranges(options: Options) -> str:
    """Ranges in which no triangle flips, proved, and those in which cages stay simple."""
    rows, turns, simple = [], [], []
    for name in names_of(options):
        puppet = made(name)[0]
        own = [each for each in puppet.ranges if each.low > -180.0]
        if own:
            turns += [min(-each.low, each.high) for each in own]
            simple += [min(-each.simple_low, each.simple_high) for each in own]
            least = (min(some[-len(own) :]) for some in (turns, simple))
            rows.append((name, len(puppet.bones), len(own), *(f"{each:.0f}°" for each in least)))
    count = sum(len(made(name)[0].draft.parts) for name in names_of(options))
    seconds = sum(made(name)[1] for name in names_of(options))
    shown = [
        (label, *(f"±{each:.0f}°" for each in np.quantile(some, (0.0, 0.1, 0.5))))
        for label, some in (("no triangle flips", turns), ("the cage stays simple", simple))
    ]
    return (
        f"{table(('range in which', 'least', 'a tenth below', 'median'), shown)}\n\n"
        f"{len(turns)} joints that bend. Fields and proofs took {20.0 * seconds / count:.2f} s of CPU for twenty parts."
        f"\n\n{DETAILS}\n\n"
        + table(("character", "bones", "joints that bend", "least without folds", "least with a simple cage"), rows)
    )


def folds(options: Options) -> str:
    """Random poses of the characters with parts that bend."""
    rows = []
    puppets = [made(name)[0] for name in names_of(options)]
    fields = [(puppet, list({id(each): each for each in puppet.fields if each}.values())) for puppet in puppets]
    for largest in (30.0, 60.0, 90.0, 120.0):
        random = np.random.default_rng(options.seed)
        poses, flipped = 0, 0
        for puppet, own in fields:
            for _ in range(poses_of(options) if own else 0):
                turned = random_pose(puppet, random, largest)
                poses += 1
                flipped += any(folded(posed(puppet, each, turned), each.grid.triangles).any() for each in own)
        rows.append((f"±{largest:.0f}°", poses, f"{100.0 * flipped / poses:.1f} %"))
    return table(("all joints at random within", "poses", "with a triangle that flips"), rows)


def poses_of(options: Options) -> int:
    return FEW if options.quick else POSES


def random_pose(puppet: Puppet, random: np.random.Generator, largest: float) -> dict[int, float]:
    joints = [k for k, bone in enumerate(puppet.bones) if bone.parent is not None]
    return dict(zip(joints, random.uniform(-largest, largest, len(joints)).tolist(), strict=True))


def posed(puppet: Puppet, field: BendField, turned: dict[int, float]) -> np.ndarray:
    """Vertices of a field under a pose."""
    weights = np.zeros((len(field.grid.vertices), len(puppet.bones)))
    weights[:, field.first_bone : field.first_bone + len(field.bends) + 1] = field.weights
    return skinned(field.grid.vertices, weights, puppet.bones, turned, puppet.skin)


def against(options: Options) -> str:
    """The same bones in one cage around everything that is seen, as *Rig* does it, against parts that move alone."""
    rows = []
    puppets = [made(name)[0] for name in BENT[: 2 if options.quick else None]]
    sheets = [one_cage(puppet) for puppet in puppets]
    for largest in (60.0, 90.0, 120.0):
        for label, measure in (("one cage", _strain_of_sheet), ("puppet", _strain_of_parts)):
            random = np.random.default_rng(options.seed)
            found = [
                measure(puppet, sheet, random_pose(puppet, random, largest))
                for puppet, sheet in zip(puppets, sheets, strict=True)
                for _ in range(poses_of(options))
            ]
            flips, changed, outside = np.array(found).T
            shown = (100.0 * (flips > 0.0).mean(), 100.0 * changed.mean(), 100.0 * outside.mean())
            rows.append((f"±{largest:.0f}°", label, len(found), *(f"{each:.1f} %" for each in shown)))
    return table(
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


def _strain_of_parts(puppet: Puppet, _: Sheet, turned: dict[int, float]) -> tuple[float, float, float]:
    flips = changed = 0.0
    outside: list[np.ndarray] = []
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
    whole = sum(part.outline.area for part in puppet.draft.parts)
    return flips, changed / whole, float(np.concatenate(outside).mean())


def _stretched(rest: np.ndarray, moved: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Signed area over that at rest, and the latter."""
    now, area = (np.linalg.det(np.diff(points[triangles], axis=1)) for points in (moved, rest))
    return now / area, area


def gaps(options: Options) -> str:
    """Paint that opens around joints between parts: of what is painted in the limb's disc at rest."""
    drafts = [drafted(name)[0] for name in names_of(options)]
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
    head = ("disc", "turned by", "caps", "median", "most", "at most 2 %")
    return f"{table(head, rows)}\n\nOf {count} joints, {capped} have caps."


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


def skins(options: Options) -> str:
    """How far linear blending is from keeping the volume, in widths of the limb, and what ranges it has."""
    rows = []
    for name in ("cat", "snake", "octopus", "elephant")[: 2 if options.quick else None]:
        volume, linear = made(name)[0], puppet_of(drafted(name)[0], Linear())
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
    return table(("character", "apart at 60°", "apart at 120°", "least range, linear"), rows)


TABLES = {each.__name__: each for each in (graph, ranges, folds, against, gaps, skins)}


def tables(options: Options) -> str:
    return parts({name: make(options) for name, make in TABLES.items() if options.wants(name)})


def run(options: Options) -> str:
    """All tables, or those that `--only` names; next to another commit, what each of the two prints."""
    if options.against is None:
        return tables(options)
    found = []
    for commit, tree in options.trees().items():
        with Server(tree, "puppets:tables") as measure:
            found.append(f"{commit}\n\n{measure(options)}")
    return "\n\n".join(found)
