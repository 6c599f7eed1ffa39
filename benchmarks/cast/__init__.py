"""Characters in layers, drawn by this project to try puppets on: SVG, and what a rigger would hang each part on.

`FIRST` were drawn when the rules of the graph were written, before these were measured on anything but four other
characters; `SECOND` after the rules were changed with `FIRST` in view. Weights took the place of the rules, were fitted
to both, and each later set was drawn and measured once before the weights were fitted to it too. `NINTH` were
measured once and have not been fitted. Where a figure has hips or a pelvis of its own, these are the root, as riggers
have it; three of the first five sets said the chest at first.
"""

from __future__ import annotations

from collections.abc import Callable

from . import crawlers, eighth, fifth, fourth, ninth, people, second, seventh, sixth, third, walkers
from .sheet import Sheet


def _by_name(*draws: Callable[[], Sheet]) -> dict[str, Callable[[], Sheet]]:
    return {draw.__name__: draw for draw in draws}


FIRST = _by_name(
    walkers.cat,
    walkers.horse,
    walkers.robin,
    people.girl,
    people.walker,
    people.robot,
    crawlers.fish,
    crawlers.octopus,
    walkers.dinosaur,
    crawlers.beetle,
    crawlers.snake,
    walkers.dragon,
)

SECOND = _by_name(
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

THIRD = _by_name(
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

FOURTH = _by_name(
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

FIFTH = _by_name(
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

SIXTH = _by_name(
    sixth.hedgehog,
    sixth.ostrich,
    sixth.gardener,
    sixth.samurai,
    sixth.diver,
    sixth.squid,
    sixth.butterfly,
    sixth.raccoon,
    sixth.giraffe,
    sixth.schoolkid,
)

SEVENTH = _by_name(
    seventh.cowboy,
    seventh.guitarist,
    seventh.skater,
    seventh.grandmother,
    seventh.lion,
    seventh.squirrel,
    seventh.gorilla,
    seventh.shark,
    seventh.centaur,
    seventh.goblin,
)

EIGHTH = _by_name(
    eighth.nurse,
    eighth.viking,
    eighth.footballer,
    eighth.waiter,
    eighth.cow,
    eighth.bear,
    eighth.parrot,
    eighth.grasshopper,
    eighth.excavator,
    eighth.griffin,
)

TUNED = FIRST | SECOND | THIRD | FOURTH | FIFTH | SIXTH | SEVENTH | EIGHTH
"""Those that the weights of the graph are fitted to."""

NINTH = _by_name(
    ninth.firefighter,
    ninth.detective,
    ninth.boxer,
    ninth.violinist,
    ninth.wolf,
    ninth.rhinoceros,
    ninth.eagle,
    ninth.koala,
    ninth.fairy,
    ninth.minotaur,
)
