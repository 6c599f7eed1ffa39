"""What does each contact reach by itself, all of them from the same starts?"""

from __future__ import annotations

import statistics
from collections import Counter
from pathlib import Path

from comparison import methods, plots
from comparison.bench import Bench
from comparison.cases import Inputs
from comparison.measure import Measurement, Results, Started, measure, tightened
from comparison.starts import is_real, starts
from comparison.tables import median, number, table
from nestedcages_core import Mesh, Settings

DESCENT, CLEARING, TIGHTENED = "area descent", "no energy", "tightened"
LIMIT = 5.0  # CPU seconds of a run


def label(contact: str, variant: str) -> str:
    """Name of a method."""
    return f"{contact}, {variant}"


def run(inputs: Inputs, bench: Bench) -> Results:
    """Every contact with and without the area as its energy, and with the tightening after it."""
    cases = starts(bench, inputs.sizes.contact_random, inputs.sizes.contact_glyphs, inputs.sizes.first_seed)
    tasks = {
        (shape, contact, variant): (methods.alone(made), fine, start, variant == DESCENT or alone.descent is None)
        for shape, (fine, start) in cases.items()
        for contact, alone in methods.ALONE.items()
        for variant, made in ((DESCENT, alone.descent), (CLEARING, alone.clearing))
        if made is not None
    }
    found: Results = {shape: {} for shape in cases}
    for (shape, contact, variant), runs in bench.each("contacts", both, tasks, _outcome).items():
        found[shape][label(contact, variant)] = runs[0]
        for run in runs[1:]:
            found[shape][label(contact, TIGHTENED)] = run
    return found


def both(settings: Settings, fine: Mesh, start: Started, and_tightened: bool) -> list[Measurement]:
    """A contact by itself, and the same with the tightening after it where that is asked for."""
    alone = measure(settings, fine, start, 1, LIMIT)
    return [alone, tightened(alone)] if and_tightened else [alone]


def _outcome(runs: list[Measurement]) -> str:
    return "ok" if runs[0].success else f"{runs[0].failed} {runs[0].problem[:60]}"


def contacts_with(variant: str) -> list[str]:
    """The contacts that have a variant."""
    return [name for name, contact in methods.ALONE.items() if variant != DESCENT or contact.descent is not None]


def solved_by_all(found: Results, variant: str) -> list[dict[str, Measurement]]:
    """The shapes on which every contact succeeds; contact -> run."""
    names = contacts_with(variant)
    rows = [{name: runs[label(name, variant)] for name in names} for runs in found.values()]
    return [row for row in rows if all(run.success for run in row.values())]


def successes(found: Results, contact: str, variant: str) -> float:
    """Share of the shapes on which a contact succeeds."""
    return statistics.mean(runs[label(contact, variant)].success for runs in found.values())


def time_of(run: Measurement) -> float:
    """CPU seconds of the reinflation alone."""
    return run.seconds.get("reinflation", 0.0)


def section(found: Results, inputs: Inputs, pictures: Path) -> str:
    """Successes, excess and time of every contact; how it fails; and what the tightening leaves of the differences."""
    plots.contacts(found, pictures / "contacts.png")
    real = sum(is_real(shape) for shape in found)
    sizes = [len(next(iter(runs.values())).fine.vertices) for runs in found.values()]
    parts = [
        "## Contacts from the same starts, after reinflation alone",
        f"{len(found)} starts: {len(found) - real} random shapes of ten kinds and {real} glyphs of three fonts, of "
        f"{min(sizes)} to {max(sizes)} vertices, with coarse meshes on their curves and the fine mesh brought inside "
        "by the two-sided flow. Every contact gets the very same coarse mesh and the same steps of the flow, and is "
        f"judged when the fine mesh is back. A run is ended after {LIMIT:.0f} s. *Area descent*: the contact lowers "
        "the area on the way, each in its own manner. *No energy*: it only makes way; IPC of 2020 has the inertia of "
        "the cage instead, since its Newton steps need a minimum. Sequential quadratic programs know no energy. "
        "*Tightened*: the same tightening after each, with area descent where there is one. Excess, distance and "
        "seconds are medians over the shapes that all contacts of a table solve; seconds are of the reinflation.",
        "![Contacts](contacts.png)",
    ]  # fmt: skip
    for variant in (DESCENT, CLEARING, TIGHTENED):
        shared = solved_by_all(found, variant)
        lines = []
        for name in contacts_with(variant):
            runs = [shape[label(name, variant)] for shape in found.values()]
            kinds = {
                real: [r for s, r in zip(found, runs, strict=True) if is_real(s) is real] for real in (False, True)
            }
            own = [row[name] for row in shared]
            times = sorted(time_of(run) for run in own)
            lines.append([
                name, *(f"{sum(run.success for run in kinds[real])} of {len(kinds[real])}" for real in kinds),
                number(median(run.excess for run in own)), number(median(run.smallest for run in own), ".0e"),
                number(median(times), ".4f"), number(times[int(0.9 * (len(times) - 1))] if times else None, ".3f"),
                number(median(float(run.iterations) for run in own), ".0f"),
            ])  # fmt: skip
        parts += [
            f"### {variant.capitalize()}",
            f"{len(shared)} shapes that all solve.",
            table(["contact", "random", "glyphs", "excess %", "distance", "s", "s, 90 %", "systems"], lines),
        ]
    parts += ["### How they fail", table(["contact", *FAILURES], [_failures(found, name) for name in methods.ALONE])]
    return "\n\n".join(parts)


FAILURES = ("held up", "out of time", "in contact at the end", "crosses on the way", "other")


def _failures(found: Results, contact: str) -> list[str]:
    kinds: Counter[str] = Counter()
    for runs in found.values():
        for variant in (DESCENT, CLEARING):
            run = runs.get(label(contact, variant))
            if run is not None and not run.success:
                kinds[kind_of_failure(run)] += 1
    return [contact, *(str(kinds[kind]) for kind in FAILURES)]


def kind_of_failure(run: Measurement) -> str:
    """What became of a run that did not succeed."""
    if run.out_of_time:
        return "out of time"
    if "in contact" in run.problem:
        return "in contact at the end"
    if "holds up" in run.problem or "lets fine vertex" in run.problem or "short of its target" in run.problem:
        return "held up"
    return "crosses on the way" if not run.failed and run.certified else "other"


def finding(found: Results, inputs: Inputs) -> str:
    """Who is tightest and fastest by itself, and what is left of it."""
    told = []
    for variant in (DESCENT, CLEARING):
        rows = solved_by_all(found, variant)
        ranks = [
            f"{name} {number(median(row[name].excess for row in rows))} % in "
            f"{1e3 * (median(time_of(row[name]) for row in rows) or 0.0):.1f} ms "
            f"({100.0 * successes(found, name, variant):.0f} % succeed)"
            for name in sorted(contacts_with(variant), key=lambda name: median(row[name].excess for row in rows) or 0.0)
        ]
        told.append(f"With {variant}, on {len(rows)} shapes that all solve, from the tightest: {'; '.join(ranks)}.")
    return "**Contacts alone.** " + " ".join(told)
