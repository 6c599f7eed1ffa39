"""Runs: the work of `nested_cages` as iterators over its progress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

from ..geometry.mesh import MeshLike
from ..run import Run
from .nested_cages import making
from .progress import Progress
from .report import Hierarchy
from .settings import Settings
from .targets import Wanted

if TYPE_CHECKING:
    from .keywords import SettingsKeywords


class NestedCagesRun(Run[Progress, Hierarchy]):
    """The work of :func:`nested_cages` as an iterator over its progress; dropping it cancels the work."""

    side = 1
    """1 for cages around the mesh, -1 for cages inside it."""

    def __init__(
        self,
        fine: MeshLike,
        levels: Wanted | Sequence[Wanted],
        settings: Settings | None = None,
        **options: Unpack[SettingsKeywords],
    ) -> None:
        super().__init__(making(fine, levels, self.side, settings, **options))

    @property
    def hierarchy(self) -> Hierarchy:
        """The result; RuntimeError before the run is over."""
        return self.result


class InnerCagesRun(NestedCagesRun):
    """The work of :func:`inner_cages` as an iterator over its progress; dropping it cancels the work."""

    side = -1
