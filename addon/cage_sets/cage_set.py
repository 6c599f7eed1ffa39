"""A set of cages: a chain of objects from the fine mesh to the coarsest cage, each of which points at what it encloses
and at what encloses it. Drawings and the set's record, which the finest cage carries, point at each other.

Blender makes the pointers of copies refer to what was copied with them, and else to the originals, so only what is
mutual counts: the rest belongs to the set that was copied. The record is on the finest cage and not on the coarsest:
it stays where it is when the number of levels changes, and the fine mesh, which is hidden, is not copied.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import bpy
from bpy.types import Object

from .certificates import CAGE, Certificate

if TYPE_CHECKING:
    Cages = Sequence[Object]
else:
    Cages = Sequence

# What an object is in a chain; cages: see `CAGE`.
FINE = "FINE"
# Types of objects that can move a cage.
MOVERS = ("ARMATURE", "EMPTY")


def node_of(obj: Object) -> Any:
    """What an object is in its set. To read a group of properties of Blender's writes one, so others get no own."""
    return new_node(obj) if has_node(obj) else NO_NODE


def has_node(obj: Object) -> bool:
    """Whether an object is or was in a set, as a member, helper or drawing; buttons look no further if it was not."""
    return bool(obj.is_property_set("nested_cages_member"))


def new_node(obj: Object) -> Any:
    """The same as `node_of`, to take an object into a set."""
    return obj.nested_cages_member  # type: ignore[attr-defined]


def _unset(**values: Any) -> Any:
    """A group of properties that cannot be changed."""
    return namedtuple("Unset", values)(**values)


# What is read of an object without a set.
NO_RECORD = _unset(
    parts=(), marker="", marker_frame=0, title="", bound="", kinds="", inside=False, playing=False, known=False,
    moving=False, animated=False, frames=(0, 0, 0), colours=-1, settings=None, drawn="",
)  # fmt: skip
NO_NODE = _unset(
    role="NONE", inner=None, outer=None, sets=(), record=NO_RECORD, helpers=(), shows=None, thickness=0.0, parts=(),
    before=_unset(mesh=None), stamp="", notes=(), check="NONE",
)  # fmt: skip


def objects_in(items: Any) -> list[Object]:
    """The objects of a list of references."""
    return [item.object for item in items if item.object is not None]


def refer(items: Any, objects: Iterable[Object]) -> None:
    """Adds objects to a list of references that are not in it."""
    known = objects_in(items)
    for obj in objects:
        if obj not in known:
            items.add().object = obj


def drop(items: Any, gone: Sequence[Object]) -> None:
    """Removes objects from a list of references, and what no longer refers to one."""
    for number in reversed([k for k, item in enumerate(items) if item.object is None or item.object in gone]):
        items.remove(number)


def exists(obj: Object | None) -> bool:
    """Whether an object is in a collection or a view: deleted ones may still be referred to."""
    if obj is None or obj.visible_get() or obj.hide_get():
        return obj is not None
    # Blender knows at once whether a view shows an object, but goes through all of a collection to find one.
    if obj.session_uid not in _in_collections:
        _in_collections[obj.session_uid] = bool(obj.users_collection)
    return _in_collections[obj.session_uid]


# Whether objects that no view shows are in a collection, by session ID, until something changes.
_in_collections: dict[int, bool] = {}


def forget_collections() -> None:
    """Objects may be in other collections."""
    _in_collections.clear()


def shown_in(silhouette: Object) -> list[Object]:
    """The objects that a silhouette shows."""
    return objects_in(node_of(silhouette).parts)


@dataclass(frozen=True)
class CageSet(Cages):
    """The cages of a set, finest first, given by the finest, deleted or not; none around a drawing that has no cages.

    All else is read from the objects. Deleted ones are left out.
    """

    finest: Object

    def __len__(self) -> int:
        return len(self.cages)

    def __getitem__(self, number: Any) -> Any:
        return self.cages[number]

    # Finding

    @classmethod
    def all_of(cls, obj: Object) -> list[CageSet]:
        """The sets of a drawing, a member, or what moves one: around the drawing first, those named after it first."""
        node = node_of(obj)
        if node.role in {FINE, CAGE}:
            finest = _finest(obj)
            found = [cls(finest)] if finest is not None else []
        elif obj.library is not None:  # it cannot point back
            found = [each for each in cls.everywhere() if obj in objects_in(each.record.parts)]
        else:
            found = []
            for each in objects_in(node.sets):
                if node_of(each).role == CAGE:
                    found += [cls(each)] if obj in objects_in(node_of(each).record.parts) else []
                elif obj in shown_in(each):
                    found += cls.all_of(each)
        found = [each for each in dict.fromkeys(found) if each.counts]
        if len(found) > 1:
            found.sort(key=lambda each: (each.inside, objects_in(each.record.parts)[:1] != [obj]))
        if not found and obj.type in MOVERS:
            return [each for each in cls.everywhere() if obj in each.movers]
        return found

    @classmethod
    def of(cls, obj: Object) -> CageSet | None:
        """The set of a member, or the one around a drawing."""
        return next(iter(cls.all_of(obj)), None)

    @classmethod
    def beside(cls, obj: Object, *, inside: bool = False) -> CageSet | None:
        """The set around a drawing, or the one inside."""
        return next((each for each in cls.all_of(obj) if each.inside == inside), None)

    @classmethod
    def everywhere(cls) -> list[CageSet]:
        """All sets of the file."""
        if len(bpy.data.objects) == _known.get("objects"):
            with suppress(ReferenceError):  # an object was removed, and another one made
                return [each for each in _known["sets"] if each.counts]
        finest = [obj for obj in bpy.data.objects if is_finest(obj)]
        _known["sets"], _known["finest"] = list(map(cls, finest)), set(finest)
        _known["objects"] = len(bpy.data.objects)
        return [each for each in _known["sets"] if each.counts]

    @property
    def counts(self) -> bool:
        """Whether it is a set: with a drawing or a fine mesh of its own, and a cage that was not deleted."""
        inner = node_of(self.finest).inner
        mutual = (inner is not None and node_of(inner).outer == self.finest) or any(True for _ in self._mutual())
        return mutual and any(map(exists, self.chain()))

    # Reading

    @property
    def record(self) -> Any:
        """The `NestedCagesRecord`."""
        return node_of(self.finest).record

    @property
    def references(self) -> list[Any]:
        """The items of the record for its drawings, deleted or not."""
        return list(self._mutual())

    def _mutual(self) -> Iterator[Any]:
        for item in self.record.parts:
            obj = item.object
            if obj is not None and (obj.library is not None or self.finest in objects_in(node_of(obj).sets)):
                yield item

    @property
    def parts(self) -> list[Object]:
        """The drawings, the one that it is named after first."""
        return [item.object for item in self.references if exists(item.object)]

    @property
    def source(self) -> Object | None:
        """The drawing that it is named after; None if all were deleted."""
        return next((item.object for item in self._mutual() if exists(item.object)), None)

    @property
    def originals(self) -> list[Object]:
        """The drawings, and what a silhouette among them shows."""
        parts = self.parts
        return list(dict.fromkeys([*parts, *(obj for part in parts[:1] for obj in shown_in(part) if exists(obj))]))

    def chain(self) -> Iterator[Object]:
        """The cages from the finest on, also deleted ones."""
        node, seen = node_of(self.finest), [self.finest]
        if node.role == CAGE:
            yield self.finest
        while (here := node.outer) is not None and here not in seen:
            node = node_of(here)
            if node.inner != seen[-1]:
                return
            yield here
            seen.append(here)

    @property
    def cages(self) -> list[Object]:
        """The cages, finest first."""
        return list(filter(exists, self.chain()))

    @property
    def fine(self) -> Object | None:
        """The fine mesh; of a copy that was made without it, the one of the original."""
        inner: Object | None = node_of(self.finest).inner
        return inner if exists(inner) else None

    @property
    def members(self) -> list[Object]:
        """The fine mesh and the cages, from the inside out."""
        return [*filter(None, (self.fine,)), *self.cages]

    @property
    def movers(self) -> list[Object]:
        """What moves the coarsest cage by modifiers."""
        coarsest = self.cages[-1:]
        moving = [getattr(modifier, "object", None) for cage in coarsest for modifier in cage.modifiers]
        return [obj for obj in moving if obj is not None]

    @property
    def settings(self) -> Any:
        """The settings that the cages were made with, by the names of the operator's."""
        return self.record.settings

    @property
    def inside(self) -> bool:
        """Whether the cages lie inside the drawing."""
        return bool(self.record.inside)

    @property
    def bound(self) -> str:
        """The method that the drawing follows by; empty if it does not."""
        return str(self.record.bound)

    @property
    def certificates(self) -> list[Certificate]:
        """What is certified and was found of each cage, finest first."""
        return [Certificate.of(cage, number, inside=self.inside) for number, cage in enumerate(self.cages, 1)]

    @property
    def name(self) -> str:
        """What it is called in messages."""
        source = self.source
        return f"{self.record.title if source is None else source.name} {'Inner Cages' if self.inside else 'Cages'}"

    @property
    def missing(self) -> list[str]:
        """What was deleted, or what a copy shares with its original, as sentences."""
        gone = [f"'{obj.name}' was deleted" for obj in (*self._whole(), *self.drawings()) if not exists(obj)]
        shared = [f"'{obj.name}' is shared with '{other.name}'" for obj, other in self.shared() if exists(obj)]
        left = [obj for obj in objects_in(self.record.parts) if obj not in self.drawings()]
        return gone + shared + [f"'{obj.name}' was not copied along" for obj in left]

    def _whole(self) -> list[Object]:
        return [*filter(None, (node_of(self.finest).inner,)), *self.chain()]

    def drawings(self) -> list[Object]:
        """The drawings, also deleted ones."""
        return [item.object for item in self.references]

    def shared(self) -> list[tuple[Object, Object]]:
        """What a copy refers to next to its own cages, and the object of the original that this belongs to."""
        *_, last = (self.finest, *self.chain())
        pairs = ((self.finest, node_of(self.finest).inner, "outer"), (last, node_of(last).outer, "inner"))
        theirs = [(obj, getattr(node_of(obj), back), own) for own, obj, back in pairs if obj is not None]
        return [(obj, other) for obj, other, own in theirs if other not in (own, None)]

    # Changing

    @classmethod
    def make(cls, fine: Object, cages: Sequence[Object]) -> CageSet:
        """A chain of objects, finest cage first; they leave the one that they were in."""
        for obj, inner, outer in zip((fine, *cages), (None, fine, *cages), (*cages, None), strict=False):
            node = new_node(obj)
            node.role, node.inner, node.outer = FINE if inner is None else CAGE, inner, outer
        forget_sets()
        return cls(cages[0])

    def take(self, drawings: Iterable[Object], *, inside: bool) -> None:
        """Makes these the drawings of the set; they leave those that they had on this side."""
        wanted = list(drawings)
        for obj in objects_in(self.record.parts):
            self.leave(obj)
        self.record.inside = inside
        for obj in wanted:
            for each in CageSet.all_of(obj):
                if each.inside == inside and obj in each.parts and obj.library is None:
                    each.leave(obj)
        self.join(*wanted)

    def join(self, *drawings: Object) -> None:
        """Takes further drawings into the set."""
        refer(self.record.parts, drawings)
        for obj in drawings:
            if obj.library is None:
                refer(new_node(obj).sets, [self.finest])

    def leave(self, obj: Object) -> None:
        """Lets a drawing go, which is none of this set any more."""
        drop(self.record.parts, [obj])
        if obj.library is None and has_node(obj):
            drop(new_node(obj).sets, [self.finest])


def level_of(obj: Object) -> int | None:
    """The level of a member of a set, 0 for the fine mesh; None for other objects, and for a copy of one alone."""
    role = node_of(obj).role
    cage_set = CageSet.of(obj) if role in {FINE, CAGE} and obj.type == "MESH" else None
    if cage_set is None:
        return None
    return 0 if role == FINE else 1 + list(cage_set.chain()).index(obj)


def is_finest(obj: Object) -> bool:
    """Whether an object is the finest cage of a chain."""
    return has_node(obj) and node_of(obj).role == CAGE and _finest(obj) == obj


def _finest(obj: Object) -> Object | None:
    """The finest cage of the chain that an object is in."""
    node = node_of(obj)
    if node.role == FINE:
        outer: Object | None = node.outer
        return outer if outer is not None and node_of(outer).inner == obj else None
    seen = [obj]
    while node.role == CAGE:
        inner = node.inner
        below = node_of(inner) if inner is not None else node
        if inner is None or below.role != CAGE:
            return seen[-1]
        if inner in seen or below.outer != seen[-1]:
            return None
        seen.append(inner)
        node = below
    return None


# All sets, and the number of objects when they were found.
_known: dict[str, Any] = {}


def forget_sets() -> None:
    """Other objects may be the finest cages."""
    _known.clear()
    forget_collections()


def recheck_sets(updated: Iterable[Object]) -> None:
    """Forgets the sets if some updated objects are the finest cages of others now, as after undo."""
    if _known and any(is_finest(obj) != (obj in _known["finest"]) for obj in updated):
        forget_sets()
