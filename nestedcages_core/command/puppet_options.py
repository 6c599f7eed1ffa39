"""The options of `nested-cages puppet`, and its help."""

from __future__ import annotations

import argparse

from .options import at_least

ENGINES = ("godot", "spine", "script")

DESCRIPTION = """\
Makes a puppet of a layered painting: .psd, .psb, .ora, .kra, .svg, or a folder of .png by the order of their names.
Each layer becomes a textured mesh whose hull is certified around every opaque pixel, with bones where parts overlap,
weights, and for each joint the angles within which nothing folds, proved."""

EPILOG = """\
output files, by their names, several at once:
  NAME.tscn       a scene of Godot 4, with NAME.png
  NAME.json       Spine 4.2, with NAME.atlas and NAME.png
  NAME.puppet.json  your own script, with NAME.png

examples:
  nested-cages puppet cat.psd -o cat.tscn
  nested-cages puppet cat.kra -o cat.tscn --vertices 24 --parent hat=head --bones tail=4
"""


def _setting_of_part(text: str) -> tuple[str, str]:
    name, equals, value = text.rpartition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"PART=VALUE is needed, not {text!r}")
    return name, value


def parser() -> argparse.ArgumentParser:
    options = argparse.ArgumentParser(
        prog="nested-cages puppet",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("painting", metavar="PAINTING")
    options.add_argument("-o", "--output", nargs="+", required=True, metavar="FILE", help="files to write")
    options.add_argument("--engine", choices=ENGINES, help="the engine (default: by the names of the files)")
    options.add_argument(
        "--vertices",
        type=at_least(4),
        default=16,
        metavar="N",
        help="of the hull of a part; joints and small islands aside (default: %(default)s)",
    )
    options.add_argument("--hidden", action="store_true", help="include hidden layers, as hidden parts")
    options.add_argument(
        "--parent", type=_setting_of_part, action="append", metavar="PART=PARENT", help="what a part hangs on"
    )
    options.add_argument(
        "--bones", type=_setting_of_part, action="append", metavar="PART=N", help="how many bones bend a part"
    )
    options.add_argument(
        "--pixels",
        type=at_least(1),
        default=1024,
        metavar="N",
        help="of an .svg: pixels of its longer side (default: %(default)s)",
    )
    return options
