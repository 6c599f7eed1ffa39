"""The README for package indexes, which know no relative links; everything else is in pyproject.toml.

With REPOSITORY_URL, such as https://host/owner/name, pictures and links lead there. Without it they are left out.
"""

import os
import re
from pathlib import Path

from setuptools import setup


def for_an_index(readme: str, repository: str | None) -> str:
    """The README with absolute links, or without pictures and relative links where the repository is not known."""
    relative = r"\((?!https?:|#)([^)\s]+)\)"
    if repository:
        readme = re.sub(rf"(!\[[^\]]*\]){relative}", rf"\1({repository}/raw/main/\2)", readme)
        return re.sub(rf"(?<!!)(\[[^\]]*\]){relative}", rf"\1({repository}/blob/main/\2)", readme)
    readme = re.sub(rf"\n *!\[[^\]]*\]{relative}\n", "", readme)
    return re.sub(rf"\[([^\]]*)\]{relative}", r"\1", readme)


def links(repository: str | None) -> dict[str, str]:
    """Addresses for package indexes; none where the repository is not known."""
    pages = {"Source": "", "Documentation": "/blob/main/README.md#documentation", "Issues": "/issues"}
    pages["Changelog"] = "/blob/main/CHANGELOG.md"
    return {name: repository + page for name, page in pages.items()} if repository else {}


if __name__ == "__main__":
    text = (Path(__file__).parent / "README.md").read_text(encoding="utf-8")
    repository = os.environ.get("REPOSITORY_URL", "").rstrip("/") or None
    setup(
        project_urls=links(repository),
        long_description=for_an_index(text, repository),
        long_description_content_type="text/markdown",
    )
