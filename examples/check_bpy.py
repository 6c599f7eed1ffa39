"""Says whether Blender's Python module can be imported and, if not, which system packages to install.

Run as ``python examples/check_bpy.py``; exit status 1 if bpy cannot be imported.
"""

from __future__ import annotations

import ctypes
import re
import sys

# The libraries that bpy loads from the system on Linux, with the packages of Debian and Fedora that bring them.
LIBRARIES = """
libGL.so.1 libgl1 libglvnd-glx
libEGL.so.1 libegl1 libglvnd-egl
libX11.so.6 libx11-6 libX11
libXext.so.6 libxext6 libXext
libXfixes.so.3 libxfixes3 libXfixes
libXi.so.6 libxi6 libXi
libXrender.so.1 libxrender1 libXrender
libXt.so.6 libxt6 libXt
libXxf86vm.so.1 libxxf86vm1 libXxf86vm
libxkbcommon.so.0 libxkbcommon0 libxkbcommon
libxcb.so.1 libxcb1 libxcb
libSM.so.6 libsm6 libSM
libICE.so.6 libice6 libICE
libgomp.so.1 libgomp1 libgomp
libstdc++.so.6 libstdc++6 libstdc++
libgcc_s.so.1 libgcc-s1 libgcc
"""


def is_missing(library: str) -> bool:
    """Whether the system's loader does not find a library."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return True
    return False


def advice(message: str) -> str:
    """What to install, given the message of the error that ``import bpy`` raised."""
    named = re.search(r"(lib[\w+.-]+?\.so(?:\.\d+)*): cannot open shared object file", message)
    if named is None:
        return (
            f"Blender's Python module cannot be imported ({message}): install bpy 5.0.1 for Python 3.11 or bpy 5.2.3 "
            "for Python 3.13 with pip, or run 'make clean' and this command again."
        )
    rows = [line.split() for line in LIBRARIES.split("\n") if line]
    missing = [row for row in rows if row[0] == named[1] or is_missing(row[0])]
    if named[1] not in {row[0] for row in missing}:
        return (
            f"Blender's Python module needs {named[1]} from the system: 'apt-file search {named[1]}' names its package."
        )
    libraries, debian, fedora = (" ".join(names) for names in zip(*missing, strict=True))
    packages = f"{debian} (Debian, Ubuntu) or {fedora} (Fedora)"
    return f"Blender's Python module needs {libraries} from the system: install {packages}."


if __name__ == "__main__":
    try:
        import bpy  # noqa: F401
    except ImportError as error:
        sys.exit(advice(str(error)))
