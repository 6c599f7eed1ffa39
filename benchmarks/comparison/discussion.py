"""What the measurements say, in sentences whose numbers and verdicts are computed from them."""

from __future__ import annotations

import statistics
from itertools import pairwise

from comparison.experiments import Results
from comparison.findings import Findings, share
from comparison.measure import Measurement
from comparison.methods import CONTACTS, STARTS
from data import Table1Row


def discussion(found: Findings, rows: tuple[Table1Row, ...]) -> list[str]:
    """Where each method wins, where ours loses, what remains open."""
    parts = [
        "## Discussion", _fidelity(found.table1, rows), _robustness(found), _improvements(found.ladder),
        _contacts(found), _starts(found.starts), _alone(found.alone), _filters(found), _energies(found.energies),
        "**What remains open.** The contacts end, after the same tightening, in the local optimum that the start leads "
        "to; none of them moves a vertex from one side of a shape to where it is needed more. The paper's program has "
        "lengths in absolute units; here they are those of its Table 1 relative to the diagonal, so that on other "
        "shapes its range and its flow's step are our reading. Its flow is kept as it is, with its failures to get "
        "inside. Sacht et al. fall back on asynchronous contact mechanics where their filter makes no progress; here "
        "single vertices are slowed down instead, and impulses are soft by a ten-thousandth so that every program has "
        "a solution. The shapes are few, planar, and the fine meshes small: growth and random shapes are measured by "
        "other benchmarks, for ours alone.",
    ]  # fmt: skip
    return [part for part in parts if part]


def _fidelity(results: Results, rows: tuple[Table1Row, ...]) -> str:
    runs = [(line, results[str(line.fine_vertices)]) for line in rows if line.reference_excess]
    gaps = [
        abs(run["paper as written"].excess - line.reference_excess)
        for line, run in runs
        if run["paper as written"].excess is not None
    ]
    if not gaps:
        return ""
    short = [run["paper as written"].short for _, run in runs if run["paper as written"].short is not None]
    faster = [line.reference_seconds / run["IPC"].total for line, run in runs]
    above = [run["IPC"].excess - line.optimum_excess for line, run in runs if line.optimum_excess]
    return (
        f"**The paper as written is the paper.** On {len(gaps)} of {len(rows)} rows of Table 1 it ends with a cage, "
        f"and everywhere the excess agrees with that of the C++ program within {max(gaps):.2f} points. As there, the "
        f"fine mesh never comes home: it rests {min(short):.0e} to {max(short):.0e} short of it, which is an error "
        "here. Ours (IPC, two-sided flow, tightening) is "
        f"{statistics.geometric_mean(faster):.0f} times faster than the C++ program in the geometric mean, "
        f"{min(faster):.0f} times at the least, and {min(above):+.2f} to {max(above):+.2f} points from the optimum on "
        "record."
    )


def _robustness(found: Findings) -> str:
    figures = found.figures
    written = [shape["paper as written"] for shape in figures.values()]
    repaired = [shape["paper repaired"] for shape in figures.values()]
    text = (
        f"**Robustness.** Of the {len(figures)} shapes of the figures the paper as written gets inside "
        f"{sum(run.failed != 'flow' for run in written)}; on {sum(run.certified for run in written)} it ends with a "
        f"cage that encloses the shape, and on {sum(run.short == 0.0 for run in written)} the fine mesh comes home. "
        f"With its three repairs it succeeds on {_count(figures, 'paper repaired')}; "
        f"failures in the flow: {sum(run.failed == 'flow' for run in repaired)}, in the reinflation: "
        f"{sum(run.failed == 'reinflation' for run in repaired)}, of which out of time: "
        f"{sum('ended after' in run.problem for run in repaired)}. "
        + "; ".join(f"{name} succeeds on {_count(figures, name)}" for name in CONTACTS)
        + "."
    )
    if found.starts:
        told = (f"{name} on {_count(found.starts, name)}" for name in next(iter(found.starts.values())))
        text += " On the shapes of the folder: " + "; ".join(told) + "."
    return text


def _improvements(results: Results) -> str:
    """What every line of the ladder changes, where it and the line before ended with a cage."""
    changes: dict[str, list[tuple[float, float]]] = {}
    for found in results.values():
        for before, after in pairwise(found.items()):
            if before[1].excess is not None and after[1].excess is not None:
                change = after[1].total / before[1].total, after[1].excess - before[1].excess
                changes.setdefault(after[0][2:], []).append(change)
    told = []
    for name, values in changes.items():
        times = statistics.geometric_mean(ratio for ratio, _ in values)
        points = statistics.mean(points for _, points in values)
        told.append(f"{name}: time × {times:.2g}, excess {points:+.2f} points")
    return (
        "**What each improvement does**, where a cage came out before and after it (geometric mean of the times, mean "
        "of the changes of excess): " + "; ".join(told) + "."
    )


def _contacts(found: Findings) -> str:
    """Contacts side by side where the flow has work to do, each followed by the tightening."""
    cases = [{name: shape[name] for name in CONTACTS} for shape in found.figures.values()]
    cases += [{name: shape[name] for name in CONTACTS} for shape in found.table1.values()]
    cases += [{name: shape[f"{name}, flow"] for name in CONTACTS} for shape in found.starts.values()]
    cases = [case for case in cases if all(run.success for run in case.values())]
    if not cases:
        return ""
    fastest = [min(case, key=lambda name: case[name].total) for case in cases]
    told = []
    for name in CONTACTS:
        ratios = [case[name].total / min(run.total for run in case.values()) for case in cases]
        told.append(
            f"{name} is the fastest on {fastest.count(name)} and takes {statistics.median(ratios):.2f} times the "
            f"fastest in the median, {max(ratios):.1f} times at the worst"
        )
    spreads = [_spread(list(case.values())) for case in cases]
    behind = {
        name: sum(case[name].excess > min(run.excess for run in case.values()) + 0.005 for case in cases)
        for name in CONTACTS
    }
    return (
        f"**Contacts.** Of {len(cases)} cases that all three solve, " + "; ".join(told) + ". Their excess after "
        f"tightening differs by {statistics.median(spreads):.3f} points in the median and {max(spreads):.2f} at the "
        "most; not the tightest by more than 0.005 points: "
        + ", ".join(f"{name} on {count}" for name, count in behind.items())
        + "."
    )


def _starts(results: Results) -> str:
    if not results:
        return ""
    contacts, starts, best = [], [], dict.fromkeys(STARTS, 0)
    for shape in results.values():
        for start in STARTS:
            contacts.append(_spread([shape[f"{name}, {start}"] for name in CONTACTS]))
        runs = {start: shape[f"IPC, {start}"] for start in STARTS}
        starts.append(_spread(list(runs.values())))
        good = {start: run for start, run in runs.items() if run.success}
        if good:
            best[min(good, key=lambda start: good[start].excess)] += 1
    return (
        "**Starts and contacts.** For a given start the contacts differ by "
        f"{statistics.mean(contacts):.2f} points of excess in the mean; for a given contact (IPC) the starts differ by "
        f"{statistics.mean(starts):.2f}. The tightest start is "
        + ", ".join(f"the {start} on {count}" for start, count in best.items())
        + f" of {len(results)} shapes."
    )


def _alone(results: Results) -> str:
    told = []
    for name in CONTACTS:
        values = [shape[name].excess for shape in results.values() if shape[name].success]
        if values:
            told.append(f"{name} {statistics.mean(values):.2f} % (successes: {_count(results, name)})")
    return (
        "**Without the tightening** the mean excess is: " + "; ".join(told) + ". The filter descends on the area at "
        "every step of the flow, and pays for it in iterations; IPC is left where its barrier balances the area, and "
        "sequential QPs where they cleared the way."
    )


def _filters(found: Findings) -> str:
    names = list(next(iter(found.filters.values())))
    told = []
    for name in names:
        runs = [shape[name] for shape in found.filters.values()]
        seconds = sum(run.seconds.get("reinflation", 0.0) for run in runs)
        told.append(
            f"{name}: {sum(run.iterations for run in runs)} iterations, {seconds:.2f} s, "
            f"{sum(run.success for run in runs)} of {len(runs)}"
        )
    shares = [share(cost) for cost in found.reuse.values()]
    return (
        "**Step filters and broad phases** of IPC, all cases together: " + "; ".join(told) + ". The bound by the "
        "smallest distance is as safe as the time of impact, but the nearest pair slows all the others down. "
        f"**Reuse** of the flow's structures could save at most the building of lists, {min(shares):.0f} to "
        f"{max(shares):.0f} % of the reinflation here; they are already kept while little has moved, and the flow's "
        "would hold only for a cage that has not moved since. We did not build it."
    )


def _energies(results: Results) -> str:
    (runs,) = results.values()
    good = {name: run for name, run in runs.items() if run.success}
    if not good:
        return ""
    least = min(good, key=lambda name: good[name].excess)
    told = ", ".join(f"{name} {run.excess:.1f} %" for name, run in good.items())
    return (
        f"**Energies** on the letter A: {told}. The tightest is {least}; the pictures show what it costs, a hole that "
        "has turned in a drawing that was symmetric. Who wants the drawing's shape takes another."
    )


def _count(results: Results, name: str) -> str:
    tried = [shape[name] for shape in results.values() if name in shape]
    return f"{sum(run.success for run in tried)} of {len(tried)}"


def _spread(runs: list[Measurement]) -> float:
    """Largest minus smallest excess of the runs that succeeded."""
    values = [run.excess for run in runs if run.success and run.excess is not None]
    return max(values) - min(values) if values else 0.0
