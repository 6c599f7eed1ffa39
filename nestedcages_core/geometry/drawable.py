"""Results that show themselves."""

from __future__ import annotations

from typing import Any, ClassVar


class Drawable:
    """A result that notebooks show, that plots itself, and that every writer of files takes."""

    formats: ClassVar[Any]
    """Imports a module of `formats` by its name. The package sets it: formats know meshes, which know no format."""

    @property
    def meshes(self) -> tuple[Any, ...]:
        """The drawing and its cages, from the finest to the coarsest."""
        raise NotImplementedError

    @property
    def frames(self) -> tuple[tuple[Any, ...], ...]:
        """The meshes of each frame of a picture; frames are next to each other."""
        return (self.meshes,)

    def _repr_svg_(self) -> str:
        """The picture that a notebook shows, with y pointing up."""
        picture: str = self.formats("figures").svg_picture(self.frames)
        return picture

    def plot(self, ax: Any = None) -> Any:
        """Draw the meshes with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            The axes to draw on. Default: new ones.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        NestedCagesError
            If matplotlib is missing.
        """
        return self.formats("figures").plotted(self.meshes, ax)
