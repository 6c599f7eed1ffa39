"""Fits the weights by which parts of a puppet find their parents to characters whose parents are known.

    python benchmarks/cast_weights.py            # the weights of nestedcages_core/puppet/scores.py
    python benchmarks/cast_weights.py --held-out # each character by the weights of all others

Multinomial logistic regression with a quadratic penalty: first weights of shapes, on drawings without names, then those
of names, then that of groups. The drawings have none: the body with what hangs on it alone, and each limb, are one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

import cast
from nestedcages_core.exchange import puppet_parts
from nestedcages_core.puppet import PuppetPart, draft_puppet, scores
from nestedcages_core.puppet.evidence import Evidence
from nestedcages_core.puppet.words import NAMES as OF_NAMES

ROOT_PENALTY, LINK_PENALTY, NAME_PENALTY = 0.1, 1.5, 0.3
"""Of squared weights; what is right of held-out characters is flat around these."""

OF_GROUPS = "group"
SHAPES, NAMES, GROUPS = "without names", "with names", "with names and groups"


@dataclass(frozen=True, eq=False)
class Choices:
    """Who chooses among what, and what is right."""

    columns: Mapping[str, np.ndarray]
    start: list[int]
    """The first row of each choice."""
    right: list[int]
    """Its right row."""


def joined(some: Sequence[Choices]) -> Choices:
    sizes = np.cumsum([0, *(len(next(iter(each.columns.values()))) for each in some)]).tolist()
    return Choices(
        {name: np.concatenate([each.columns[name] for each in some]) for name in some[0].columns},
        [size + row for size, each in zip(sizes, some, strict=False) for row in each.start],
        [size + row for size, each in zip(sizes, some, strict=False) for row in each.right],
    )


def weights_of(choices: Choices, penalty: float, known: Mapping[str, float] | None = None) -> dict[str, float]:
    """The most likely weights; known: some that are given."""
    given = dict(known or {})
    names = [name for name in choices.columns if name not in given]
    if not names:
        return given
    base = sum(weight * choices.columns[name] for name, weight in given.items())
    rows = np.stack([choices.columns[name] for name in names], axis=1)
    start = np.array(choices.start)
    group = np.repeat(np.arange(len(start)), np.diff(np.append(start, len(rows))))

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        odds = rows @ weights + base
        most = np.maximum.reduceat(odds, start)
        ratio = np.exp(odds - most[group])
        total = np.add.reduceat(ratio, start)
        value = penalty * weights @ weights - (odds[choices.right] - most - np.log(total)).sum()
        slope = 2.0 * penalty * weights - rows[choices.right].sum(axis=0) + (ratio / total[group]) @ rows
        return value, slope

    found = scipy.optimize.minimize(loss, np.zeros(len(names)), jac=True).x
    return given | dict(zip(names, found.round(2).tolist(), strict=True))


def evidence_of(parts: Sequence[PuppetPart], on: Mapping[str, str | None], names: list[str]) -> tuple[Choices, Choices]:
    """Of the root and of the links of one character."""
    evidence = Evidence(parts)
    parent = [None if on[name] is None else names.index(on[name] or "") for name in names]
    root = parent.index(None)
    start, right = [], []
    for row, (child, other) in enumerate(evidence.pairs):
        if row == 0 or evidence.pairs[row - 1][0] != child:
            start.append(row)
        if other == parent[child]:
            right.append(row)
    kept = [row for row in start if any(evidence.pairs[row][0] == evidence.pairs[k][0] for k in right)]
    rows = np.array([k for k, (child, _) in enumerate(evidence.pairs) if child in {evidence.pairs[j][0] for j in kept}])
    number = {int(row): k for k, row in enumerate(rows)}
    columns = {name: column[rows] for name, column in evidence.of_links(root).items()}
    links = Choices(columns, [number[row] for row in kept], [number[row] for row in right])
    return Choices(evidence.of_roots(), [0], [root]), links


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--held-out", action="store_true", help="leave each character out in turn")
    options = parser.parse_args()
    known, drawn = {}, {}
    for name, draw in cast.TUNED.items():
        sheet, parts = draw(), puppet_parts(draw().svg())[0]
        names = [part.name for part in parts]
        named = [replace(part, groups=()) for part in parts]
        bare = [replace(part, name=f"path{k}", identity="") for k, part in enumerate(named)]
        grouped = [replace(part, groups=(sheet.group_of(part.name),)) for part in parts]
        drawn[name] = sheet, names, {SHAPES: bare, NAMES: named, GROUPS: grouped}
        known[name] = [evidence_of(each, sheet.on, names) for each in (bare, named, grouped)]
    wrong = dict.fromkeys((SHAPES, NAMES, GROUPS), 0)
    for left_out in [*drawn, None] if options.held_out else [None]:
        some = [both for name, both in known.items() if name != left_out]
        for kind, penalty, names_penalty, own in (
            (0, ROOT_PENALTY, ROOT_PENALTY, scores.ROOT_WEIGHTS),
            (1, LINK_PENALTY, NAME_PENALTY, scores.LINK_WEIGHTS),
        ):
            bare, named, grouped = (joined([both[k][kind] for both in some]) for k in range(3))
            shapes = weights_of(bare, penalty)
            shapes = {name: weight for name, weight in shapes.items() if name not in (*OF_NAMES, OF_GROUPS)}
            of_named = weights_of(named, names_penalty, shapes)
            of_named.pop(OF_GROUPS, None)
            own.clear()
            own.update(weights_of(grouped, penalty, of_named))
        if left_out is not None:
            sheet, names, both = drawn[left_out]
            for kind, parts in both.items():
                links = draft_puppet(parts).links
                found = [None if link.parent is None else names[link.parent] for link in links]
                bad = [f"{a}: {b}" for a, b in zip(names, found, strict=True) if sheet.on[a] != b]
                wrong[kind] += len(bad)
                if bad:
                    print(f"{left_out}, {kind}: {len(bad)} of {len(names)} wrong", *bad, sep="; ", flush=True)
    if options.held_out:
        count = sum(len(names) for _, names, _ in drawn.values())
        print(*(f"{kind}: {100.0 * (1.0 - bad / count):.1f} % right" for kind, bad in wrong.items()), sep=", ")
    print(scores.ROOT_WEIGHTS, scores.LINK_WEIGHTS, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
