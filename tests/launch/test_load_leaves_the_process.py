"""Loading, running and closing a simulation leave the process unchanged."""

import gc
import logging
import os
import signal
import sys
import threading
import warnings
from pathlib import Path
from typing import Any

import launch_scenes
import pytest

import morse
from morse.builder.script import ScriptError
from morse.launch.load import described
from morse.simulation.loader import LoadError
from morse.simulation.options import RunOptions

LIBRARIES = ("morse.", "pymorse", "numpy", "mujoco", "embreex", "zstandard", "msgspec")


class _Threads(frozenset[threading.Thread]):
    """Threads, of which there are no new ones; one of an earlier test may end meanwhile."""

    def __eq__(self, before: object) -> bool:
        return isinstance(before, frozenset) and self <= before

    __hash__ = None  # type: ignore[assignment]


def process() -> dict[str, Any]:
    """The parts of a process that a library must not change."""
    return {
        "path": list(sys.path),
        "argv": list(sys.argv),
        "meta path": list(sys.meta_path),
        "main": sys.modules["__main__"],
        "environment": dict(os.environ),
        "folder": os.getcwd(),
        "signals": {number: signal.getsignal(number) for number in signal.valid_signals()},
        "log": {name: list(logging.getLogger(name).handlers) for name in ("", "morse", "pymorse")},
        "levels": {name: logging.getLogger(name).level for name in ("", "morse", "pymorse")},
        "threads": _Threads(threading.enumerate()),
        "excepthook": (sys.excepthook, threading.excepthook),
        "streams": (sys.stdin, sys.stdout, sys.stderr),
        "frozen": gc.get_freeze_count(),
        "collector": (gc.isenabled(), gc.get_threshold()),
        "recursion": sys.getrecursionlimit(),
        "warnings": list(warnings.filters),
        "import": __import__,
    }


def files() -> set[str]:
    """Open descriptors, including sockets, if the operating system lists them."""
    try:
        return {os.readlink(f"/proc/self/fd/{fd}") for fd in os.listdir("/proc/self/fd")}
    except OSError:
        return set()


@pytest.fixture(params=["path", "function", "scene"])
def scene(request: pytest.FixtureRequest, project: Path) -> Any:
    if request.param == "path":
        return project
    if request.param == "function":
        return launch_scenes.driving
    return described(launch_scenes.driving, RunOptions())


def test_nothing_is_changed(scene: Any) -> None:
    morse.load(launch_scenes.driving).close()  # one-time initialisation of libraries
    before, modules, opened = process(), set(sys.modules), files()
    with morse.load(scene, arguments=["--loud", "3"]) as simulation:
        assert process() == before
        simulation.step(3)
        simulation.run(0.05, speed=float("inf"))
        assert process() == before
        assert files() <= opened
    assert process() == before
    new = {name for name in set(sys.modules) - modules if not name.startswith(LIBRARIES)}
    assert not {name for name in new if name.partition(".")[0] not in sys.stdlib_module_names}


@pytest.mark.parametrize("text", ["raise ValueError('no')", "import missing_module", "sys.exit(3)"])
def test_nothing_is_changed_by_a_scene_that_fails(project: Path, text: str) -> None:
    project.write_text(f"import os, sys\nfrom mine.parts import Counter\nsys.path.append('elsewhere')\n{text}\n")
    morse.load(launch_scenes.driving).close()
    before, modules = process(), set(sys.modules)
    with pytest.raises(ScriptError, match=r"scene\.py:4"):
        morse.load(project)
    assert process() == before
    assert not {name for name in set(sys.modules) - modules if name.startswith("mine")}


def test_nothing_is_changed_by_a_component_that_fails(project: Path) -> None:
    parts = project.parent / "src" / "mine" / "parts.py"
    parts.write_text(
        parts.read_text() + "\n    def __init__(self, obj, parent=None):\n        raise OSError('no device')\n"
    )
    morse.load(launch_scenes.driving).close()
    before = process()
    with pytest.raises(LoadError, match="no device"):
        morse.load(project)
    assert process() == before


def test_threads_and_sockets_are_there_if_asked_for_and_go_with_the_simulation(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    threads, opened = _Threads(threading.enumerate()), files()
    with morse.load(project, sockets=True):
        assert _Threads(threading.enumerate()) != threads
    assert _Threads(threading.enumerate()) == threads
    assert {name for name in files() if name.startswith("socket:")} <= opened


def test_arguments_are_those_of_the_script(project: Path) -> None:
    with morse.load(project, arguments=["--loud", "3"]) as simulation:
        assert simulation.robot.component.bge_object["arguments"] == "--loud 3"


def test_the_page_is_shown_in_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    with morse.load(launch_scenes.driving) as simulation, pytest.raises(RuntimeError, match="view='web'"):
        simulation.show()
    with morse.load(launch_scenes.driving, view="web") as simulation:
        html = simulation.show(height=300)._repr_html_()
        assert simulation.view.url in html
        assert 'height="300"' in html
        simulation.run(0.05)
    with pytest.raises(RuntimeError, match="closed"):
        simulation.show()
