"""Public drawings and maps by one command: how many get a cage, the ink outside, CPU time and memory.

    python benchmarks/public.py [--files 36] [--features 40]

Fetches packages with npm and apt-get as the machine is set up for, into build/; nothing of them is kept in the
repository. 34 sets of drawings, see painted.py, and the maps of 11 packages, see maps.py; half an hour.
"""

from __future__ import annotations

import argparse
import sys

import maps
import painted


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--files", type=int, default=36, help="drawings of each set")
    options.add_argument("--features", type=int, default=40, help="features of each package of maps")
    options.add_argument("--jobs", type=int, default=2, help="processes for drawings")
    options.add_argument("--seed", type=int, default=0, help="which of them")
    given = options.parse_args()
    seed = ["--seed", str(given.seed)]
    drawings = painted.main(["--files", str(given.files), "--jobs", str(given.jobs), *seed])
    return max(drawings, maps.main(["--features", str(given.features), *seed]))


if __name__ == "__main__":
    sys.exit(main())
