"""Says whether Blender's Python module can be imported and, if not, which system packages bring what it misses.

Run as ``python examples/check_bpy.py``; exit status 1 if bpy cannot be imported.
"""

from __future__ import annotations

import ctypes
import importlib
import re
import sys
from collections.abc import Callable, Iterable
from typing import NamedTuple


class Packages(NamedTuple):
    """Names of the packages that bring one library."""

    debian: str
    fedora: str


# What bpy 5.0 and 5.2 load from the system on Linux (their ELF headers name them), and who brings it.
LIBRARIES: dict[str, Packages] = {
    "libGL.so.1": Packages("libgl1", "libglvnd-glx"),
    "libEGL.so.1": Packages("libegl1", "libglvnd-egl"),
    "libX11.so.6": Packages("libx11-6", "libX11"),
    "libXext.so.6": Packages("libxext6", "libXext"),
    "libXfixes.so.3": Packages("libxfixes3", "libXfixes"),
    "libXi.so.6": Packages("libxi6", "libXi"),
    "libXrender.so.1": Packages("libxrender1", "libXrender"),
    "libXt.so.6": Packages("libxt6", "libXt"),
    "libXxf86vm.so.1": Packages("libxxf86vm1", "libXxf86vm"),
    "libxkbcommon.so.0": Packages("libxkbcommon0", "libxkbcommon"),
    "libxcb.so.1": Packages("libxcb1", "libxcb"),
    "libSM.so.6": Packages("libsm6", "libSM"),
    "libICE.so.6": Packages("libice6", "libICE"),
    "libgomp.so.1": Packages("libgomp1", "libgomp"),
    "libstdc++.so.6": Packages("libstdc++6", "libstdc++"),
    "libgcc_s.so.1": Packages("libgcc-s1", "libgcc"),
}

# Of these, the ones that no build of bpy can do without: looked for at once, so that one sentence names them all.
REQUIRED = (
    "libGL.so.1", "libX11.so.6", "libXext.so.6", "libXfixes.so.3", "libXi.so.6", "libXrender.so.1", "libXt.so.6",
    "libxkbcommon.so.0", "libSM.so.6", "libICE.so.6", "libstdc++.so.6", "libgcc_s.so.1",
)  # fmt: skip


def loads(library: str) -> bool:
    """Whether the system's loader finds `library`."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def library_in(message: str) -> str | None:
    """The library that an import error complains about, or None if it is about something else."""
    match = re.search(r"(lib[\w+.-]+?\.so(?:\.\d+)*): cannot open shared object file", message)
    return match.group(1) if match else None


def advice(message: str, is_there: Callable[[str], bool] = loads) -> str:
    """One sentence that says what to install, given the message of the error that `import bpy` raised."""
    named = library_in(message)
    if named is None:
        return (
            f"Blender's Python module cannot be imported ({message}): install bpy 5.0.1 for Python 3.11 or bpy 5.2.3 "
            "for Python 3.13 with pip, or run 'make clean' and this command again."
        )
    missing = [named, *(library for library in REQUIRED if library != named and not is_there(library))]
    known = [LIBRARIES[library] for library in missing if library in LIBRARIES]
    sentence = f"Blender's Python module needs {join(missing)} from the system: "
    if named not in LIBRARIES:
        sentence += f"'apt-file search {named}' or 'dnf provides \"*/{named}\"' names the package that brings {named}"
        sentence += "; also install " if known else ""
    else:
        sentence += "install "
    if known:
        debian, fedora = (" ".join(names) for names in zip(*known, strict=True))
        sentence += f"{debian} (Debian, Ubuntu) or {fedora} (Fedora)"
    return sentence + "."


def join(words: Iterable[str]) -> str:
    """Words as English lists them: a, b and c."""
    *head, last = words
    return f"{', '.join(head)} and {last}" if head else last


def main() -> int:
    try:
        importlib.import_module("bpy")
    except ImportError as error:
        print(advice(str(error)), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
