"""Run benchmarks by name and print their tables.

    python benchmarks/run.py                                   # the names, one line each
    python benchmarks/run.py golden --against HEAD~1           # next to another commit, in the same run
    python benchmarks/run.py speed scaling --quick             # a small part, to try it out
    python benchmarks/run.py tightness --write                 # into docs/measured and the pages that show it

A benchmark is a file, or a folder with __init__.py, here or in a folder here, that has a docstring of one line and a
function ``run(options) -> str``. The name of a folder stands for all benchmarks in it. `common.Options` says what a
benchmark is asked for, `common.Server` runs a function with the package of another commit.
"""

from __future__ import annotations

import argparse
import ast
import os
import shlex
import sys
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path

for library in ("OMP", "OPENBLAS", "MKL", "VECLIB"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before numpy loads them: times are of one thread

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]  # a clone need not be installed

import pages  # noqa: E402
from common import Options, checkout  # noqa: E402


def benchmarks() -> dict[str, str]:
    """Name of each benchmark -> its first line."""
    found = {}
    for path in sorted([*HERE.glob("*.py"), *HERE.glob("*/*.py")]):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "run"]
        if any([argument.arg for argument in function.args.args] == ["options"] for function in functions):
            words = path.relative_to(HERE).with_suffix("").parts
            name = "/".join(words[:-1] if words[-1] == "__init__" else words)
            found[name] = (ast.get_docstring(tree) or "").partition("\n")[0]
    return found


def chosen(words: list[str], names: dict[str, str]) -> list[str]:
    """The benchmarks that words name: by name, by its last part, or all of a folder."""
    found: list[str] = []
    for word in words:
        fits = [name for name in names if word in (name, name.rpartition("/")[2], name.partition("/")[0])]
        if not fits:
            sys.exit(f"There is no benchmark {word!r}; there are {', '.join(names)}.")
        found += [name for name in fits if name not in found]
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="what to run; without any, the names are listed")
    parser.add_argument("--against", metavar="COMMIT", help="another commit, or a folder, measured in the same run")
    parser.add_argument("--quick", action="store_true", help="a small part of the work, to try the program")
    parser.add_argument("--seed", type=int, default=0, help="first seed of what is random (%(default)s)")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="parts whose names contain a word")
    parser.add_argument("--meshes", type=Path, metavar="FOLDER", help="the meshes of the paper, for figures --check")
    parser.add_argument("--check", action="store_true", help="compare with values that are known: status 1 if wrong")
    parser.add_argument("--write", action="store_true", help="into docs/measured/NAME.txt and the pages that show it")
    given = parser.parse_args()
    if given.write and given.only:
        parser.error("--write needs all parts; leave out --only")
    names = benchmarks()
    if not given.names:
        width = max(map(len, names))
        print("\n".join(f"{name:{width}}  {line}" for name, line in names.items()))
        return 0
    status = 0
    if given.write:
        pages.commit()  # what is measured, whatever changes meanwhile
    with ExitStack() as stack:
        against = stack.enter_context(checkout(given.against)) if given.against else None
        options = Options(given.quick, against, given.against or "", given.seed, given.meshes, tuple(given.only))
        for name in chosen(given.names, names):
            module = import_module(name.replace("/", "."))
            if given.check and not hasattr(module, "check"):
                continue
            printed = (module.check if given.check else module.run)(options).strip("\n")
            print(f"{name}\n{printed}\n", flush=True)
            status |= int("FAILED" in printed)
            if given.write and not given.check:
                pages.write(name.rpartition("/")[2], command(name), printed)
    return status


def command(name: str) -> str:
    """The command that makes one of the tables of this run again."""
    words = sys.argv[1:]
    first = next((k for k, word in enumerate(words) if word.startswith("-")), len(words))
    return shlex.join(["python", "benchmarks/run.py", name.rpartition("/")[2], *words[first:]])


if __name__ == "__main__":
    sys.exit(main())
