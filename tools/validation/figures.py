"""A figure of the validation, and the scenes that measure it."""

from __future__ import annotations

import contextlib
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import morse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from morse.simulation.simulation import Simulation

#: m/s^2, the default of scenes
G = 9.81


@dataclass(frozen=True)
class Figure:
    """What a model gives, and what it should give.

    Attributes:
        model: what is simulated.
        quantity: what is measured, with its unit.
        expected: value of the source.
        measured: value of the simulation.
        tolerance: largest absolute difference that counts as right.
        source: formula, standard or data sheet of the expected value.
    """

    model: str
    quantity: str
    expected: float
    measured: float
    tolerance: float
    source: str

    @property
    def is_right(self) -> bool:
        """Whether the measured value is within the tolerance."""
        return abs(self.measured - self.expected) <= self.tolerance


@contextlib.contextmanager
def scene(text: str, files: Mapping[str, str | Callable[[Path], object]] | None = None) -> Iterator[Simulation]:
    """Load a scene.

    Args:
        text: the script after the import of `morse.builder`; ``{folder}`` is the folder of the files.
        files: names to texts, or to functions that write them.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in (files or {}).items():
            if isinstance(content, str):
                (folder / file).write_text(content)
            else:
                content(folder / file)
        script = folder / "scene.py"
        script.write_text("import math\nfrom morse.builder import *\n" + text.replace("{folder}", name))
        with morse.load(script) as sim:
            yield sim
