"""How long it takes to start: the import, the first cage, and the command from a drawing to its cage.

    python benchmarks/start.py [--repeats 5]

Each in a new process with compiled modules in place; CPU seconds, the least of the repeats. All include the import of
numpy.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from clone import ROOT
from data.drawn import blob
from nestedcages_core import write_svg

FIRST_CAGE = """
from nestedcages_core import Mesh, nested_cages
import numpy as np
angle = 2.0 * np.pi * np.arange(300) / 300
radius = 1.0 + 0.3 * np.cos(7.0 * angle)
nested_cages(Mesh.from_loops([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)]), [32])
"""

DRAWING = "examples/letter_a.svg"
VERTICES = 500
"""Of another drawing."""


def seconds(command: list[str], environment: dict[str, str]) -> float:
    """CPU seconds of a command that must succeed."""
    before, began = os.times(), time.perf_counter()
    subprocess.run([sys.executable, *command], cwd=ROOT, env=environment, check=True, capture_output=True)
    after, wall = os.times(), time.perf_counter() - began
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return used or wall  # Windows does not tell what children have used


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5, help="of which the least counts (%(default)s)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder, "OPENBLAS_NUM_THREADS": "1"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        other = Path(folder) / "blob.svg"
        write_svg(other, blob(VERTICES))
        cases = {
            "import numpy": ["-c", "import numpy"],
            "import nestedcages_core": ["-c", "import nestedcages_core"],
            "first cage, 32 vertices around 300": ["-c", FIRST_CAGE],
        }
        for name, drawing in ((DRAWING, DRAWING), (f"blob.svg, {VERTICES} vertices,", str(other))):
            output = str(Path(folder) / "cages.svg")
            command = ["-m", "nestedcages_core", drawing, "--levels", "32", "--output", output]
            cases[f"nested-cages {name} --levels 32"] = command
        print("| | CPU seconds |\n|---|---|")
        for name, command in cases.items():
            seconds(command, environment)  # compiles
            print(f"| {name} | {min(seconds(command, environment) for _ in range(options.repeats)):.2f} |", flush=True)


if __name__ == "__main__":
    main()
