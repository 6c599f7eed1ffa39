"""Every known attack and thousands of documents that are nearly right, and how many were held, as a table.

    python benchmarks/robustness.py --examples 3000 --seed 20260101 --output docs/measured/robustness.txt

Held is a call that ends with a result or with one sentence that says what is wrong, within 10 s of processor time and
700 MB. Exit status 1 when one was not. Needs hypothesis.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

import clone  # noqa: F401
from hostile.attacks import ATTACKS
from hostile.outcome import MEGABYTES, SECONDS, Outcome, outcome
from hostile.readers import READERS
from page import stamp

FAULTS_SHOWN = 5
"""Faults of each kind of attack that are printed."""


@dataclass
class Row:
    """What became of one kind of attack."""

    name: str
    cases: int = 0
    results: int = 0
    faults: list[str] = field(default_factory=list)

    def add(self, found: Outcome) -> None:
        """Count an outcome."""
        self.cases += 1
        self.results += not found.fault and not found.told
        if found.fault:
            self.faults.append(found.fault)

    @property
    def held(self) -> int:
        """Calls that ended as they should."""
        return self.cases - len(self.faults)


def known_attacks() -> Iterator[Row]:
    """One row for each attack of the list."""
    for name, calls in ATTACKS.items():
        row = Row(name)
        for call in calls():
            row.add(outcome(call))
        yield row


def random_documents(examples: int, first: int) -> Iterator[Row]:
    """One row for each reader and its grammar."""
    for name, (strategy, read) in READERS.items():
        row = Row(f"random: {name}")
        for document in drawn(strategy, examples, first):
            row.add(outcome(partial(read, document)))
        yield row


def drawn(strategy: st.SearchStrategy[Any], examples: int, first: int) -> Iterable[Any]:
    """So many examples of a grammar."""
    found: list[Any] = []
    quiet = settings(
        max_examples=examples, database=None, deadline=None, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip

    def keep(document: Any) -> None:
        found.append(document)

    collect: Callable[[], None] = seed(first)(quiet(given(strategy)(keep)))
    collect()
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--examples", type=int, default=3000, help="documents of each grammar")
    parser.add_argument("--seed", type=int, default=20_260_101, help="where their random numbers begin")
    parser.add_argument("--output", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    rows = []
    for row in (*known_attacks(), *random_documents(options.examples, options.seed)):
        print(f"{row.name}: {row.held} of {row.cases} held", flush=True)
        for fault in row.faults[:FAULTS_SHOWN]:
            print(f"  {fault}", flush=True)
        rows.append(row)
    if options.output:
        options.output.write_text(page(rows, options), encoding="utf-8")
    return 1 if any(row.faults for row in rows) else 0


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The command, its commit and date, and the rows as a table."""
    lines = [
        f"python benchmarks/robustness.py --examples {options.examples} --seed {options.seed} "
        f"--output {options.output}",
        stamp(),
        "",
        "A call is held if it ends with a valid result or with one sentence that says what is wrong, within "
        f"{SECONDS:g} s of",
        f"processor time and {MEGABYTES} MB.",
        "",
        "| attack | cases | held | with a result | with a sentence |",
        "|---|---:|---:|---:|---:|",
        *(
            f"| {row.name} | {row.cases:,} | {row.held:,} | {row.results:,} | {row.held - row.results:,} |"
            for row in rows
        ),
    ]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    sys.exit(main())
