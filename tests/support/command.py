"""The command `nested-cages`, run in this process as `python -m nestedcages_core` runs it."""

import contextlib
import io
import os
import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

from support.sources import ROOT


class _Text(io.TextIOWrapper):
    """A stream in memory, whose content outlives it."""

    def __init__(self, content: bytes = b"", *, terminal: bool = False) -> None:
        self.bytes = io.BytesIO(content)
        self.terminal = terminal
        super().__init__(self.bytes, encoding="utf-8", newline="", write_through=True)

    def isatty(self) -> bool:
        return self.terminal

    @property
    def text(self) -> str:
        return self.bytes.getvalue().decode("utf-8", "backslashreplace")


def run(
    *arguments: object, stdin: str | bytes = b"", cwd: str | Path | None = None, terminal: bool = False
) -> SimpleNamespace:
    """Run the command; returns its ``status`` and what it wrote, ``out`` and ``err``.

    arguments: paths and numbers become words. stdin: what it reads. cwd: the folder it runs in. terminal: whether its
    streams are those of a terminal.
    """
    given = stdin.encode() if isinstance(stdin, str) else stdin
    streams = [_Text(given), _Text(terminal=terminal), _Text(terminal=terminal)]
    words = ["nested-cages", *map(str, arguments)]
    before = os.getcwd()
    status: object = None
    with contextlib.ExitStack() as stack:
        stack.callback(os.chdir, before)
        for name, stream in zip(("stdin", "stdout", "stderr"), streams, strict=True):
            stack.enter_context(mock.patch.object(sys, name, stream))
        stack.enter_context(mock.patch.object(sys, "argv", words))
        if cwd is not None:
            os.chdir(cwd)
        try:
            runpy.run_module("nestedcages_core", run_name="__main__", alter_sys=True)
        except SystemExit as end:
            status = end.code
    code = status if isinstance(status, int) else 0 if status is None else 1
    return SimpleNamespace(status=code, out=streams[1].text, err=streams[2].text)


def run_alone(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own; options are those of `subprocess.run`."""
    options = {"capture_output": True, "timeout": 120, "check": False, "encoding": "utf-8", **options}
    options["env"] = {**os.environ, "PYTHONPATH": str(ROOT), **options.get("env", {})}
    return subprocess.run([sys.executable, "-m", "nestedcages_core", *map(str, arguments)], **options)
