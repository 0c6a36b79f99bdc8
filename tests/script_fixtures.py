"""Fixtures of tests that run texts as scene scripts."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from morse.assets import search
from morse.builder import workspace
from morse.builder.script import load_scene
from morse.scene import Scene
from morse.simulation.options import RunOptions


@pytest.fixture(autouse=True)
def _fresh_builder(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every test begins with an empty scene and leaves the interpreter unchanged."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "argv", list(sys.argv))
    monkeypatch.delenv("MORSE_RESOURCE_PATH", raising=False)
    monkeypatch.delenv("MORSE_ROOT", raising=False)
    modules = set(sys.modules)
    workspace.reset()
    yield
    workspace.reset()
    search.set_project_dirs([])
    for name in set(sys.modules) - modules:
        # packages that a test wrote into its own directory
        if not name.startswith(("morse", "numpy")):
            del sys.modules[name]


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., Scene]:
    """Runs a text as a scene script."""

    def run(text: str, *, name: str = "scene.py", arguments: tuple[str, ...] = (), source: str | None = None) -> Scene:
        script = tmp_path / name
        script.write_text(text, encoding="utf-8")
        sources = [str(tmp_path / source)] if source else []
        return load_scene(RunOptions(str(script), arguments=list(arguments), source_paths=sources))

    return run
