"""What the comparison concludes. Every conclusion is a sentence with numbers from the runs, and a test of its claim.

A claim that the runs contradict is printed as such, and the command fails.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import dataclass

from comparison import methods
from comparison.experiments import contacts, flows, reuse, scaling, sweeps
from comparison.experiments.contacts import CLEARING, DESCENT, TIGHTENED
from comparison.measure import Results
from comparison.tables import count, median, number

Found = dict[str, Results]

ORIGINAL, AUGMENTED = "Nested Cages 2015", "paper repaired"
FASTER = 3.0
"""Times faster that "faster" means, where the claim is of whole methods."""
SAME = 0.1
"""Spread of medians after the tightening, relative to that before, up to which contacts are called alike."""


@dataclass(frozen=True)
class Verdict:
    """A conclusion on some runs."""

    text: str
    holds: bool


@dataclass(frozen=True)
class Conclusion:
    """A claim."""

    name: str
    needs: tuple[str, ...]
    """The experiments that it rests on."""
    judge: Callable[[Found], Verdict]
    page: str
    """The page with the tables."""


@dataclass(frozen=True)
class Trial:
    """Conclusions on shapes that the pages do not contain."""

    seed: int
    shapes: dict[str, int]
    """Experiment -> how many."""
    verdicts: dict[Conclusion, Verdict]

    def __str__(self) -> str:
        """All of it in lines."""
        counts = ", ".join(f"{count} for {name}" for name, count in self.shapes.items())
        lines = [f"On random shapes that the pages do not contain, seeds from {self.seed} on: {counts}."]
        lines += [
            f"{'Holds' if verdict.holds else 'DOES NOT HOLD'}: {verdict.text}" for verdict in self.verdicts.values()
        ]
        return "\n".join(lines)

    @property
    def outcome(self) -> str:
        """In a sentence."""
        lost = [f"*{verdict.text.split('**')[1]}*" for verdict in self.verdicts.values() if not verdict.holds]
        count = sum(self.shapes.values())
        kept = len(self.verdicts) - len(lost)
        return (
            f"Tried again on {count} random shapes that these runs do not contain, {kept} of {len(self.verdicts)} "
            "conclusions hold" + (f"; not: {' '.join(lost)}" if lost else ".")
        )


def original_against_augmentation(found: Found) -> Verdict:
    """Gurditta & Jacobson name this comparison as what their work lacks."""
    runs = [shape for name in ("figures", "random shapes") for shape in found.get(name, {}).values()]
    solved = {name: sum(shape[name].success for shape in runs) for name in (ORIGINAL, AUGMENTED, "IPC")}
    both = [
        (shape[ORIGINAL], shape[AUGMENTED]) for shape in runs if shape[ORIGINAL].success and shape[AUGMENTED].success
    ]
    tighter = sum((one.excess or 0.0) < (other.excess or 0.0) for one, other in both)
    ratio = median(other.total / one.total for one, other in both) or 0.0
    return Verdict(
        "**The original is tighter and faster than its augmentation as published, and solves more.** With El Topo as "
        f"contact, Nested Cages of 2015 solves {solved[ORIGINAL]} of {len(runs)} figures and random shapes, the method "
        f"of 2022 with its faults repaired {solved[AUGMENTED]}, ours with IPC {solved['IPC']}. Where both published "
        f"methods succeed, the original is tighter on {tighter} of {len(both)} and {ratio:.0f} times faster in the "
        "median.",
        solved[ORIGINAL] > solved[AUGMENTED] and 2 * tighter > len(both) and ratio >= FASTER,
    )


def barrier_is_not_to_blame(found: Found) -> Verdict:
    """IPC as published, in place of the modified one."""
    rows = contacts.solved_by_all(found["contacts"], DESCENT)
    excess = {name: median(row[name].excess for row in rows) or 0.0 for name in contacts.contacts_with(DESCENT)}
    seconds = {name: median(contacts.time_of(row[name]) for row in rows) or 0.0 for name in excess}
    tightest = min(excess, key=lambda name: excess[name])
    fastest = min(seconds, key=lambda name: seconds[name])
    return Verdict(
        "**It is not the barrier that makes the augmentation loose.** From the same starts and with area descent, IPC "
        f"as published in 2020 leaves {excess['IPC 2020']:.1f} % after reinflation alone, El Topo "
        f"{excess['El Topo']:.1f} %, its simplification {excess['velocity filter']:.1f} %, our IPC "
        f"{excess['IPC']:.1f} % and the energy of 2022, even by Newton steps, {excess[contacts_last()]:.1f} % (medians "
        f"of {len(rows)} shapes that all solve). The tightest is {tightest}, the fastest {fastest}: our IPC takes "
        f"{1e3 * seconds['IPC']:.0f} ms where that of 2020 takes {1e3 * seconds['IPC 2020']:.0f}.",
        excess["IPC 2020"] < excess[contacts_last()] and excess["El Topo"] < excess[contacts_last()]
        and tightest == "IPC 2020" and fastest == "IPC",
    )  # fmt: skip


def contacts_last() -> str:
    """The modified energy of 2022."""
    return "paper's energy, Newton"


def tightening_levels(found: Found) -> Verdict:
    """What is left of the differences."""
    before, after = (contacts.solved_by_all(found["contacts"], variant) for variant in (DESCENT, TIGHTENED))
    first = [median(row[name].excess for row in before) or 0.0 for name in contacts.contacts_with(DESCENT)]
    last = [median(row[name].excess for row in after) or 0.0 for name in contacts.contacts_with(TIGHTENED)]
    spread = (max(first) - min(first), max(last) - min(last))
    return Verdict(
        "**After the same tightening the contacts are alike.** Medians after reinflation lie "
        f"{spread[0]:.1f} points apart, after the tightening {spread[1]:.2f} ({min(last):.2f} to {max(last):.2f} %): "
        "which contact brought the fine mesh back matters for time and failures, not for the cage.",
        spread[1] <= SAME * spread[0],
    )


def tightness_is_a_parameter(found: Found) -> Verdict:
    """Single settings say little."""
    made = sweeps.points(found["sweeps"])
    ours, original = sweeps.spread(made, "IPC"), sweeps.spread(made, "El Topo")
    default = made["IPC, default"].above
    others = [made[f"{name}, default"].above for name in methods.ALONE if f"{name}, default" in made]
    front = [point.label.split(",")[0] for point in sweeps.front(made)]
    return Verdict(
        "**How tight a contact is by itself is a parameter.** Our IPC lies "
        f"{default:.1f} points above the tightest run with its default and {ours[0]:.1f} to {ours[1]:.1f} over its "
        f"parameters; El Topo {original[0]:.1f} to {original[1]:.1f}; the defaults of all contacts spread over "
        f"{max(others) - min(others):.1f}. On the Pareto front of time, tightness and failures are "
        f"{len(set(front))} of {len(methods.ALONE)} contacts: {', '.join(dict.fromkeys(front))}.",
        ours[0] <= 0.7 * default and len(set(front)) >= 2,
    )


def growth(found: Found) -> Verdict:
    """Who is there for large meshes."""
    rows = found["scaling"]
    reached = {
        name: max((len(r.fine.vertices) for r in scaling.series(rows, name)), default=0) for name in methods.ALONE
    }
    largest = max(int(shape.split(" in ")[0]) for shape in rows)
    programs = [run for run in scaling.series(rows, "sequential QP") if len(run.fine.vertices) == largest]
    last = f" ({programs[0].seconds['reinflation']:.1f} s and {programs[0].megabytes:.0f} MB there)" if programs else ""
    told = ", ".join(f"{name} {reached[name]:,}" for name in methods.ALONE if name != "sequential QP")
    return Verdict(
        f"**For large meshes, sequential quadratic programs.** Within {scaling.LIMIT:.0f} s they bring "
        f"{reached['sequential QP']:,} vertices back{last}. The largest that the others succeed on: {told}.",
        reached["sequential QP"] == max(reached.values()),
    )


def text_and_program(found: Found) -> Verdict:
    """Which weights, new samples, reuse."""
    rows = found["flows"]
    inside = {name: flows.entered(rows, name) for name in methods.FLOWS}
    shared = [r for r in rows.values() if all(r[n].failed != "flow" for n in (flows.PROGRAM, flows.TEXT))]
    steps = {n: statistics.mean(r[n].flow_steps for r in shared) for n in (flows.PROGRAM, flows.TEXT)}
    ratio = statistics.geometric_mean(reuse.saved(found["reuse"]))
    return Verdict(
        "**Weights, samples and kept trees matter little.** The flow with the weights of the text gets inside on "
        f"{inside[flows.TEXT]} of {len(rows)} shapes, with those of the program on {inside[flows.PROGRAM]} "
        f"({steps[flows.TEXT]:.0f} and {steps[flows.PROGRAM]:.0f} steps in the mean), with new samples at each step on "
        f"{inside[flows.NEW]} where fixed ones reach {inside[flows.FIXED]}; the two-sided flow on "
        f"{inside[flows.TWO_SIDED]}. Trees kept from the flow make the reinflation take {ratio:.2f} times as long as "
        "trees built anew.",
        inside[flows.TWO_SIDED] >= max(inside.values())
        and abs(inside[flows.TEXT] - inside[flows.PROGRAM]) <= 0.1 * len(rows)
        and abs(inside[flows.NEW] - inside[flows.FIXED]) <= 0.1 * len(rows)
        and 0.7 <= ratio <= 1.3,
    )


CONCLUSIONS = (
    Conclusion("original", ("figures", "random shapes"), original_against_augmentation, "random-shapes.md"),
    Conclusion("barrier", ("contacts",), barrier_is_not_to_blame, "contacts.md"),
    Conclusion("tightening", ("contacts",), tightening_levels, "contacts.md"),
    Conclusion("parameters", ("sweeps",), tightness_is_a_parameter, "sweeps.md"),
    Conclusion("growth", ("scaling",), growth, "scaling.md"),
    Conclusion("flow", ("flows", "reuse"), text_and_program, "flows.md"),
)

CONFIRMED = ("original", "barrier", "tightening")
"""Those that are tried again on shapes that the runs do not contain."""


def verdicts(found: Found) -> dict[Conclusion, Verdict]:
    """The conclusions whose experiments were run."""
    return {c: c.judge(found) for c in CONCLUSIONS if all(found.get(name) for name in c.needs)}


def summary_rows(found: Found) -> list[list[str]]:
    """Whole methods: successes on figures and random shapes, excess and time where all leave a cage; Table 1."""
    names = [name for name in next(iter(found["figures"].values())) if name != "paper, Newton"]
    shapes = [*found["figures"].values(), *found["random shapes"].values()]
    shared = [shape for shape in shapes if all(shape[name].certified for name in names)]
    lines = []
    for name in names:
        rows = [shape[name] for shape in found["table 1"].values() if name in shape]
        lines.append([
            name, count(found["figures"], name), count(found["random shapes"], name),
            number(median(shape[name].excess for shape in shared), ".1f"),
            number(median(shape[name].total for shape in shared), ".3f"),
            number(median(run.excess for run in rows), ".1f"), number(median(run.total for run in rows), ".3f"),
        ])  # fmt: skip
    return lines


def contact_rows(found: Found) -> list[list[str]]:
    """Contacts from the same starts: failures, excess with and without descent, after the tightening, time."""
    results = found["contacts"]
    shared = {variant: contacts.solved_by_all(results, variant) for variant in (DESCENT, CLEARING, TIGHTENED)}
    lines = []
    for name in methods.ALONE:
        cells = [name]
        for variant in (DESCENT, CLEARING, TIGHTENED):
            has = name in contacts.contacts_with(variant)
            cells.append(number(median(row[name].excess for row in shared[variant])) if has else "–")
        own = DESCENT if name in contacts.contacts_with(DESCENT) else CLEARING
        seconds = median(contacts.time_of(row[name]) for row in shared[own]) or 0.0
        cells += [f"{1e3 * seconds:.1f}", f"{1.0 - contacts.successes(results, name, own):.1%}"]
        lines.append(cells)
    return lines
