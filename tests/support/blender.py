"""The add-on as Blender registers it, an empty scene per test, and operators as Blender runs them in a window."""

from __future__ import annotations

import atexit
import importlib.util
import itertools
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import bpy
import pytest

from .drawings import PACKAGE, snapshot

ROOT = Path(__file__).resolve().parents[2]


def _registered() -> ModuleType:
    """The root package as Blender's extension, registered until the interpreter ends."""
    if PACKAGE in sys.modules:
        return sys.modules[PACKAGE]
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = module
    spec.loader.exec_module(module)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    module.register()
    atexit.register(leave)
    return module


def leave() -> None:
    """Unregister: classes that are registered when the interpreter ends make some versions of bpy crash or hang."""
    atexit.unregister(leave)
    if PACKAGE in sys.modules and hasattr(bpy.types.Scene, "nested_cages"):
        sys.modules[PACKAGE].unregister()


@pytest.fixture(scope="session")
def extension() -> ModuleType:
    """The root package as Blender's extension, registered for the whole session."""
    return _registered()


@pytest.fixture(scope="session")
def core(extension: ModuleType) -> ModuleType:
    """The core as the add-on sees it: its public names."""
    return import_module(f"{extension.__name__}.nestedcages_core")


def new_file() -> None:
    """A scene without objects, on frame 1 of 1 to 250."""
    # Without the preferences: to read them too registers Blender's own add-ons again, four times the time.
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


@pytest.fixture(autouse=True)
def empty_scene(extension: ModuleType) -> None:
    new_file()


@contextmanager
def refused(*named: str, unchanged: bool = True) -> Iterator[None]:
    """An operator reports an error or says why it is not available, names these things, and changes nothing."""
    bpy.context.view_layer.update()
    before = repr(snapshot()) if unchanged else ""
    with pytest.raises(RuntimeError) as caught:
        yield
    message = str(caught.value)
    told = message.startswith("Error: ") or ("poll() " in message and "context is incorrect" not in message)
    assert told and "Traceback" not in message, message
    assert all(name in message for name in named), message
    if unchanged:
        bpy.context.view_layer.update()
        assert repr(snapshot()) == before


class Reports:
    """What operators have reported since the last look, as Blender prints it: "Warning: ..." """

    def __init__(self, capfd: pytest.CaptureFixture[str]) -> None:
        self._capfd = capfd

    def read(self, kind: str = "") -> str:
        """The lines of a kind of report, such as Warning; of all kinds."""
        out, err = self._capfd.readouterr()
        assert "Traceback" not in out + err, out + err
        return "\n".join(line for line in out.splitlines() if line.startswith(kind))


@pytest.fixture
def reports(capfd: pytest.CaptureFixture[str]) -> Reports:
    return Reports(capfd)


class Timers:
    """Stands in for Blender's timers, which need a window: functions that are called when a test says so."""

    def __init__(self) -> None:
        self.functions: list[Callable[[], float | None]] = []

    def register(self, function: Callable[[], float | None], **_options: Any) -> None:
        self.functions.append(function)

    def unregister(self, function: Callable[[], float | None]) -> None:
        self.functions.remove(function)

    def is_registered(self, function: Callable[[], float | None]) -> bool:
        return function in self.functions

    def run(self) -> None:
        for function in list(self.functions):
            if function() is None and function in self.functions:
                self.functions.remove(function)


@pytest.fixture
def timers(extension: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Iterator[Timers]:
    """Blender's timers, called by tests; nothing runs before and after them."""
    extension.unregister()
    extension.register()
    found = Timers()
    with monkeypatch.context() as patched:
        for name in ("register", "unregister", "is_registered"):
            patched.setattr(bpy.app.timers, name, getattr(found, name))
        yield found
        new_file()
        extension.unregister()
        extension.register()


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that leaps, so that each slice of work ends after one step."""
    monkeypatch.setattr(time, "perf_counter", map(float, itertools.count(1000, 1)).__next__)


def event(kind: str, x: int = 150, y: int = 150, value: str = "PRESS") -> SimpleNamespace:
    """What Blender tells a modal operator."""
    return SimpleNamespace(type=kind, value=value, mouse_x=x, mouse_y=y)


TIMER, ESCAPE, OTHER = map(event, ("TIMER", "ESC", "A"))
IN_VIEW, IN_TEXT_EDITOR = (150, 150), (450, 150)
GOES_ON = ({"RUNNING_MODAL"}, {"PASS_THROUGH"})


class _InWindow:
    """bpy as it is with a window, in which other operators may stand in for Blender's."""

    def __init__(self, window: Window) -> None:
        self._window = window

    app = SimpleNamespace(background=False, version=bpy.app.version, timers=bpy.app.timers, handlers=bpy.app.handlers)

    def __getattr__(self, name: str) -> Any:
        return self._window.ops if name == "ops" else getattr(bpy, name)


class Window:
    """Operators as Blender invokes them in a window: their methods on a stand-in, with the window's parts noted.

    log: "modal" for a handler, the timer that was removed, status texts, and reports as (kind, sentence).
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, timers: Timers) -> None:
        self.log: list[Any] = []
        self.ops: Any = bpy.ops
        self.timers, self._monkeypatch = timers, monkeypatch
        shading = SimpleNamespace(light="FLAT", color_type="TEXTURE", wireframe_color_type="OBJECT")
        camera = SimpleNamespace(view_perspective="CAMERA")
        view = SimpleNamespace(shading=shading, overlay=SimpleNamespace(wireframe_threshold=0.5), region_3d=camera)
        areas = [
            SimpleNamespace(type=kind, x=x, y=100, width=300, height=200, spaces=SimpleNamespace(active=view))
            for kind, x in (("VIEW_3D", 0), ("TEXT_EDITOR", 300))
        ]
        manager = SimpleNamespace(
            event_timer_add=lambda *_, **__: "timer",
            event_timer_remove=self.log.append,
            modal_handler_add=lambda _operator: self.log.append("modal"),
            windows=[],
        )
        self.context = SimpleNamespace(
            window=SimpleNamespace(screen=SimpleNamespace(areas=areas)),
            window_manager=manager,
            workspace=SimpleNamespace(status_text_set=self.log.append),
            space_data=None,
        )
        self.look()

    def look(self) -> None:
        """Takes over the context of now."""
        for name in ("scene", "mode", "view_layer", "evaluated_depsgraph_get", "collection"):
            setattr(self.context, name, getattr(bpy.context, name))
        self.context.selected_objects = list(bpy.context.selected_objects)

    def operator(self, name: str, **given: Any) -> Any:
        """An operator of ours with these values, ready to be invoked."""
        kind = getattr(bpy.types, f"OBJECT_OT_nested_cages_{name}")
        for module in {base.__module__ for base in kind.__mro__ if base.__module__.startswith(PACKAGE)}:
            if hasattr(sys.modules[module], "bpy"):
                self._monkeypatch.setattr(sys.modules[module], "bpy", _InWindow(self))
        bases = tuple(base for base in kind.__bases__ if base.__module__.startswith(PACKAGE))
        made = type("StandIn", bases, {key: value for key, value in vars(kind).items() if not key.startswith("__")})()
        for prop in getattr(bpy.ops.object, f"nested_cages_{name}").get_rna_type().properties:
            if prop.type != "POINTER" and not hasattr(made, prop.identifier):
                setattr(made, prop.identifier, [] if prop.type == "COLLECTION" else prop.default)
        made.answered = True  # operators with a dialog: its button was pressed
        for key, value in given.items():
            setattr(made, key, value)
        made.bl_rna, made.as_keywords = kind.bl_rna, lambda **_: dict(given)
        made.properties = SimpleNamespace(is_property_set=given.__contains__)
        made.exclusive = getattr(kind, "exclusive", False)
        cancel = made.cancel
        made.cancel = lambda _context: cancel(self.context)  # the real window manager has no such timer
        made.report = lambda level, words: self.log.append((*level, words))
        return made

    def invoke(self, operator: Any) -> set[str]:
        self.look()
        return operator.invoke(self.context, None)

    def tick(self, operator: Any) -> set[str]:
        """What happens from time to time: timers are called, and the operator gets an event."""
        self.timers.run()
        return operator.modal(self.context, TIMER)

    def finish(self, operator: Any) -> set[str]:
        """Ticks to the end of the work."""
        outcome = operator.modal(self.context, OTHER)
        while outcome in GOES_ON:
            outcome = self.tick(operator)
        return outcome


@pytest.fixture
def window(timers: Timers, monkeypatch: pytest.MonkeyPatch) -> Window:
    return Window(monkeypatch, timers)


def running() -> bool:
    """Whether a job runs that can be cancelled."""
    return bool(bpy.ops.object.nested_cages_cancel.poll())
