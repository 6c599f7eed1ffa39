"""Characters in layers, drawn by this project to try puppets on: SVG, and what a rigger would hang each part on.

`FIRST` were drawn when the rules of the graph were written, before these were measured on anything but four other
characters; `SECOND` after the rules were changed with `FIRST` in view.
"""

from __future__ import annotations

from collections.abc import Callable

from . import crawlers, people, second, walkers
from .sheet import Sheet

FIRST: dict[str, Callable[[], Sheet]] = {
    "cat": walkers.cat,
    "horse": walkers.horse,
    "robin": walkers.robin,
    "girl": people.girl,
    "walker": people.walker,
    "robot": people.robot,
    "fish": crawlers.fish,
    "octopus": crawlers.octopus,
    "dinosaur": walkers.dinosaur,
    "beetle": crawlers.beetle,
    "snake": crawlers.snake,
    "dragon": walkers.dragon,
}

SECOND: dict[str, Callable[[], Sheet]] = {
    draw.__name__: draw
    for draw in (
        second.dog,
        second.elephant,
        second.penguin,
        second.frog,
        second.knight,
        second.witch,
        second.crab,
        second.turtle,
        second.stork,
        second.caterpillar,
    )
}
