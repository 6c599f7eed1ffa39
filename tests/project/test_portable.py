"""File names stop neither Windows nor macOS."""

import re
import subprocess
from pathlib import PurePosixPath

import pytest

from support.sources import ROOT

RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
LONGEST_PATH = 120
"""Characters: Windows allows 260 with the folder of the clone."""


def test_names_of_files_are_allowed_and_distinct_everywhere() -> None:
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if done.returncode != 0:
        pytest.skip("not a clone")
    names = [name for name in done.stdout.decode("utf-8").split("\0") if name]
    assert len({name.casefold() for name in names}) == len(names)
    for name in names:
        assert not re.search(r'[<>:"|?*\\]', name), name
        assert len(name) <= LONGEST_PATH, name
        parts = PurePosixPath(name).parts
        assert not any(RESERVED.fullmatch(part) or part.endswith((".", " ")) for part in parts), name
