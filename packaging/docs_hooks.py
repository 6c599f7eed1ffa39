"""Hooks of mkdocs: links to the repository, the version, and formulas as MathML, which browsers show without a script.

REPOSITORY_URL, such as https://host/owner/name, gives the links; without it there are none.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parents[1]
CODE_OR_FORMULA = re.compile(r"(?P<code>^ *```.*?^ *```$|`[^`\n]*`)|\$(?P<formula>[^$]+)\$", re.DOTALL | re.MULTILINE)
VERSION = re.compile(r'^__version__ = "(.*)"$', re.MULTILINE)


def on_config(config: Any) -> Any:
    """Name the version at the end of each page, and the repository if it is known."""
    source = (ROOT / "nestedcages_core" / "__init__.py").read_text(encoding="utf-8")
    version = VERSION.findall(source)[0]
    config.copyright = f"Nested Cages {version}, GPL-3.0-or-later"
    repository = os.environ.get("REPOSITORY_URL", "").rstrip("/")
    if repository:
        config.repo_url, config.edit_uri = repository, "edit/main/"
        config.copyright += f' · <a href="{repository}/issues">Report an issue</a>'
    return config


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Formulas between dollar signs as MathML, but for those in code."""
    return CODE_OR_FORMULA.sub(_set, markdown)


def _set(found: re.Match[str]) -> str:
    return found["code"] or f"<span>{convert(found['formula'])}</span>"  # a line that begins with <math> is a block
