"""Lines of each room of the core that the last run of coverage.py saw: ``make coverage``."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


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
    for name in sorted(lines, key=lambda name: seen[name] / max(1, lines[name])):
        print(f"{name:20} {100.0 * seen[name] / max(1, lines[name]):5.1f} % of {lines[name]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
