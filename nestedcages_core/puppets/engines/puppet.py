"""A puppet for game engines: bones, textured meshes in drawing order, proved ranges, and animations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import invalid_setting
from ...formats.pictures import boundary_of_pixels
from ...geometry.arrays import FloatArray
from ...geometry.mesh import Mesh
from ...geometry.triangulation import Triangulation
from ...libraries import load_shapely
from ..draft.draft import PuppetDraft, draft_puppet
from ..draft.links import PartChoice
from ..field.bone_weights import skinned
from ..field.mesh import BendField
from ..field.ranges import FREE, JointRange
from ..layers.painting import PicturePart
from ..part import PuppetPart, with_unique_names
from ..puppet import Puppet, bent, limb_of, riders_on
from ..skeleton.bone import Bone, by_number
from .animation import Animation
from .bending import SKIN, best_field, counter_clockwise, limb_in, meshed_loop
from .hulls import Island, certify, islands_of
from .proved import narrower, proved_ranges
from .textured_mesh import PartMesh, Placement

HULL_VERTICES = 16
"""Of the largest hull of a part, by default."""

SOLID = 128
"""Alpha from which pixels make up the outline that tells how parts hang together."""

SIMPLIFIED = 0.7
"""Tolerance of that outline in pixels: what corners of pixels stand out from a slanted edge."""


@dataclass(frozen=True, eq=False)
class GamePuppet:
    """What an engine needs to pose a painting. Places are pixels, y pointing up, 0 below the middle of the canvas."""

    name: str
    place: Placement
    bones: tuple[Bone, ...]
    """Parents first."""
    meshes: tuple[PartMesh, ...]
    """In drawing order, the lowest first."""
    ranges: tuple[JointRange, ...]
    """Of each bone: the angles at which no triangle of any mesh flips, blended as engines do."""
    animations: tuple[Animation, ...] = ()
    notes: tuple[str, ...] = ()
    draft: PuppetDraft | None = field(default=None, repr=False)
    """How its parts hang together; None if it was put together elsewhere."""

    @property
    def puppet(self) -> Puppet:
        """What moves it, whose parts have no fields: their meshes have the weights. Raises NestedCagesError without a
        draft."""
        if self.draft is None:
            raise invalid_setting(f"The puppet {self.name!r} has no draft.")
        return Puppet(replace(self.draft, bones=self.bones), (None,) * len(self.draft.parts), self.ranges, SKIN)

    def posed(self, turned: Mapping[str, float]) -> list[FloatArray]:
        """(n, 2) points of each mesh with bones turned by degrees, counter-clockwise, relative to their parents.

        Raises NestedCagesError for the name of no bone.
        """
        degrees = by_number(self.bones, turned)
        return [skinned(mesh.points, mesh.weights, self.bones, degrees, SKIN) for mesh in self.meshes]


def game_puppet(
    parts: Sequence[PicturePart],
    size: tuple[int, int],
    *,
    name: str = "puppet",
    vertices: int = HULL_VERTICES,
    choices: Mapping[str, PartChoice] | None = None,
) -> GamePuppet:
    """A puppet from the parts of a picture, the lowest first.

    size: width and height of the canvas; vertices: of the largest hull of each part; choices: of `draft_puppet`. Raises
    NestedCagesError.
    """
    if not parts:
        raise invalid_setting("The picture has no visible layer with pixels; show one, or include hidden layers.")
    place = Placement(*size)
    draft = draft_puppet(puppet_parts_of(parts, place), choices)
    return meshed(draft, parts, place, name=name, vertices=vertices)


def puppet_parts_of(parts: Sequence[PicturePart], place: Placement) -> tuple[PuppetPart, ...]:
    """The outlines of painted parts, by which parts find how they hang together, with unique names."""
    return with_unique_names(_puppet_part(part, place) for part in parts)


def _puppet_part(part: PicturePart, place: Placement) -> PuppetPart:
    shapely = load_shapely("A puppet of parts that overlap")
    opaque = part.pixels[..., 3] >= SOLID
    pixels = boundary_of_pixels(opaque if opaque.any() else part.pixels[..., 3] > 0)
    outline = shapely.simplify(shapely.geometry.shape(pixels.__geo_interface__), SIMPLIFIED)
    solid = Mesh.of(outline)
    up = [place.up(ring + np.array([part.left, part.top])) for ring in solid.rings]
    return PuppetPart(part.name, Mesh.from_loops(up), part.groups)


def meshed(
    draft: PuppetDraft, parts: Sequence[PicturePart], place: Placement, *, name: str, vertices: int = HULL_VERTICES
) -> GamePuppet:
    """The puppet of a draft whose parts have these pictures, in the same order, and its meshes: one for each
    island.

    A part gets fewer bones where a joint of its meshes turns too little, as in `puppet_of`. Raises NestedCagesError.
    """
    islands = [islands_of(part.seen, part.left, part.top, vertices) for part in parts]
    hulls = [[place.up(island.loop) for island in own] for own in islands]
    draft, made = bent(draft, lambda draft, part: _fields_of(draft, part, hulls))
    fields = {
        key: replace(field, first_bone=draft.bone_of[part])
        for part, (own, _) in made.items()
        for key, field in own.items()
    }
    meshes: list[PartMesh] = []
    for k, part in enumerate(parts):
        own = draft.parts[k].name
        for number, island in enumerate(islands[k]):
            carrier = fields.get((k, number))
            if carrier is None:
                grid, weights = _stiff(hulls[k][number], draft.bone_of[k], len(draft.bones))
            else:
                grid, weights = carrier.grid, np.zeros((len(carrier.grid.vertices), len(draft.bones)))
                weights[:, carrier.first_bone : carrier.first_bone + len(carrier.bends) + 1] = carrier.weights
            called = own if number == 0 else f"{own}.island{number + 1}"
            meshes.append(_textured(called, part, island, grid, weights, place))
    ranges = proved_ranges(draft.bones, meshes)
    stiff = [draft.parts[part].name for part, (_, turns) in made.items() if all(turn == FREE for turn in turns)]
    notes = (*draft.notes, *(f"{part} is not painted where its bones meet, so it does not bend." for part in stiff))
    return GamePuppet(name, place, draft.bones, tuple(meshes), ranges, (), notes, draft)


def _stiff(loop: FloatArray, bone: int, bones: int) -> tuple[Triangulation, FloatArray]:
    """The mesh of a hull (n, 2) that one bone moves, and its weights."""
    grid = meshed_loop(counter_clockwise(loop))
    weights = np.zeros((len(grid.vertices), bones))
    weights[:, bone] = 1.0
    return grid, weights


def _textured(
    name: str, part: PicturePart, island: Island, grid: Triangulation, weights: FloatArray, place: Placement
) -> PartMesh:
    """A mesh for an island of a part. Raises NestedCagesError unless it holds the island's pixels."""
    hull = len(grid.edge)
    certify(place.down(grid.vertices[:hull]), island.pixels, island.left, island.top)
    shown = island.left, island.top, island.pixels, part.blend, part.is_visible
    return PartMesh(name, part.path, grid.vertices, hull, grid.triangles, weights, *shown)


def _fields_of(
    draft: PuppetDraft, part: int, hulls: Sequence[Sequence[FloatArray]]
) -> tuple[dict[tuple[int, int], BendField], list[JointRange]]:
    """The fields of a part that bends and of what rides on it, by numbers of part and island, and the ranges of its
    joints."""
    bones, kept = limb_of(draft, part)
    limb = limb_in(hulls[part], bones, kept)
    fields, turns = {}, [FREE] * (len(bones) - 1)
    for k in (part, *riders_on(draft, part)):
        for number, hull in enumerate(hulls[k]):
            fields[k, number], own = best_field(hull, limb, bones, draft.bone_of[part])
            turns = [narrower(*both) for both in zip(turns, own, strict=True)]
    return fields, turns
