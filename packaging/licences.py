"""What the wheels in the zips say of their licences, and of those of the libraries inside them."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterator
from email.message import Message
from email.parser import BytesParser
from pathlib import Path
from typing import Any

INSIDE = re.compile(r"^Name: (?P<name>.+)\n(?:.+\n)*?License: (?P<licence>.+)$", re.MULTILINE)
"""How the licence files of wheels list the libraries that are compiled into them."""


def licences(wheels: list[Path]) -> list[str]:
    """Name, version and licence of each bundled package, then of each library inside it, as its wheel says.

    Raises SystemExit where a wheel says none.
    """
    packages: dict[str, set[str]] = {}
    for path in wheels:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            metadata = archive.read(next(name for name in names if name.endswith(".dist-info/METADATA")))
            boms = [name for name in names if re.search(r"\.dist-info/sboms/.*\.json$", name)]
            inside = {line for name in boms for line in _components(json.loads(archive.read(name)))}
            texts = [name for name in names if re.search(r"\.dist-info/(licenses/)?LICEN[SC]E", name)]
            inside |= {
                f"  in it {found['name'].strip()}: {found['licence'].strip()}"
                for name in texts
                for found in INSIDE.finditer(archive.read(name).decode("utf-8").replace("\r\n", "\n"))
            }
        told = BytesParser().parsebytes(metadata)
        packages.setdefault(f"{told['Name']} {told['Version']}: {_licence(told, path)}", set()).update(inside)
    return [line for package, inside in sorted(packages.items()) for line in (package, *sorted(inside))]


def _components(bom: dict[str, Any]) -> Iterator[str]:
    """The libraries that a bill of materials (CycloneDX) lists, other than parts of the package itself."""
    own = bom["metadata"]["component"].get("licenses")
    for component in bom.get("components", ()):
        licences = [each.get("expression") or each["license"]["id"] for each in component.get("licenses", ())]
        if licences and component["licenses"] != own:
            yield f"  in it {component['name']}: {', '.join(licences)}"


def _licence(told: Message, path: Path) -> str:
    """The licence that a wheel's metadata names."""
    classifiers = [entry.rpartition(":: ")[2] for entry in told.get_all("Classifier", []) if "License ::" in entry]
    first_line = (told["License"] or "").partition("\n")[0]
    licence: str = told["License-Expression"] or ", ".join(classifiers) or first_line
    if not licence:
        raise SystemExit(f"{path.name} does not say its licence.")
    return licence
