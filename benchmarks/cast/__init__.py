"""Characters in layers, drawn by this project to try puppets on: SVG, and what a rigger would hang each part on.

`FIRST` were drawn when the rules of the graph were written, before these were measured on anything but four other
characters; `SECOND` after the rules were changed with `FIRST` in view. Weights took the place of the rules, were fitted
to both, and `THIRD` were drawn and measured after that; so were `FOURTH`, after a fit to these three. Now weights are
fitted to all four; `FIFTH` were drawn after that, and measured once.
"""

from __future__ import annotations

from collections.abc import Callable

from . import crawlers, fifth, fourth, people, second, third, walkers
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

THIRD: dict[str, Callable[[], Sheet]] = {
    draw.__name__: draw
    for draw in (
        third.fox,
        third.owl,
        third.astronaut,
        third.monkey,
        third.lizard,
        third.spider,
        third.mermaid,
        third.rooster,
        third.crocodile,
        third.bat,
        third.ballerina,
        third.snowman,
    )
}

FOURTH: dict[str, Callable[[], Sheet]] = {
    draw.__name__: draw
    for draw in (
        fourth.rabbit,
        fourth.bee,
        fourth.deer,
        fourth.panda,
        fourth.pirate,
        fourth.scorpion,
        fourth.camel,
        fourth.mouse,
        fourth.toucan,
        fourth.skeleton,
    )
}

TUNED = FIRST | SECOND | THIRD | FOURTH
"""Those that the weights of the graph are fitted to."""

FIFTH: dict[str, Callable[[], Sheet]] = {
    draw.__name__: draw
    for draw in (
        fifth.goat,
        fifth.chef,
        fifth.duck,
        fifth.ant,
        fifth.princess,
        fifth.kangaroo,
        fifth.lobster,
        fifth.clown,
        fifth.seahorse,
        fifth.ninja,
    )
}
