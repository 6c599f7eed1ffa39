"""`nested-cages check`: a result of drawings, or the animation in a file of Blender."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from .printing import tell


def run(options: argparse.ArgumentParser, given: argparse.Namespace) -> bool:
    """Run the command; whether something does not hold, or cannot be read."""
    if len(given.drawing) == 1:
        if not given.drawing[0].lower().endswith(".blend"):
            options.error("the drawing and the result are needed")
        return _animation_fails(Path(given.drawing[0]))
    from .check_files import files_fail  # needs shapely, which an animation does not

    return files_fail(given)


def _animation_fails(path: Path) -> bool:
    """Check what Blender plays of a file, by the add-on's own program."""
    for needed in (path, program := Path(__file__).resolve().parents[2] / "addon" / "__main__.py"):
        if not needed.is_file():
            tell(f"error: {needed}: No such file", sys.stderr)
            return True
    return subprocess.run([sys.executable, program, path], check=False).returncode != 0
