"""A painting that was changed: the puppet keeps its bones, names, order and keys; hulls and weights are made again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..character import Bone
from ..errors import invalid_setting
from ..geometry.arrays import FloatArray
from ..geometry.triangulation import Triangulation
from ..layers import PicturePart
from ..puppet import Hold, PartChoice, PuppetDraft, draft_puppet
from .animation import Animation
from .local import unique_names
from .mesh import PartMesh, engine_weights
from .proved import proved_ranges
from .puppet import HULL_VERTICES, GamePuppet, PartRecord, checksum_of, meshed, puppet_part


@dataclass(frozen=True)
class Changes:
    """What became of the layers of a painting, by name of the part."""

    added: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    repainted: tuple[str, ...] = ()
    """Other pixels, or another place."""
    renamed: tuple[str, ...] = ()
    """They keep their names in the puppet."""
    is_reordered: bool = False

    @property
    def sentences(self) -> tuple[str, ...]:
        """What to tell."""
        said = {"New": self.added, "Gone": self.removed, "Repainted": self.repainted, "Renamed": self.renamed}
        found = [f"{what}: {', '.join(names)}." for what, names in said.items() if names]
        return (*found, *(("The order of the layers changed.",) if self.is_reordered else ()))


def with_hand_weights(puppet: GamePuppet, weights: Mapping[str, FloatArray]) -> GamePuppet:
    """The puppet with weights (n, B) that were painted by hand, by name of the mesh, and with what is proved of these.

    Raises NestedCagesError for other meshes, and for weights that are none.
    """
    meshes = {mesh.name: mesh for mesh in puppet.meshes}
    hand = dict(puppet.hand)
    for name, painted in weights.items():
        if name not in meshes or np.shape(painted) != meshes[name].weights.shape:
            raise invalid_setting(f"There is no mesh {name!r} with weights of the shape {np.shape(painted)}.")
        if not (painted >= 0.0).all() or not np.allclose(painted.sum(axis=1), 1.0):
            raise invalid_setting(f"The weights of {name!r} must not be negative, and sum to 1 at each point.")
        solved = meshes[name].weights - hand.get(name, 0.0)
        hand[name] = painted - solved
        meshes[name] = replace(meshes[name], weights=np.asarray(painted, dtype=np.float64))
    found = tuple(meshes.values())
    return replace(puppet, meshes=found, hand=hand, ranges=proved_ranges(puppet.bones, found))


def repainted(
    old: GamePuppet, parts: Sequence[PicturePart], size: tuple[int, int], *, vertices: int = HULL_VERTICES
) -> tuple[GamePuppet, Changes]:
    """The puppet of a painting that was changed, and what changed.

    Layers are the same by their ids, then by groups and name. Bones of layers that stay keep places, names and keys;
    weights are solved again, and what was painted by hand is added at the same places. New layers get bones of their
    own. The canvas may grow to the right and downwards. Raises NestedCagesError.
    """
    if not parts:
        raise invalid_setting("The picture has no visible layer with pixels; show one, or include hidden layers.")
    place = old.place
    records = _known_again(old.parts, parts)
    kept = [record.name for record in records if record is not None]
    new = unique_names((part.name for part, record in zip(parts, records, strict=True) if record is None), "", kept)
    names, fresh = [], iter(new)
    for record in records:
        names.append(record.name if record is not None else next(fresh))
    choices = {record.name: _choice(record, old.parts, set(kept)) for record in records if record is not None}
    outlines = [replace(puppet_part(part, place), name=name) for part, name in zip(parts, names, strict=True)]
    draft = _with_bones(draft_puppet(outlines, choices), old, records)
    made = meshed(draft, parts, place, name=old.name, vertices=vertices)
    made = replace(made, animations=_kept_animations(old, made.bones))
    changes = Changes(
        tuple(new),
        tuple(record.name for record in old.parts if record.name not in kept),
        tuple(
            r.name for r, part in zip(records, parts, strict=True) if r is not None and r.checksum != checksum_of(part)
        ),
        tuple(r.name for r, part in zip(records, parts, strict=True) if r is not None and r.path != part.path),
        kept != [record.name for record in old.parts if record.name in kept],
    )
    return _with_hand(made, old), changes


def _known_again(old: Sequence[PartRecord], parts: Sequence[PicturePart]) -> list[PartRecord | None]:
    """For each part what it was before, None for new ones."""
    found: list[PartRecord | None] = [None] * len(parts)
    left = list(old)
    for key in ("identity", "path"):
        for k, part in enumerate(parts):
            same = [record for record in left if getattr(record, key) == getattr(part, key)]
            if found[k] is None and same and getattr(part, key):
                found[k] = same[0]
                left.remove(same[0])
    return found


def _choice(record: PartRecord, records: Sequence[PartRecord], kept: set[str]) -> PartChoice:
    """How a part hung before; on the next one towards the root, if its parent is gone."""
    parents = {each.name: each.parent for each in records}
    parent = record.parent
    while parent and parent not in kept:
        parent = parents[parent]
    if not parent:
        return PartChoice(parent="" if record.hold is Hold.ROOT else None, bones=len(record.bones) or None)
    if record.hold is Hold.RIDES:
        return PartChoice(parent=parent, hold=Hold.RIDES)
    return PartChoice(parent=parent, joint=record.joint, hold=Hold.JOINT, bones=len(record.bones))


def _with_bones(draft: PuppetDraft, old: GamePuppet, records: Sequence[PartRecord | None]) -> PuppetDraft:
    """The draft with the old bones of parts that have as many as before."""
    before = {bone.name: bone for bone in old.bones}
    bones = list(draft.bones)
    kept: dict[int, Bone] = {}
    for k, record in enumerate(records):
        chain = draft.chain(k)
        if record is not None and len(chain) == len(record.bones):
            kept.update({bone: before[name] for bone, name in zip(chain, record.bones, strict=True)})
    new = [number for number in range(len(bones)) if number not in kept]
    names = unique_names((bones[number].name for number in new), "", [bone.name for bone in kept.values()])
    for number, name in zip(new, names, strict=True):
        bones[number] = replace(bones[number], name=name)
    places = {bone.name: number for number, bone in kept.items()}
    for number, bone in kept.items():
        above = None if bone.parent is None else places.get(old.bones[bone.parent].name)
        parent = above if above is not None and above < number else bones[number].parent
        bones[number] = replace(bone, parent=parent)
    return replace(draft, bones=tuple(bones))


def _kept_animations(old: GamePuppet, bones: Sequence[Bone]) -> tuple[Animation, ...]:
    """The animations, without keys of bones that are gone."""
    names = {bone.name for bone in bones}
    return tuple(
        replace(
            animation,
            turned={name: keys for name, keys in animation.turned.items() if name in names},
            shifted={name: keys for name, keys in animation.shifted.items() if name in names},
        )
        for animation in old.animations
    )


def _with_hand(made: GamePuppet, old: GamePuppet) -> GamePuppet:
    """The puppet with what was painted by hand on the old one, at the same places."""
    before = {mesh.name: mesh for mesh in old.meshes}
    column = {bone.name: k for k, bone in enumerate(made.bones)}
    target = [column.get(bone.name) for bone in old.bones]
    meshes, hand = [], {}
    for mesh in made.meshes:
        painted = old.hand.get(mesh.name)
        if painted is not None and np.any(painted):
            carried = np.zeros_like(mesh.weights)
            here = values_at(before[mesh.name], painted, mesh.points)
            for k, bone in enumerate(target):
                if bone is not None:
                    carried[:, bone] += here[:, k]
            weights = engine_weights(mesh.weights + carried)
            hand[mesh.name] = weights - mesh.weights
            mesh = replace(mesh, weights=weights)
        meshes.append(mesh)
    return replace(made, meshes=tuple(meshes), hand=hand, ranges=proved_ranges(made.bones, meshes))


def values_at(mesh: PartMesh, values: FloatArray, points: FloatArray) -> FloatArray:
    """Values (n, B) of a mesh at points (P, 2): linear on its triangles; outside, those of the nearest point on it."""
    ring = np.arange(mesh.hull)
    grid = Triangulation(mesh.points, mesh.triangles, ring, np.roll(ring, -1), np.zeros(mesh.hull))
    return np.asarray(grid.interpolation(points) @ values)
