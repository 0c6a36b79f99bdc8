"""A project in a folder whose files are edited while it is simulated."""

import os
import shutil
import textwrap
from pathlib import Path

import morse
from morse.simulation.simulation import Simulation

DATA = Path(morse.__file__).parent / "data"
#: timeout, wall-clock seconds
LIMIT = 60.0


class Project:
    """A scene with its own models and modules."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._ages = 0

    def model(self, name: str, source: Path) -> Path:
        """Save a model like Blender: a new file replaces the old one."""
        target = self.folder / "data" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = target.with_name(target.name + "@")
        shutil.copyfile(source, temporary)
        os.replace(temporary, target)
        return target

    def module(self, name: str, text: str) -> Path:
        """Write a module in place, as many editors do."""
        target = self.folder / "src" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(textwrap.dedent(text), encoding="utf-8")
        return target

    def load(self, text: str, **options: object) -> Simulation:
        """Simulate a scene of the project."""
        script = self.folder / "scene.py"
        script.write_text("from morse.builder import *\n" + textwrap.dedent(text), encoding="utf-8")
        return morse.load(script, **{"watch": True, **options})  # type: ignore[arg-type]
