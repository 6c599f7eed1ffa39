"""What a Grease Pencil object of Blender 4.3 and later paints on the current frame: the fills, with their holes, and
the strokes, with their width, of the layers that show.

Before Blender 5.2 the material says whether fill and stroke show. Since then each stroke does, and strokes with the
same number of a fill are its outline and its holes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bpy.types import Context, Object
from mathutils import Vector

from ..core import core
from ..errors import FloatArray, UserError, counted
from .edge_loops import SMALLEST_LOOP
from .plane import PLANARITY, Frame, fitted_frame, own_frame, size, transform, world_matrix
from .strokes import Curves, covering

# Types of objects of Blender 4.3 and later, and of the kind before.
KINDS = ("GREASEPENCIL", "GPENCIL")
# Opacity below which Blender does not draw.
LEAST_OPACITY = 1e-3
# Distance between layers that become objects, as a fraction of the drawing's size.
LAYER_DEPTH = 1e-3
# Radius of the circle around a dot that is a square, in radii of the dot.
SQUARE = 2.0**0.5


@dataclass(frozen=True)
class Stroke:
    """Points (k, 3) along a stroke in its object's space, radii (k,) in the world, and angles of sharp corners (k,).

    ``fill`` and ``line``: 1 if it paints, -1 if it erases what its layer has painted before, else 0. ``group``: of the
    strokes that are one fill.
    """

    points: FloatArray
    radii: FloatArray
    corners: FloatArray
    cyclic: bool
    group: int
    fill: int
    line: int


@dataclass(frozen=True)
class Layer:
    """A layer's strokes, from the lowest up. ``masks``: names of layers and whether they hide what they cover."""

    name: str
    strokes: tuple[Stroke, ...]
    hidden: bool
    opacity: float
    masks: tuple[tuple[str, bool], ...]

    @property
    def shown(self) -> tuple[Stroke, ...]:
        """The strokes that show."""
        if self.hidden or self.opacity <= LEAST_OPACITY:
            return ()
        return tuple(stroke for stroke in self.strokes if stroke.fill > 0 or stroke.line > 0)


@dataclass(frozen=True)
class Counts:
    """What counts, apart from fills and lines with their width. `closed`: the inside of closed lines, those in others
    as holes if `nested`; `opened`: that of open lines.
    """

    closed: bool = False
    nested: bool = False
    opened: bool = False

    def key(self, number: int, stroke: Stroke) -> tuple[int, int] | None:
        """What strokes whose insides are one area have in common, first their effect; None if the inside is none."""
        if stroke.fill:
            return stroke.fill, stroke.group
        if stroke.line > 0 and (self.closed if stroke.cyclic else self.opened):
            return 1, -1 if self.nested else -2 - number
        return None


@dataclass(frozen=True)
class Painting:
    """The layers of an object, from the lowest up, and its matrix (4, 4)."""

    name: str
    matrix: FloatArray
    layers: tuple[Layer, ...]

    @classmethod
    def of(cls, context: Context, obj: Object) -> Painting:
        """What an object paints with its modifiers. Raises: UserError for the kind before Blender 4.3."""
        if obj.type != KINDS[0]:
            raise UserError(f"'{obj.name}' is a Grease Pencil of the kind before Blender 4.3: open the file there")
        evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
        layers = tuple(_layer(evaluated, layer) for layer in evaluated.data.layers)
        return cls(obj.name, world_matrix(obj), layers)

    @property
    def parts(self) -> list[Layer]:
        """The layers that show something. Raises: UserError without any."""
        found = [layer for layer in self.layers if layer.shown]
        if not found:
            raise UserError(f"'{self.name}' paints nothing on this frame: show a layer with fills or strokes")
        return found

    def left_out(self) -> str:
        """How many layers and strokes do not show; empty if all do."""
        layers = sum(bool(layer.strokes) and not layer.shown for layer in self.layers)
        strokes = sum(len(layer.strokes) - len(layer.shown) for layer in self.layers if layer.shown)
        strokes -= sum(s.fill < 0 or s.line < 0 for layer in self.layers if layer.shown for s in layer.strokes)
        return " and ".join(counted(n, noun) for n, noun in ((layers, "layer"), (strokes, "stroke")) if n > 0)

    def frame(self) -> Frame:
        """The frame of the layer with the most points; straight strokes stand upright. Raises: UserError."""
        points = max((_points(layer) for layer in self.parts), key=len)
        middle, reach = points.mean(axis=0), float(np.ptp(points, axis=0).max())
        spread, directions = np.linalg.svd(points - middle, full_matrices=False)[1:]
        if not spread[1:2].sum() > PLANARITY * spread[0]:  # a dot, or straight
            upright = np.eye(3)[[2, 0]]
            added = upright if not reach else upright[[np.argmin(np.round(np.abs(upright @ directions[0]), 3))]]
            reach = reach or 1.0
            points = np.concatenate([points, middle + reach * added, middle - reach * added])
        return own_frame(self.matrix, points) or fitted_frame(self.matrix, points)

    def thickness(self, frame: Frame) -> float:
        """Largest world distance of a point from its layer's plane, which is parallel to that of a frame."""
        heights = [frame.from_world(transform(self.matrix, _points(layer)))[1] for layer in self.parts]
        return max(float(np.abs(height - np.median(height)).max()) for height in heights)

    def areas(self, frame: Frame, counts: Counts) -> list[core.formats.Painted]:
        """What shows, seen in a frame, as float32 values. Raises: UserError if nothing does."""
        extent = size(self._seen(frame, np.concatenate([_points(layer) for layer in self.parts])))
        named = {layer.name: layer for layer in self.layers}
        found: list[core.formats.Painted] = []
        for layer in self.parts:
            shown = self._painted(layer, frame, counts, extent)
            masks = [(named[name], hides) for name, hides in layer.masks if name in named and not named[name].hidden]
            inside: list[core.formats.Painted] = []
            for mask, hides in masks:
                covered = self._painted(mask, frame, counts, extent)
                if hides:
                    shown = core.formats.clipped(shown, covered, inside=False)
                else:
                    inside += covered
            if not all(hides for _, hides in masks):
                shown = core.formats.clipped(shown, inside, inside=True)
            found += shown
        return found

    def _painted(self, layer: Layer, frame: Frame, counts: Counts, extent: float) -> list[core.formats.Painted]:
        """What a layer paints without its masks."""
        areas: list[core.formats.Painted] = []
        for effect, added in self._steps(layer.strokes, frame, counts, extent):
            areas = [*areas, *added] if effect > 0 else core.formats.clipped(areas, added, inside=False)
        return areas

    def _steps(
        self, strokes: Sequence[Stroke], frame: Frame, counts: Counts, extent: float
    ) -> Iterator[tuple[int, list[core.formats.Painted]]]:
        """Fills and lines from the lowest up, and whether they paint or erase."""
        loops = [self._seen(frame, stroke.points) for stroke in strokes]
        keys = [counts.key(number, stroke) for number, stroke in enumerate(strokes)]
        groups: dict[tuple[int, int], list[FloatArray]] = {}
        for key, loop in zip(keys, loops, strict=True):
            if key is not None and len(loop) >= SMALLEST_LOOP:
                groups.setdefault(key, []).append(loop)
        for stroke, key, loop in zip(strokes, keys, loops, strict=True):
            outline = groups.pop(key, []) if key is not None else []
            if key is not None and outline:  # Blender fills all that one stroke winds around
                yield key[0], [core.formats.Painted(outline, evenodd=len(outline) > 1)]
            if stroke.line and stroke.radii.max() > 0.0:
                ends = np.arange(len(loop) + 2 * stroke.cyclic) % len(loop)
                shapes = covering(loop[ends], stroke.radii[ends] / frame.scale, stroke.corners[ends], extent)
                yield stroke.line, [core.formats.Painted([shape]) for shape in shapes]

    def _seen(self, frame: Frame, points: FloatArray) -> FloatArray:
        """Points (n, 3) of the object in a frame, (n, 2), as float32 values."""
        own = frame.own and np.array_equal(frame.matrix, self.matrix)  # without round-off
        seen = points[:, :2] if own else frame.from_world(transform(self.matrix, points))[0]
        return seen.astype(np.float32).astype(np.float64)


def hidden_parts(context: Context, objects: Sequence[Object]) -> Iterator[dict[str, str]]:
    """What the Grease Pencil objects among some do not show, each as the data of a note."""
    for obj in objects:
        hidden = Painting.of(context, obj).left_out() if obj.type == KINDS[0] else ""
        if hidden:
            yield {"name": obj.name, "hidden": hidden}


def separated(context: Context, obj: Object) -> list[Object]:
    """New objects, each with one of an object's layers that show something, all its frames and its masks."""
    made = []
    for layer in Painting.of(context, obj).parts:
        copy, data = obj.copy(), obj.data.copy()
        copy.name, copy.data = f"{obj.name} {layer.name}", data
        layers: Any = data.layers
        masks = {name for name, _ in layer.masks} - {layer.name}
        for other in list(layers):
            if other.name in masks:
                other.opacity = 0.0  # masks that do not show still hide what they cover
            elif other.name != layer.name:
                layers.remove(other)
        for home in obj.users_collection:
            home.objects.link(copy)
        made.append(copy)
    return made


def stacked(context: Context, obj: Object) -> list[Object]:
    """The same, named after the layers and each in front of the one below; empty if no more than one shows."""
    if obj.type != KINDS[0]:
        return []
    painting = Painting.of(context, obj)
    layers = painting.parts
    if len(layers) < 2:
        return []
    normal = Vector(painting.frame().matrix[:3, 2].tolist()).normalized()
    above = obj.matrix_world @ obj.matrix_basis.inverted_safe()
    step = LAYER_DEPTH * float(obj.dimensions.length) * (above.inverted_safe().to_3x3() @ normal)
    made = separated(context, obj)
    for number, (copy, layer) in enumerate(zip(made, layers, strict=True)):
        copy.name = copy.data.name = layer.name
        copy.delta_location += number * step
    context.view_layer.update()
    return made


def matrix_of(obj: Object, layer: Any) -> FloatArray:
    """The matrix (4, 4) from a layer's space to that of its object."""
    local, parent = np.array(layer.matrix_local, dtype=np.float64), layer.parent
    if parent is None:
        return local
    carried = np.array(parent.matrix_world, dtype=np.float64)
    bone = parent.pose.bones.get(layer.parent_bone) if parent.pose is not None else None
    if bone is not None:
        carried = carried @ np.array(bone.matrix)
    return np.asarray(np.linalg.pinv(world_matrix(obj)) @ carried @ np.array(layer.matrix_parent_inverse) @ local)


def _points(layer: Layer) -> FloatArray:
    """All points (n, 3) of the strokes of a layer that show."""
    return np.concatenate([stroke.points for stroke in layer.shown])


def _layer(obj: Object, layer: Any) -> Layer:
    frame, group = layer.current_frame(), layer.parent_group
    while group is not None and not group.hide:
        group = group.parent_group
    drawing = frame.drawing if frame is not None else None
    empty = drawing is None or not len(drawing.strokes)
    masks = [(mask.name, mask.invert) for mask in layer.mask_layers if not mask.hide] if layer.use_masks else []
    drawn = () if empty else tuple(_strokes(obj, drawing, matrix_of(obj, layer)))
    return Layer(layer.name, drawn, layer.hide or group is not None, layer.opacity, tuple(masks))


def _strokes(obj: Object, drawing: Any, matrix: FloatArray) -> Iterator[Stroke]:
    curves, slots = Curves(drawing), obj.material_slots
    per_stroke = hasattr(drawing.strokes[0], "fill_id")
    scale = abs(float(np.linalg.det(world_matrix(obj)[:3, :3]))) ** (1.0 / 3.0)  # layers do not scale it
    fills, lines = curves.each("fill_id", 0, np.int32), curves.each("hide_stroke", False, np.bool_)
    opacities = curves.each("fill_opacity", 1.0)
    for number, index in enumerate(curves.each("material_index", 0, np.int32)):
        material = slots[index].material if 0 <= index < len(slots) else None
        style = material.grease_pencil if material is not None else None
        points, radii, opacity, corners = curves.evaluated(number)
        if not len(points):
            continue
        seen = opacity > LEAST_OPACITY
        seen[1:] |= seen[:-1].copy()
        filled, lined = fills[number] > 0, not lines[number]
        if not per_stroke:
            filled, lined = style is not None and style.show_fill, style is None or style.show_stroke
        square = SQUARE if style is not None and style.mode == "BOX" else 1.0
        yield Stroke(
            transform(matrix, points),
            scale * square * np.where(seen, np.maximum(radii, 0.0), 0.0),
            corners,
            bool(curves.cyclic[number]),
            int(fills[number]) if per_stroke else number,
            _effect(style, "fill", filled, opacities[number]),
            _effect(style, "stroke", lined, opacity.max()),
        )


def _effect(style: Any, kind: str, shown: bool, opacity: float) -> int:
    """1 if the fills or strokes of a style paint, -1 if they erase, 0 if they do not show."""
    if style is None:
        return int(shown and opacity > LEAST_OPACITY)
    if getattr(style, f"{kind}_style") == "SOLID":
        opacity *= (style.fill_color if kind == "fill" else style.color)[3]
    if style.hide or not shown or opacity <= LEAST_OPACITY:
        return 0
    if getattr(style, f"use_{kind}_holdout"):
        return -int(opacity > 1.0 - LEAST_OPACITY)
    return 1
