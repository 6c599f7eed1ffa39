"""What is imported when it is needed: optional libraries, and parts of packages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from sys import modules
from typing import Any

from .errors import NestedCagesError


@contextmanager
def needed(name: str, purpose: str) -> Iterator[None]:
    """Raises NestedCagesError where the library is missing; purpose: the subject, such as "Merging parts"."""
    try:
        yield
    except ImportError as error:
        problem = f"{purpose} needs {name}; install it with 'pip install {name}'."
        raise NestedCagesError(problem, code="dependency.missing", library=name) from error


def load_shapely(purpose: str) -> Any:
    """shapely (GEOS), for the subject of a sentence. Raises NestedCagesError where it is missing."""
    with needed("shapely", purpose):
        import shapely
    return shapely


def has_shapely() -> bool:
    """Whether shapely can be imported."""
    try:
        load_shapely("This")
    except NestedCagesError:
        return False
    return True


def load_pyplot() -> Any:
    """The plots of matplotlib. Raises NestedCagesError where it is missing."""
    with needed("matplotlib", "A plot"):
        from matplotlib import pyplot as plt
    return plt


def imported_later(package: str, names: Mapping[str, str]) -> Callable[[str], object]:
    """The ``__getattr__`` of a package whose names are imported when they are asked for.

    Parameters
    ----------
    package : str
        The ``__name__`` of the package.
    names : Mapping[str, str]
        For each of its modules the names that the package passes on from it, separated by spaces.

    Returns
    -------
    Callable
        Returns a name, or a module, of the package. Raises AttributeError for others.
    """
    module_of = {name: module for module, listed in names.items() for name in listed.split()}

    def find(name: str) -> object:
        if name not in module_of and name not in names:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = import_module(f".{module_of.get(name, name)}", package)
        value = getattr(module, name) if name in module_of else module
        setattr(modules[package], name, value)  # importing a module has set its own name
        return value

    return find
