"""Gates."""

from __future__ import annotations

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.helpers.components import add_property
from morse.plugins.facilities.panels import gate_place
from morse.plugins.facilities.robots.door import Opening


class Gate(Opening):
    """A barrier whose arm swings up by presence or by call, and does not come down on anybody."""

    _name = "Gate"
    _short_desc = "A barrier whose arm swings up by presence or by call"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.Gate")

    add_property("_width", 3.0, "Width", "float", "Width of the opening", unit="m", low=0.3, high=50.0,
                 written_by="Gate(width=...)")  # fmt: skip
    add_property("_height", 0.9, "Height", "float", "Height of the arm above the floor", unit="m", low=0.1,
                 high=10.0, written_by="Gate(height=...)")  # fmt: skip

    def _begin(self) -> None:
        self._made = self._width, self._height

    def _swept(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        width, height = self._made
        return (0.0, -0.5 * width, 0.0), (0.0, 0.5 * width, height + width)

    def _show(self) -> None:
        places, angles = self._panels.start.copy(), np.zeros(self._panels.count)
        places[0], angles[0] = gate_place(*self._made, float(self.local_data["openness"]))
        self._panels.place(places, angles, axis=0)
