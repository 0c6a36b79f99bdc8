"""Stairs."""

from __future__ import annotations

from morse.core.classes.builder_defaults import RobotDefaults
from morse.helpers.components import add_property
from morse.plugins.facilities.panels import Facility


class Stairs(Facility):
    """A straight flight of solid steps between two floors, with rails at both sides, which people walk."""

    _name = "Stairs"
    _short_desc = "A straight flight of steps that people walk between two floors"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.Stairs")

    _rise: float
    _steps: int
    _tread: float
    _width: float
    add_property("_rise", 3.5, "Rise", "float", "Height of the upper floor above the lower one", unit="m", low=0.1,
                 high=30.0, written_by="Stairs(rise=...)")  # fmt: skip
    add_property("_steps", 21, "Steps", "int", "Number of steps up, of which the last one is the upper floor", low=1,
                 high=200, written_by="Stairs(riser=...)")  # fmt: skip
    add_property("_tread", 0.29, "Tread", "float", "Depth of a step", unit="m", low=0.15, high=1.0,
                 written_by="Stairs(tread=...)")  # fmt: skip
    add_property("_width", 1.5, "Width", "float", "Between the rails", unit="m", low=0.6, high=50.0,
                 written_by="Stairs(width=...)")  # fmt: skip
