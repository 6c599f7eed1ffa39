"""Prints the lowest versions that pyproject.toml accepts, as constraints for pip.

python packaging/lower_bounds.py > lowest.txt
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"


def main() -> int:
    for requirement in tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["dependencies"]:
        name, lowest = re.fullmatch(r"([\w-]+)>=([\d.]+)", requirement).groups()
        print(f"{name}=={lowest}.*")
    return 0


if __name__ == "__main__":
    sys.exit(main())
