"""The data-blocks of the open file: new ones go where what makes them fails."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy


@contextmanager
def removed_on_failure() -> Iterator[None]:
    """Removes all new data-blocks if what follows fails or is cancelled, but what earlier objects use; nothing
    else may make any meanwhile.
    """
    before = {block.session_uid for block in _blocks()}
    try:
        yield
    except BaseException:
        before |= {obj.data.session_uid for obj in bpy.data.objects if obj.data and obj.session_uid in before}
        bpy.data.batch_remove([block for block in _blocks() if block.session_uid not in before])
        raise


def _blocks() -> Iterator[Any]:
    """All data-blocks."""
    data: Any = bpy.data
    for kind in data.bl_rna.properties:
        if kind.type == "COLLECTION":
            yield from getattr(data, kind.identifier)
