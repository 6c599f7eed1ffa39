"""The whole comparison: experiments, pages, the paper's own meshes, and the trial of conclusions on other shapes."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from comparison import conclusions, digest, plots, report, tables
from comparison.bench import Bench
from comparison.cases import Inputs, Sizes, read_inputs
from comparison.experiments import EXPERIMENTS, figures, panes

CONTRADICTED = 3
"""Exit status where the runs contradict a conclusion."""

CONFIRMING_SEED = 500_000
"""Of the shapes on which conclusions are tried again, so that the pages contain none of them."""

CONFIRMED_SHARE = 3
"""The trial has so many times fewer shapes for contacts alone."""


def run(options: argparse.Namespace, store: Path, papers: Path) -> int:
    """What the command was asked for; its exit status."""
    for name in options.only or ():
        if name not in EXPERIMENTS:
            sys.exit(f"There is no experiment {name!r}; there are {', '.join(EXPERIMENTS)}.")
    sizes = scaled(Sizes().larger(options.larger), options.smaller)
    inputs = read_inputs(options.paper, options.shapes, sizes)
    scope = digest.whole(digest.digests() | {"shapes": " ".join(inputs.shapes)})
    bench = Bench(options.jobs, store / scope)
    try:
        if options.confirm is not None:
            return confirm(inputs, bench, CONFIRMING_SEED if options.confirm < 0 else options.confirm)
        if options.paper:
            paper(inputs, bench, papers)
        return compare(inputs, bench, options.only, options.out)
    finally:
        bench.close()


def scaled(sizes: Sizes, part: int) -> Sizes:
    """A part of the random shapes, to try the command out."""
    if part <= 1:
        return sizes
    return replace(
        sizes, random=max(2, sizes.random // part), contact_random=max(3, sizes.contact_random // part),
        contact_glyphs=max(3, sizes.contact_glyphs // part), sweep=max(1, sizes.sweep // part),
        scaling=sizes.scaling[: max(3, len(sizes.scaling) // part)],
    )  # fmt: skip


def compare(inputs: Inputs, bench: Bench, only: list[str] | None, out: Path) -> int:
    """Run the experiments and write the pages."""
    pictures = out / "comparison"
    pictures.mkdir(parents=True, exist_ok=True)
    found = {name: EXPERIMENTS[name].run(inputs, bench) for name in EXPERIMENTS if name in (only or EXPERIMENTS)}
    runs = tables.write_runs(found, pictures / "runs.csv")
    tried = None if only else trial(inputs, bench, CONFIRMING_SEED)
    verdicts = report.write(found, inputs, out, runs, bench.seconds, bench.jobs, tried)
    digest.write(pictures)
    print(f"{out / 'comparison.md'}: {runs:,} runs in {bench.seconds / 60.0:.1f} minutes")
    if tried:
        print(tried)
    return told(verdicts)


def told(verdicts: dict[conclusions.Conclusion, conclusions.Verdict]) -> int:
    """Say which conclusions do not hold; the exit status."""
    broken = [(c, verdict) for c, verdict in verdicts.items() if not verdict.holds]
    for c, verdict in broken:
        print(f"CONTRADICTED: {c.name}. {verdict.text}")
    if verdicts and not broken:
        print(f"All {len(verdicts)} conclusions hold on these runs.")
    return CONTRADICTED if broken else 0


def confirm(inputs: Inputs, bench: Bench, seed: int) -> int:
    """Three conclusions on shapes that the pages do not contain; the exit status."""
    tried = trial(inputs, bench, seed)
    print(tried)
    return 0 if all(verdict.holds for verdict in tried.verdicts.values()) else CONTRADICTED


def trial(inputs: Inputs, bench: Bench, seed: int) -> conclusions.Trial:
    """Some conclusions on random shapes from another seed on."""
    share = max(3, inputs.sizes.contact_random // CONFIRMED_SHARE)
    other = replace(inputs, sizes=replace(inputs.sizes, first_seed=seed, contact_random=share, contact_glyphs=0))
    found = {name: EXPERIMENTS[name].run(other, bench) for name in ("contacts", "random shapes")}
    return conclusions.Trial(
        seed,
        {name: len(results) for name, results in found.items()},
        {c: c.judge(found) for c in conclusions.CONCLUSIONS if c.name in conclusions.CONFIRMED},
    )


def paper(inputs: Inputs, bench: Bench, folder: Path) -> None:
    """The paper's own meshes: what every method makes of them, and its figures. They are not ours to publish."""
    folder.mkdir(parents=True, exist_ok=True)
    own = {figure: inputs.paper[name] for figure, name in panes.PAPERS_OWN.items() if name in inputs.paper}
    if not own:
        print("The folder has none of the paper's meshes.")
        return
    drawn = panes.run_on(own, "the paper's figures", bench)
    plots.panes(drawn, folder / "figures.png")
    found = bench.compare("the paper's meshes", inputs.paper, figures.whole_methods())
    names = list(next(iter(found.values())))
    page = [
        "# The paper's own meshes", "![Figures](figures.png)",
        tables.matrix("shape", names, found, tables.excess_and_time),
    ]  # fmt: skip
    (folder / "paper.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")
    print(f"{folder / 'paper.md'} and its picture are of the paper's meshes: not for publication")
