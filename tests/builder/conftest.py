from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from morse.assets import search
from morse.builder import workspace
from morse.builder.script import load_scene
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from morse.scene import Scene


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


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The source folder of a project with the component ``sonars.sonar.Sonar``."""
    package = tmp_path / "src" / "sonars"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "sonar.py").write_text(
        "from morse.core.sensor import Sensor\n"
        "from morse.core.declarations import BuilderDefaults, Visual\n"
        "from morse.helpers.components import add_data, add_level, add_property\n"
        "class Sonar(Sensor):\n"
        "    _name = 'Sonar'\n"
        "    _short_desc = 'Measures a distance by sound'\n"
        "    _builder = BuilderDefaults(frequency=12.0, properties={'Range': 4.0},\n"
        "                               visual=Visual('cylinder', (0.1, 0.1, 0.2), (1.0, 0.0, 0.0)))\n"
        "    add_level('near', None, doc='short range', default=True)\n"
        "    add_level('far', None, doc='long range')\n"
        "    add_data('distance', 0.0, 'float', 'Distance', unit='m')\n"
        "    add_property('_range', 2.0, 'Range', 'float', 'Largest distance, m')\n"
        "    add_property('_mode', 'single', 'Mode', 'string', 'single or continuous')\n"
    )
    (package / "builder.py").write_text(
        "from morse.builder.creator import SensorCreator\n"
        "class Sonar(SensorCreator):\n"
        "    _classpath = 'sonars.sonar.Sonar'\n"
        "    _blendname = 'sonar'\n"
        "    def __init__(self, name=None):\n"
        "        SensorCreator.__init__(self, name)\n"
    )
    return tmp_path / "src"
