"""What the add-on says no to, in one sentence that names the object and what to change."""

from __future__ import annotations

from types import ModuleType

import bpy


class Refusal(Exception):  # noqa: N818 - a refusal is what the user gets, not a fault of the program
    """A drawing, setting or state that cannot be worked with; the sentence is shown to the user as it is."""

    def __init__(self, sentence: str, **words: object) -> None:
        super().__init__(say(sentence, **words))


def say(sentence: str, **words: object) -> str:
    """The sentence in the user's language, with its ``{words}`` filled in."""
    return str(bpy.app.translations.pgettext_rpt(sentence)).format(**words)


def say_count(count: int, one: str, many: str, **words: object) -> str:
    """The sentence for one thing, or for any other number of them, with ``{count}`` and other words filled in."""
    return say(one if count == 1 else many, count=count, **words)


def load_core() -> ModuleType:
    """The package ``nestedcages_core``, imported only now so that a missing scipy is a sentence. Raises: Refusal."""
    try:
        from .. import nestedcages_core
    except ImportError as error:
        if (error.name or "").partition(".")[0] != "scipy":
            raise
        raise Refusal(
            "Nested Cages needs scipy, which this copy of the extension does not bring along for this "
            "Blender: install the zip made for your system"
        ) from error
    return nestedcages_core
