"""Objects whose transforms are not numbers, or scale them to nothing: a sentence, and the scene as it was."""

from __future__ import annotations

import bpy
import pytest

from support.drawings import poly_curve, snapshot, star, text
from support.marks import slow_after

KINDS = {
    "curve": lambda: poly_curve("Drawing", [star()]),
    "text": lambda: text("Drawing", "ab"),
}
VALUES = [0.0, float("nan"), float("inf"), 1e38]
OPERATORS = ["generate", "verify", "bind", "silhouette", "live", "remove_animation"]


def call(name: str) -> str:
    """What an operator says, empty if it works or is not available; never a traceback."""
    operator = getattr(bpy.ops.object, f"nested_cages_{name}")
    if operator.poll():
        try:
            operator()
        except RuntimeError as error:
            assert "Python" not in str(error), error
            return str(error)
    return ""


@pytest.mark.parametrize("value", slow_after(0, VALUES, thorough_after=2))
@pytest.mark.parametrize("name", ["location", "rotation_euler", "scale"])
@pytest.mark.parametrize("kind", KINDS)
def test_transforms_that_are_no_numbers(kind: str, name: str, value: float) -> None:
    drawing = KINDS[kind]()
    getattr(drawing, name)[0] = value
    bpy.context.view_layer.update()
    before = repr(snapshot())
    for operator in OPERATORS:
        refused = call(operator)
        bpy.context.view_layer.update()  # what is hidden on this frame is
        if refused:
            assert repr(snapshot()) == before
        before = repr(snapshot())


@pytest.mark.parametrize("which", ["Drawing", "Drawing Cage 1"])
@pytest.mark.parametrize("value", slow_after(0, VALUES, thorough_after=2))
@pytest.mark.parametrize("name", ["location", "scale"])
def test_outputs_whose_transforms_are_no_numbers(which: str, name: str, value: float) -> None:
    poly_curve("Drawing", [star()])
    bpy.ops.object.nested_cages_generate(levels="12")
    getattr(bpy.data.objects[which], name)[0] = value
    bpy.context.view_layer.update()
    for operator in ("verify", "bind", "add_handles", "rebind", "unbind", "live", "generate"):
        call(operator)


def test_a_text_without_height_keeps_its_cages_where_it_is() -> None:
    """Flat texts are often scaled to nothing along z."""
    drawing = text("Drawing", "o")
    drawing.scale.z = 0.0
    drawing.location.x = 5.0
    bpy.context.view_layer.update()
    assert not call("generate")
    bpy.context.view_layer.update()
    cage = next(obj for obj in bpy.data.objects if "Cage" in obj.name)
    assert cage.matrix_world.translation.x > 4.9
    assert not call("verify")
