"""Three claims. Each is a sentence, numbers from the runs, and gates that the runs can fail: paired tests corrected
for their number, and intervals. They are judged on the shapes that methods were made with and on held-out ones, most
gates from each start alone. A gate that the runs do not pass is printed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from comparison import methods, statistics
from comparison.runs import Run, by_shape, of, shared
from comparison.shapes import GLYPHS, HELD_OUT, RANDOM
from comparison.statistics import Paired, sign_test

KNOWN = (RANDOM, GLYPHS)
LEVEL = 0.05
"""Corrected p below which one method is called better."""
NO_LOOSER = 1.05
"""Ratio of excesses up to which one method is no looser than another: small next to what the range does."""
APART = 1.01
"""Ratio of the largest to the least excess of a shape above which contacts differ on it."""
LEAST_EXCESS, LEAST_SECONDS = 1e-3, 1e-4
"""Per cent and seconds that count at least: ratios to nothing say nothing."""


@dataclass(frozen=True)
class Verdict:
    """What some runs say of a claim."""

    numbers: dict[str, str]
    tests: dict[str, Paired]
    """With corrected p."""
    failed: tuple[str, ...]
    """Gates that the runs do not pass."""

    @property
    def holds(self) -> bool:
        """Whether they pass all."""
        return not self.failed


@dataclass(frozen=True)
class Conclusion:
    """A claim and its test."""

    name: str
    claim: str
    judge: Callable[[Sequence[Run], tuple[str, ...]], Verdict]
    page: str
    picture: str
    caption: str


def original(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """Gurditta & Jacobson name this comparison as what their work lacks."""
    numbers, tests, slower = {}, {}, {}
    for start in methods.STARTS:
        own = [row for row in by_shape(of(runs, "methods", *families, start=start)).values()
               if row.keys() >= {methods.ORIGINAL, *NEWTONS}]  # fmt: skip
        solved = {name: sum(row[name].success for row in own) for name in (methods.ORIGINAL, *NEWTONS)}
        numbers[f"{start}: solved by 2015, by 2022, by 2022 at d̂ = {methods.SMALL_RANGE:g}"] = (
            ", ".join(map(str, solved.values())) + f" of {len(own)}"
        )
        for name in NEWTONS:
            d_hat = f"d̂ = {RANGE_OF[name]:.2g}"
            pairs = {"all shapes": own, "both solve": [row for row in own if solve(row, methods.ORIGINAL, name)]}
            for which, rows in pairs.items():
                tests[f"{start}, {d_hat}, {which}: 2015 tighter"] = sign_test(
                    *([excess(row[m]) for row in rows] for m in (methods.ORIGINAL, name))
                )
            tests[f"{start}, {d_hat}: 2015 solves and 2022 does not"] = sign_test(
                *([float(not row[m].success) for row in own] for m in (methods.ORIGINAL, name))
            )
        for name in (*NEWTONS, methods.REPAIRED):
            rows = [row for row in own if name in row and solve(row, methods.ORIGINAL, name)]
            if not rows:
                continue
            slower[start, name] = statistics.geometric_mean(
                [seconds(row[name]) / seconds(row[methods.ORIGINAL]) for row in rows]
            )
            numbers[f"{start}: {name} takes, times 2015"] = slower[start, name].text(".1f")
    main = {name: test for name, test in tests.items() if "both solve" in name}
    others = {name: test for name, test in tests.items() if name not in main}
    tests = statistics.corrected(main) | statistics.corrected(others)
    numbers |= {name.replace(", both solve", ""): tests[name].text for name in main}
    near, far = (f"d̂ = {RANGE_OF[name]:.2g}" for name in (methods.NEWTON_SMALL, methods.NEWTON))
    return verdict(numbers, tests, {
        **{f"{start}: at {far}, 2015 is tighter": tests[f"{start}, {far}, both solve: 2015 tighter"].says(LEVEL)
           for start in methods.STARTS},
        **{f"{start}: at {near}, it is not": not tests[f"{start}, {near}, both solve: 2015 tighter"].says(LEVEL)
           for start in methods.STARTS},
        **{f"{start}: {name} takes longer": slower[start, name].low > 1.0
           for start, name in slower if name != methods.NEWTON},
    })  # fmt: skip


def ranges(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """IPC as published against the modified energy, at equal ranges."""
    numbers, tests, gates = {}, {}, {}
    least, largest = methods.RANGES[0], methods.RANGES[-1]
    names = {(name, d): methods.at(name, d) for name in (methods.ENERGY_2022, methods.IPC_2020) for d in methods.RANGES}
    for start in methods.STARTS:
        rows = shared(of(runs, "contacts", *families, start=start), names.values())
        found = {key: [excess(row[name]) for row in rows] for key, name in names.items()}
        growth = ratio(found[methods.ENERGY_2022, largest], found[methods.ENERGY_2022, least])
        close = ratio(found[methods.ENERGY_2022, least], found[methods.IPC_2020, least])
        numbers[f"{start}: shapes that both solve at every range"] = str(len(rows))
        numbers[f"{start}: excess of 2022 from d̂ = {least:.2g} to {largest:.2g} grows"] = f"{growth.text()} times"
        numbers[f"{start}: excess of 2022 to IPC 2020 at d̂ = {least:.2g}"] = close.text(".3f")
        for d in (least, largest):
            tests[f"{start}, d̂ = {d:.2g}: 2022 tighter than IPC 2020"] = sign_test(
                found[methods.ENERGY_2022, d], found[methods.IPC_2020, d]
            )
        gates[f"{start}: excess grows with d̂"] = growth.low > 1.0
        gates[f"{start}: at the small range no looser than IPC 2020"] = close.high < NO_LOOSER
    return verdict(numbers, statistics.corrected(tests), gates)


def starts(runs: Sequence[Run], families: tuple[str, ...]) -> Verdict:
    """What is left of the differences between contacts after the tightening, next to those between starts."""
    numbers, gates = {}, {}
    rows = after_tightening(runs, families)
    by_start = {start: [row for row in rows if start_of(row) == start] for start in methods.STARTS}
    differ = {start: [spread([run.tightened for run in row.values()]) > APART for row in of_start]
              for start, of_start in by_start.items()}  # fmt: skip
    for start, flags in differ.items():
        medians = [np.median([row[name].tightened for row in by_start[start]] or [np.nan]) for name in methods.CONTACTS]
        numbers[f"{start}: shapes, medians after tightening"] = (
            f"{len(flags)}: {min(medians):.2f} to {max(medians):.2f} %"
        )
        numbers[f"{start}: contacts differ by more than 1 %"] = (
            statistics.Interval(*(100.0 * value for value in statistics.share(flags))).text(".0f") + " % of shapes"
        )
    over_contacts, over_starts = [], []
    for of_shape in shapes_from_all(rows):
        over_contacts.append(float(np.median([spread([r.tightened for r in row.values()]) for row in of_shape])))
        over_starts.append(float(np.median([spread([row[name].tightened for row in of_shape])
                                            for name in methods.CONTACTS])))  # fmt: skip
    numbers["largest to least excess over contacts, median"] = statistics.bootstrap(over_contacts).text(".3f")
    numbers["the same over starts"] = statistics.bootstrap(over_starts).text(".3f")
    tests = {"contacts differ less than starts": sign_test(over_contacts, over_starts)}
    of_starts = [
        [max(spread([run.tightened for run in row.values()]), APART) for row in of_shape]
        for of_shape in shapes_from_all(rows)
    ]
    tests["contacts differ less from line cycles than from the worse of the others"] = sign_test(
        [ratios[-1] for ratios in of_starts], [max(ratios[:-1]) for ratios in of_starts]
    )
    tests = statistics.corrected(tests)
    numbers |= {name: test.text for name, test in tests.items()}
    gates = {name: test.says(LEVEL) for name, test in tests.items()}
    return verdict(numbers, tests, gates)


def verdict(numbers: dict[str, str], tests: dict[str, Paired], gates: dict[str, bool]) -> Verdict:
    """What the gates say."""
    return Verdict(numbers, tests, tuple(name for name, passed in gates.items() if not passed))


NEWTONS = (methods.NEWTON, methods.NEWTON_SMALL)
RANGE_OF = {methods.NEWTON: methods.LARGE_RANGE, methods.NEWTON_SMALL: methods.SMALL_RANGE}


def after_tightening(runs: Sequence[Run], families: tuple[str, ...]) -> list[dict[str, Run]]:
    """The shapes and starts from which every contact with its own range succeeds, tightening included."""
    rows = shared(of(runs, "contacts", *families), methods.CONTACTS)
    rows = [{name: row[name] for name in methods.CONTACTS} for row in rows]
    return [row for row in rows if all(run.tightened is not None for run in row.values())]


def shapes_from_all(rows: Iterable[dict[str, Run]]) -> list[list[dict[str, Run]]]:
    """The rows of each shape in the order of starts, of shapes that have one from each."""
    found: dict[tuple[str, str], dict[str, dict[str, Run]]] = {}
    for row in rows:
        run = next(iter(row.values()))
        found.setdefault((run.family, run.shape), {})[run.start] = row
    return [[of_shape[start] for start in methods.STARTS] for of_shape in found.values()
            if len(of_shape) == len(methods.STARTS)]  # fmt: skip


def start_of(row: dict[str, Run]) -> str:
    """What made the coarse mesh of a row."""
    return next(iter(row.values())).start


def solve(row: dict[str, Run], *names: str) -> bool:
    """Whether all of some methods do."""
    return all(row[name].success for name in names)


def excess(run: Run) -> float:
    """In per cent; infinite where the method fails."""
    return max(run.excess, LEAST_EXCESS) if run.success and run.excess is not None else np.inf


def seconds(run: Run) -> float:
    """CPU time."""
    return max(run.seconds or 0.0, LEAST_SECONDS)


def ratio(one: Sequence[float], other: Sequence[float]) -> statistics.Interval:
    """Geometric mean of ratios of paired values."""
    return statistics.geometric_mean([a / b for a, b in zip(one, other, strict=True)])


def spread(excesses: Sequence[float | None]) -> float:
    """Largest excess over the least."""
    known = [max(value, LEAST_EXCESS) for value in excesses if value is not None]
    return max(known) / min(known) if known else np.inf


CONCLUSIONS = (
    Conclusion(
        "original", "Whether 2015 or its augmentation of 2022 is tighter is decided by the range of the barrier; the "
        "augmentation takes longer, most of it in gradient descent.", original, "methods.md", "original.png",
        "Every shape: excess of 2022 over that of 2015 at two ranges, and their times",
    ),
    Conclusion(
        "ranges", "What makes the augmentation of 2022 loose is the range of its barrier, not the barrier: at that of "
        "IPC (2020) it is no looser.", ranges, "contacts.md", "ranges.png",
        "Excess over the range d̂ from each start, median and quartiles",
    ),
    Conclusion(
        "starts", "After the same tightening the start decides, not the contact.", starts, "contacts.md",
        "tightened.png", "Largest over least excess after tightening: of the contacts, and of the starts",
    ),
)  # fmt: skip


def verdicts(runs: Sequence[Run]) -> dict[Conclusion, tuple[Verdict, Verdict]]:
    """Every conclusion on the shapes that methods were made with, and on held-out ones."""
    return {c: (c.judge(runs, KNOWN), c.judge(runs, (HELD_OUT,))) for c in CONCLUSIONS}
