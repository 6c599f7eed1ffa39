"""Fits the weights of `nestedcages_core/puppets/draft/scores.py`, and leaves out each character in turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from common import DETAILS, Options, table
from nestedcages_core import PuppetPart, draft_puppet
from nestedcages_core.puppets.draft import scores
from nestedcages_core.puppets.draft.evidence import Evidence
from nestedcages_core.puppets.draft.names import NAMES as OF_NAMES
from puppets import CAST, NOT_FITTED, drawing, names_of, wrong

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


def weights_of(choices: Choices, penalty: float, known: Mapping[str, float]) -> dict[str, float]:
    """The most likely weights by multinomial logistic regression; known: some that are given."""
    names = [name for name in choices.columns if name not in known]
    if not names:
        return dict(known)
    base = sum(weight * choices.columns[name] for name, weight in known.items())
    rows = np.stack([choices.columns[name] for name in names], axis=1)
    start = np.array(choices.start)
    group = np.repeat(np.arange(len(start)), np.diff(np.append(start, len(rows))))

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        odds = rows @ weights + base
        most = np.maximum.reduceat(odds, start)
        ratio = np.exp(odds - most[group])
        total = np.add.reduceat(ratio, start)
        value = penalty * weights @ weights - (odds[choices.right] - most - np.log(total)).sum()
        return value, 2.0 * penalty * weights - rows[choices.right].sum(axis=0) + (ratio / total[group]) @ rows

    found = scipy.optimize.minimize(loss, np.zeros(len(names)), jac=True).x
    return {**known, **dict(zip(names, found.round(2).tolist(), strict=True))}


def evidence_of(parts: Sequence[PuppetPart], name: str) -> tuple[Choices, Choices]:
    """Of the root and of the links of a character."""
    evidence, parents = Evidence(parts), CAST[name]["parents"]
    number = {part: k for k, part in enumerate(parents)}
    parent = [number.get(each) for each in parents.values()]
    root = parent.index(None)
    meets = {child: [] for child, _ in evidence.pairs}
    for row, (child, _) in enumerate(evidence.pairs):
        meets[child].append(row)
    kept, start, right = list[int](), list[int](), list[int]()
    for child, rows in meets.items():
        own = [k for k, row in enumerate(rows) if evidence.pairs[row][1] == parent[child]]
        if own:
            start.append(len(kept))
            right.append(len(kept) + own[0])
            kept += rows
    columns = {key: column[kept] for key, column in evidence.of_links(root).items()}
    return Choices(evidence.of_roots(), [0], [root]), Choices(columns, start, right)


def group_of(part: str, on: Mapping[str, str | None]) -> str:
    """The group that an artist might put a part into: a limb with all on it, or the trunk with what is no limb."""
    limb, above = part, on[part]
    while above is not None and on[above] is not None:
        limb, above = above, on[above]
    return limb if limb in on.values() or above is None else above


def fit(known: Sequence[Sequence[tuple[Choices, Choices]]]) -> None:
    """Weights of shapes on drawings without names, then those of names, then that of groups: into the core."""
    for kind, penalty, names_penalty, own in (
        (0, ROOT_PENALTY, ROOT_PENALTY, scores.ROOT_WEIGHTS),
        (1, LINK_PENALTY, NAME_PENALTY, scores.LINK_WEIGHTS),
    ):
        bare, named, grouped = (joined([each[k][kind] for each in known]) for k in range(3))
        shapes = weights_of(bare, penalty, {})
        shapes = {name: weight for name, weight in shapes.items() if name not in (*OF_NAMES, OF_GROUPS)}
        of_named = weights_of(named, names_penalty, shapes)
        of_named.pop(OF_GROUPS, None)
        own.clear()
        own.update(weights_of(grouped, penalty, of_named))


def run(options: Options) -> str:
    """Parents of characters by the weights of all others, and the weights that are fitted to all."""
    known, drawn = {}, {}
    for name in [each for each in names_of(options) if CAST[each]["set"] != NOT_FITTED]:
        named = [replace(part, groups=()) for part in drawing(name)]
        bare = [replace(part, name=f"path{k}") for k, part in enumerate(named)]
        grouped = [replace(part, groups=(group_of(part.name, CAST[name]["parents"]),)) for part in named]
        drawn[name] = {SHAPES: bare, NAMES: named, GROUPS: grouped}
        known[name] = [evidence_of(each, name) for each in (bare, named, grouped)]
    before = [dict(own) for own in (scores.ROOT_WEIGHTS, scores.LINK_WEIGHTS)]
    rows = []
    for left_out, variants in drawn.items():
        fit([each for name, each in known.items() if name != left_out])
        bad = [len(wrong(draft_puppet(parts), left_out)) for parts in variants.values()]
        rows.append((left_out, len(CAST[left_out]["parents"]), *bad))
    fit(list(known.values()))
    count, *bad = np.array([row[1:] for row in rows]).sum(axis=0).tolist()
    kinds = (SHAPES, NAMES, GROUPS)
    shares = [(kind, f"{1 - each / count:.1%}") for kind, each in zip(kinds, bad, strict=True)]
    right = table((f"of {count} parents of held-out characters", "right"), shares)
    weights = "\n".join(f"{own}" for own in (scores.ROOT_WEIGHTS, scores.LINK_WEIGHTS))
    for own, kept in zip((scores.ROOT_WEIGHTS, scores.LINK_WEIGHTS), before, strict=True):
        own.clear()
        own.update(kept)
    left = table(("left out", "parts", *(f"wrong {kind}" for kind in kinds)), rows)
    return f"{right}\n\n{DETAILS}\n\n{left}\n\n{weights}"
