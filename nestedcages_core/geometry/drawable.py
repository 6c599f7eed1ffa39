"""Results that show themselves."""

from __future__ import annotations

from typing import Any


class Drawable:
    """A result that notebooks show, that plots itself, and that every writer of files takes."""

    @property
    def meshes(self) -> tuple[Any, ...]:
        """The drawing and its cages, from the finest to the coarsest."""
        raise NotImplementedError

    @property
    def frames(self) -> tuple[tuple[Any, ...], ...]:
        """The meshes of each frame of a picture; frames stand side by side."""
        return (self.meshes,)

    def _repr_svg_(self) -> str:
        """The picture that a notebook shows, with y pointing up."""
        from .picture import svg_picture

        return svg_picture(self.frames)

    def plot(self, ax: Any = None) -> Any:
        """Draw the meshes with matplotlib, and return the axes; ``ax``: the axes to draw on, by default new ones.

        Raises NestedCagesError if matplotlib is missing.
        """
        from .picture import plotted

        return plotted(self.meshes, ax)
