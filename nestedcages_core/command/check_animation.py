"""`nested-cages check FILE.blend`: the animation in a file of Blender, checked by the add-on."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from .progress import tell

WRONG = 1
"""Exit status for a file that is not there."""


def check_animation(path: Path) -> int:
    """Check what Blender plays of a file, by the add-on's own program; its exit status."""
    for needed in (path, program := Path(__file__).resolve().parents[2] / "addon" / "__main__.py"):
        if not needed.is_file():
            tell(f"error: {needed}: No such file", sys.stderr)
            return WRONG
    return subprocess.run([sys.executable, program, path], check=False).returncode
