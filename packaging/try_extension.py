"""Installs the Linux zip into a clean Blender configuration and runs the operator from it.

    python packaging/try_extension.py [ZIP]

Needs Blender as a Python module. The check is that the installed extension, found under its extension name, makes
certified cages with the scipy that the zip carries: a scipy that this Python has of its own is hidden first.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

SCRIPT = """
import importlib.abc, sys, os

class OnlyBundled(importlib.abc.MetaPathFinder):
    "Refuses a scipy that does not come from the folder of Blender's extensions."
    def find_spec(self, name, path=None, target=None):
        if name == "scipy":
            own = [p for p in sys.path if os.environ["BLENDER_USER_RESOURCES"] in p]
            spec = importlib.machinery.PathFinder.find_spec(name, own)
            if spec is None:
                raise ModuleNotFoundError("No scipy was installed with the extension", name="scipy")
            return spec
        return None

sys.meta_path.insert(0, OnlyBundled())
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
done = bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=True, overwrite=True)
assert done == {"FINISHED"}, done
bpy.ops.curve.primitive_bezier_circle_add()
assert bpy.ops.object.nested_cages_generate(levels="12, 6") == {"FINISHED"}
from urllib.parse import urlparse
from urllib.request import url2pathname
from bl_operators.wm import WM_OT_doc_view_manual
page = WM_OT_doc_view_manual._lookup_rna_url("bpy.ops.object.nested_cages_generate", verbose=False)
assert page.endswith(".html") and os.path.isfile(url2pathname(urlparse(page).path)), page
import scipy
assert os.environ["BLENDER_USER_RESOURCES"] in scipy.__file__, scipy.__file__
from bl_ext.user_default.nested_cages import CageSet
cages = CageSet.of(bpy.context.object)
assert len(cages) == 2, [o.name for o in bpy.data.objects]
for cage, certificate in zip(cages, cages.certificates):
    print(cage.name, "-", certificate.sentence)
print("The installed extension works, with scipy", scipy.__version__, "from its own zip.")
sys.stdout.flush()
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.nested_cages")
os._exit(0)
"""


def main() -> int:
    if len(sys.argv) > 1:
        path = Path(sys.argv[1])
    else:
        kind = "blender4.2" if sys.version_info < (3, 13) else "blender5.1"
        zips = sorted((ROOT / "dist").glob(f"nested_cages-*+{kind}-linux_x64.zip"))
        path = next(iter(zips), ROOT / "dist" / "missing.zip")
    if not path.is_file():
        print(f"There is no zip at {path}: run packaging/build_extension.py first.", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "BLENDER_USER_RESOURCES": folder}
        command = [sys.executable, "-c", SCRIPT, str(path.resolve())]
        return subprocess.run(command, env=environment, cwd=folder, timeout=300, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
