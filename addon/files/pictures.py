"""Pictures in the scene and in files: where they lie, their outlines, and flat meshes that show them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Context, Mesh, Object
from mathutils import Matrix
from numpy.typing import NDArray

from .. import keys
from ..blender import display, mesh_data
from ..blender.jobs import Progress, Work, mapped
from ..blender.views import FRONT
from ..cage_sets import selection
from ..cage_sets.selection import scene_of
from ..core import blamed, core, pictures, runs, triangulation
from ..drawing.planar import Drawing
from ..drawing.plane import PLANARITY, Frame, world_matrix
from ..errors import FloatArray, UserError
from ..generate.run import STAGES
from ..memory import key_of, known, remember
from .importers import PIXEL

# Triangles along the longer side of a picture, which let it bend smoothly.
CELLS = 24
# Distance between pictures that are laid out in a row, as a fraction of their mean width.
GAP = 0.1


@dataclass(frozen=True)
class Canvas:
    """Where a picture lies in the world: its lower left corner, its width and its height, (3,) each."""

    corner: FloatArray
    width: FloatArray
    height: FloatArray

    def frame(self) -> Frame:
        """A frame of unit scale in the middle of the picture. Raises: UserError if the picture is sheared."""
        x, y = (side / np.linalg.norm(side) for side in (self.width, self.height))
        if abs(float(x @ y)) > PLANARITY:
            raise UserError("The picture is sheared: apply the scale of its object and its parents, or use a new one")
        return replace(Frame.through(self.corner + 0.5 * (self.width + self.height), x, y), own=True)

    def placed(self, parts: FloatArray) -> FloatArray:
        """Points (n, 2), as fractions of the picture's width and height, in the frame, rounded to float32."""
        sides = np.array([np.linalg.norm(self.width), np.linalg.norm(self.height)])
        return ((parts - 0.5) * sides).astype(np.float32).astype(np.float64)


def load(path: Path) -> bpy.types.Image:
    """The image of a file, reused if it is already loaded. Raises: UserError."""
    if not path.exists():
        raise UserError(f"There is no file '{path}'")
    try:
        return bpy.data.images.load(str(path), check_existing=True)
    except RuntimeError as error:
        raise UserError(f"'{path.name}' cannot be read as an image") from error


def image_of_pixels(name: str, pixels: NDArray[Any]) -> bpy.types.Image:
    """A new image that the file holds, of sRGB and opacity (h, w, 4) from 0 to 1, the bottom row first."""
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())  # type: ignore[attr-defined]  # a number in the stubs
    image.update()
    image.pack()
    return image


def size_of(image: bpy.types.Image) -> tuple[int, int]:
    """Width and height in pixels. Raises: UserError if there are none."""
    width, height = image.size
    if not width or not height:
        raise UserError(f"The image '{image.name}' has no pixels: its file may be missing")
    return width, height


def image_on(obj: Object | None) -> bpy.types.Image | None:
    """The image of an image empty, or on the active material of a mesh; a gradient is none."""
    if obj is None:
        return None
    if obj.type == "EMPTY":
        return obj.data if isinstance(obj.data, bpy.types.Image) else None
    shown = [node.image for node in pictures_in(obj.active_material)] if obj.type == "MESH" else []
    return next((image for image in shown if image is not None and not is_gradient(image)), None)


def is_gradient(image: bpy.types.Image | None) -> bool:
    """Whether an image is the gradient of a shape."""
    return image is not None and bool(image.get(keys.GRADIENT))


def pictures_in(material: bpy.types.Material | None) -> list[Any]:
    """The nodes of a material for images."""
    nodes: Any = material.node_tree.nodes if material is not None and material.node_tree is not None else ()
    return [node for node in nodes if node.bl_idname == "ShaderNodeTexImage"]


def canvas_of(obj: Object, size: tuple[int, int]) -> Canvas:
    """The place where an object shows a picture of that size in pixels. Raises: UserError."""
    matrix = world_matrix(obj)
    if obj.type == "MESH":
        return _on_faces(obj, matrix)
    extent = np.array(size) / max(size) * obj.empty_display_size
    corner, axes = np.array(obj.empty_image_offset) * extent, matrix[:3, :3]
    return Canvas(
        matrix[:3, 3] + axes[:, 0] * corner[0] + axes[:, 1] * corner[1], axes[:, 0] * extent[0], axes[:, 1] * extent[1]
    )


@dataclass(frozen=True)
class Part:
    """A picture, where it lies, and the object that shows it, if one does."""

    image: bpy.types.Image
    canvas: Canvas
    shown_by: Object | None = None

    def place(self, context: Context, name: str, data: Mesh) -> Object:
        """A new object with a mesh in the canvas's frame, in the collection of the object that shows the picture."""
        obj = bpy.data.objects.new(name, data)
        home = selection.home_of(scene_of(context), self.shown_by) if self.shown_by is not None else context.collection
        home.objects.link(obj)
        obj.matrix_world = Matrix(self.canvas.frame().matrix.tolist())
        return obj


def from_files(paths: Sequence[Path], axes: FloatArray = FRONT, unit: float = PIXEL) -> list[Part]:
    """The pictures in files, in a row from left to right, centred at the origin. Raises: UserError.

    axes: directions of the row and upwards, (2, 3); unit: metres per pixel.
    """
    images = [load(path) for path in paths]
    sides = unit * np.array(list(map(size_of, images)), dtype=np.float64)
    steps = sides[:, 0] + GAP * sides[:, 0].mean()
    left = np.cumsum(steps) - steps
    left -= 0.5 * (left[-1] + sides[-1, 0])
    return [
        Part(image, Canvas(x * axes[0] - 0.5 * height * axes[1], width * axes[0], height * axes[1]))
        for image, x, (width, height) in zip(images, left, sides, strict=True)
    ]


def on_objects(objects: Sequence[Object]) -> list[Part]:
    """The pictures that objects show. Raises: UserError."""
    shown = [(obj, image) for obj in objects if (image := image_on(obj)) is not None]
    return [Part(image, canvas_of(obj, size_of(image)), obj) for obj, image in shown]


def _on_faces(obj: Object, matrix: FloatArray) -> Canvas:
    """The canvas of a flat mesh by its texture coordinates. Raises: UserError."""
    mesh = mesh_data.mesh_of(obj)
    uv = mesh_data.texture_places(mesh)
    if uv is None:
        raise UserError(f"'{obj.name}' has no texture coordinates, so where its picture lies is not known")
    points = mesh_data.points_of(mesh)[mesh_data.corner_vertices(mesh)]
    parts = np.column_stack([uv, np.ones(len(uv))]).astype(np.float64)
    affine, _, rank, _ = np.linalg.lstsq(parts, points, rcond=None)
    if rank < 3 or np.abs(parts @ affine - points).max() > PLANARITY * np.ptp(points, axis=0).max():
        raise UserError(f"'{obj.name}' is not a flat picture: its texture coordinates do not fit one plane")
    axes = matrix[:3, :3]
    return Canvas(matrix[:3, 3] + axes @ affine[2], axes @ affine[0], axes @ affine[1])


def textured_mesh(name: str, outline: core.Mesh, canvas: Canvas, image: bpy.types.Image) -> Mesh:
    """A new mesh in the outline, in the canvas's frame, that shows the picture."""
    spacing = float(np.ptp(outline.vertices, axis=0).max()) / CELLS
    inside = triangulation.triangulate(outline, triangulation.Sampling(spacing))
    points = inside.vertices
    data = mesh_data.new_mesh(name, points, faces=inside.triangles)
    sides = np.array([np.linalg.norm(canvas.width), np.linalg.norm(canvas.height)])
    mesh_data.place_texture(data, points / sides + 0.5)
    # One material per image and file shows it without lighting, with its transparency.
    material = bpy.data.materials.get(f"{image.name} Cutout")
    if material is None or all(node.image != image for node in pictures_in(material)):
        material = display.material(display.CUTOUT, f"{image.name} Cutout")
        picture: Any = material.node_tree.nodes["Image Texture"]
        picture.image = image
    data.materials.append(material)
    return data


def opacity_of(image: bpy.types.Image) -> NDArray[np.float32]:
    """The opacity (h, w) of an image, the top row first. Raises: UserError if it has none."""
    width, height = size_of(image)
    if image.channels not in (2, 4):
        raise UserError(f"The image '{image.name}' has no alpha channel: save it as RGBA, or choose another image")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)  # type: ignore[attr-defined]  # a number in the stubs
    return pixels.reshape(height, width, image.channels)[::-1, :, -1]


def traced(part: Part, vertices: int, *, tile: bool, **options: Any) -> Work[Drawing]:
    """The outline of the opaque pixels of a picture, in the frame of its canvas. Raises: UserError.

    tile: whether a picture that is opaque as a whole gets its own edge, without padding. options: padding, threshold
    and holes of ``picture_cages``.
    """
    alpha, frame = opacity_of(part.image), part.canvas.frame()
    height, width = alpha.shape
    if tile and bool((alpha > options["threshold"]).all()):
        outline = core.Mesh.from_loops([[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]])
    else:
        outline = yield from _around(part.image.name, alpha, vertices, options)
    points = part.canvas.placed(np.asarray(outline.vertices) / (width, height))
    name = Path(part.image.name).stem or part.image.name
    drawing = Drawing(name, frame, tuple(points[loop] for loop in outline.loops))
    drawing.mesh()
    return drawing


def _around(name: str, alpha: NDArray[np.float32], vertices: int, options: dict[str, Any]) -> Work[core.Mesh]:
    """A mesh around all opaque pixels, in pixels with y upwards from the bottom. Raises: UserError."""
    key = key_of("picture", alpha, vertices, tuple(sorted(options.items())))
    outline: core.Mesh | None = known(key)
    if outline is not None:
        return outline

    def work(report: Callable[[core.Progress], None]) -> core.Hierarchy:
        return pictures.picture_cages(alpha, [vertices], progress=report, **options)

    yield Progress(0.0, f"'{name}': tracing pixels")
    with blamed(f"'{name}'"):
        made = yield from mapped(
            runs.Run(work), lambda step: Progress(step.fraction, f"'{name}': {STAGES[step.stage]}")
        )
        cage = made.cages[0]
        outline = core.Mesh(cage.vertices * (1.0, -1.0) + (0.0, len(alpha)), cage.edges)
    remember(key, outline, cage.vertices.nbytes)
    return outline


def place_outline(context: Context, part: Part, drawing: Drawing) -> Object:
    """A new object with the outline of a picture as a wire, where the picture lies."""
    mesh, name = drawing.mesh(), f"{drawing.name} Outline"
    obj = part.place(context, name, mesh_data.new_mesh(name, mesh.vertices, mesh.edges))
    display.apply_display(obj, 1)
    return obj
