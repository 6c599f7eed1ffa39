"""The bones within one part: a tree. A limb has a chain, a long body one both ways from its hips, trousers a fork."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import BoolArray, FloatArray
from ...geometry.vectors import norm


@dataclass(frozen=True, eq=False)
class BoneTree:
    """Bones of a part; those that carry others come first."""

    heads: FloatArray
    """(B, 2)."""
    tails: FloatArray
    """(B, 2)."""
    parents: tuple[int, ...]
    """Of each bone in the part, -1 for the first one."""

    @classmethod
    def chain(cls, places: FloatArray) -> BoneTree:
        """A chain from its places (B + 1, 2): the heads, and the tip of the last one."""
        return cls(places[:-1], places[1:], tuple(range(-1, len(places) - 2)))

    @classmethod
    def of(cls, parents: tuple[int, ...]) -> BoneTree:
        """A tree without places."""
        nowhere = np.zeros((len(parents), 2))
        return cls(nowhere, nowhere, parents)

    def with_chain(self, places: FloatArray) -> BoneTree:
        """The tree with a chain on its first bone."""
        more = BoneTree.chain(places)
        parents = tuple(0 if parent < 0 else parent + len(self) for parent in more.parents)
        heads, tails = (np.concatenate(both) for both in ((self.heads, more.heads), (self.tails, more.tails)))
        return BoneTree(heads, tails, self.parents + parents)

    def __len__(self) -> int:
        return len(self.parents)

    @cached_property
    def beyond(self) -> BoolArray:
        """(B, B) whether the bone of a row is that of the column or hangs on it."""
        found = np.eye(len(self), dtype=bool)
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                found[bone] |= found[parent]
        return found

    def before(self, bone: int) -> FloatArray:
        """(2,) the end of the parent away from a bone's joint."""
        parent, joint = self.parents[bone], self.heads[bone]
        ends = self.heads[parent], self.tails[parent]
        return max(ends, key=lambda end: float(norm(end - joint)))

    def is_last(self, bone: int) -> bool:
        """Whether no bone of the part hangs on one."""
        return bone not in self.parents

    def nearest(self, place: FloatArray) -> int:
        """The bone nearest to a place."""
        along = self.tails - self.heads
        part = np.clip(((place - self.heads) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
        return int(norm(self.heads + part[:, None] * along - place).argmin())

    def weights(self, shares: FloatArray) -> FloatArray:
        """(N, B) weights from how much points follow each bone but the first, with all beyond it (N, B - 1)."""
        whole = np.concatenate((np.ones((len(shares), 1)), shares), axis=1)
        found = whole.copy()
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                found[:, parent] -= whole[:, bone]
        return found

    def shares(self, weights: FloatArray) -> FloatArray:
        """(N, B - 1) the reverse of `weights`."""
        return np.asarray(weights @ self.beyond)[:, 1:]
