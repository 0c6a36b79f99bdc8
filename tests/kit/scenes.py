"""Simulations of tests, in this process: from the text of a scene script, its path, or a function."""

import contextlib
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import morse

#: ``load(scene, **options)``; typed loosely, because tests use components as attributes
Load = Callable[..., Any]


def script(folder: Path, text: str, name: str = "scene.py") -> Path:
    """Write a scene script.

    Args:
        text: it may be indented, and may lack the import of the builder.
    """
    path = folder / name
    begin = "" if "morse.builder import" in text else "from morse.builder import *\n"
    path.write_text(begin + textwrap.dedent(text), encoding="utf-8")
    return path


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Load]:
    """Loads scenes, and closes them after the test: ``load(scene, **options)``.

    The scene is a text as for `script`, or what `morse.load` takes, whose options it has. With ``sockets=True``,
    services are on a free port.
    """
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with contextlib.ExitStack() as ends:

        def start(scene: object, **options: Any) -> Any:
            found = script(tmp_path, scene) if isinstance(scene, str) else scene
            return ends.enter_context(morse.load(found, **options))  # type: ignore[arg-type]

        yield start


@pytest.fixture(scope="module")
def loaded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """The simulation of ``SCENE`` of the module, a text or a function: one for all its tests."""
    scene = request.module.SCENE
    with morse.load(
        script(tmp_path_factory.mktemp("loaded"), scene) if isinstance(scene, str) else scene
    ) as simulation:
        yield simulation
