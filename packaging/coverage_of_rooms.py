"""Lines of each room of the core that the last run of coverage.py saw: ``make coverage``.

Exit status 1 if they are fewer than `LEAST` in a room that it names.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LEAST = {"all": 95.0, "motion": 95.0, "verification": 95.0}
"""Percentages: of the whole, and of the rooms that certify."""


def main() -> int:
    """Print the share of every room, and of the whole."""
    command = [sys.executable, "-m", "coverage", "json", "--quiet", "-o", "-"]
    found = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
    lines, seen = Counter[str](), Counter[str]()
    for path, of_file in found["files"].items():
        room = Path(path).parts[1].removesuffix(".py")
        for name in (room, "all"):
            lines[name] += of_file["summary"]["num_statements"]
            seen[name] += of_file["summary"]["covered_lines"]
    shares = {name: 100.0 * seen[name] / max(1, count) for name, count in lines.items()}
    for name in sorted(shares, key=shares.__getitem__):
        print(f"{name:20} {shares[name]:5.1f} % of {lines[name]}")
    return int(any(shares[name] < least for name, least in LEAST.items()))


if __name__ == "__main__":
    sys.exit(main())
