"""Outlines of images: no opaque pixel is outside."""

import bpy
import numpy as np
import pytest
import shapely

from support.blender import refused
from support.drawings import image_empty, solid

SIDE = 40


def sprite(name="Sprite"):
    """An image (H, W) with a ragged opaque ring, and its opacity with the bottom row first."""
    y, x = np.mgrid[:SIDE, : 2 * SIDE] + 0.5
    angle = np.arctan2(y - 15.0, x - 30.0)
    distance = np.hypot(x - 30.0, y - 15.0)
    opaque = (distance < 12.0 + 2.0 * np.cos(5.0 * angle)) & (distance > 5.0)
    image = bpy.data.images.new(name, 2 * SIDE, SIDE, alpha=True)
    pixels = np.ones((SIDE, 2 * SIDE, 4), np.float32)
    pixels[..., 3] = opaque
    image.pixels.foreach_set(pixels.ravel())
    return image, opaque


@pytest.mark.parametrize(("holes", "padding"), [(False, 0.0), (True, 0.5)])
def test_no_opaque_pixel_is_outside(holes, padding) -> None:
    image, opaque = sprite()
    empty = image_empty(image)
    empty.empty_display_size = 4.0
    empty.location, empty.rotation_euler, empty.scale = (3.0, 1.0, 0.0), (0.4, 0.3, 0.2), (1.0, 2.0, 1.0)
    done = bpy.ops.object.nested_cages_import(outlines="SELECTED", vertices=16, padding=padding, holes=holes)
    assert done == {"FINISHED"}
    made = bpy.context.active_object
    bpy.context.view_layer.update()
    there = np.array(empty.matrix_world.inverted() @ made.matrix_world)
    area = shapely.transform(solid(made), lambda xy: xy @ there[:2, :2].T + there[:2, 3])
    assert len(made.data.vertices) == 16 and np.abs(there[2]).max() == pytest.approx(1.0)
    assert len(getattr(area, "interiors", ())) == int(holes)
    pixel = 4.0 / (2 * SIDE)
    rows, columns = np.nonzero(opaque)
    low = np.column_stack([columns, rows]) * pixel + (-2.0, -1.0)
    boxes = shapely.box(*low.T, *(low + pixel).T)
    assert shapely.covers(area.buffer(1e-5), boxes).all()
    if padding:
        assert shapely.distance(area.boundary, boxes).min() >= 0.99 * padding * pixel


def test_images_without_anything_to_outline_are_refused() -> None:
    image = bpy.data.images.new("Clear", 8, 8, alpha=True)
    image.pixels.foreach_set(np.zeros(8 * 8 * 4, np.float32))
    image_empty(image)
    with refused("'Clear'"):
        bpy.ops.object.nested_cages_import(outlines="SELECTED")


def test_picture_files_become_upright_outlines(tmp_path) -> None:
    image, opaque = sprite("fish.png")
    image.filepath_raw, image.file_format = str(tmp_path / "fish.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    bpy.ops.object.nested_cages_import(filepath=str(tmp_path / "fish.png"), outlines="ONE", vertices=12, padding=0.0)
    (made,) = bpy.context.selected_objects
    assert len(made.data.vertices) == 12 and made.matrix_world.to_euler().x == pytest.approx(np.pi / 2)
    assert solid(made).area * 1e4 > opaque.sum()  # a hundred pixels to a unit
