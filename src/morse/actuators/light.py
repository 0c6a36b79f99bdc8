"""A spot light."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.exceptions import MorseRPCTypeError
from morse.core.reports.quoting import shown
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body

_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


class Light(Actuator):
    """A spot light along the X axis that can be switched on and off."""

    _name = "Light"
    _short_desc = "A lamp on a robot that can be switched"

    add_data("emit", True, "bool", "Whether the light is on; initially the property emit")
    add_kind("switch", on="emit")
    add_property("_emit", True, "emit", "bool", "Whether the light is on at the start")
    add_property(
        "_distance", 10.0, "distance", "float", "Distance at which the intensity has fallen to half", unit="m", low=0.0
    )
    add_property("_color", "(0,0,0)", "color", "string", "Red, green, blue, 0 to 1; (0,0,0) stands for white")
    add_property("_size", math.pi / 2.0, "size", "float", "Angle of the cone", unit="rad", low=0.0, high=math.pi)
    add_property("_energy", 1.0, "energy", "float", "Brightness relative to a normal lamp", low=0.0)

    _emit: bool
    _distance: float
    _color: str
    _size: float
    _energy: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.local_data["emit"] = bool(self._emit)
        self._lamp = next((part for part in obj.children if part.node.light is not None), None)
        if self._lamp is None:
            text = f"{self.name()} has no lamp: nothing will shine"
            self.context.complaints.warn(text, text)
            return
        self._shine()

    def _shine(self) -> None:
        """Copy the present properties of the actuator to the lamp."""
        self._shown = self._looks()
        if self._lamp is None or self._lamp.node.light is None:
            return
        distance, color, size, energy = self._shown
        light = replace(self._lamp.node.light, distance=distance, color=_color(color), spot_size=size, energy=energy)
        if light != self._lamp.node.light:
            self._lamp.node.light = light
            self.context.world.appearance_changed(self._lamp)

    def _looks(self) -> tuple[float, str, float, float]:
        return float(self._distance), self._color, float(self._size), float(self._energy)

    def set_state(self, state: StateData) -> None:
        """Restore a state; that of the lamp belongs to its object."""
        super().set_state(state)
        self._shown = self._looks()

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        before = self._color
        super().set_property(name, value)
        try:
            _color(self._color)
        except ValueError as error:
            self._color = before
            raise MorseRPCTypeError(f"{self.name()}: {error}") from None
        self._shine()

    @service
    def toggle(self, emit: bool | None = None) -> None:
        """Switch the light.

        Args:
            emit: on or off; None to toggle.
        """
        self.local_data["emit"] = not self.local_data["emit"] if emit is None else bool(emit)

    def default_action(self) -> None:
        """Apply the state and the properties of the light."""
        if self._shown != self._looks():
            self._shine()
        if self._lamp is not None and self._lamp.visible != self.local_data["emit"]:
            self._lamp.setVisible(self.local_data["emit"])


def _color(text: str) -> tuple[float, float, float]:
    """Parse the colour in a property: three numbers from 0 to 1.

    Raises:
        ValueError: the text is not a colour.
    """
    try:
        r, g, b = (float(part) for part in str(text).strip().strip("()[]").split(","))
    except ValueError:
        raise ValueError(
            f"the property color is '(red, green, blue)', three numbers from 0 to 1, not {shown(text)}"
        ) from None
    if not all(0.0 <= part <= 1.0 for part in (r, g, b)):
        raise ValueError(f"the numbers of the property color go from 0 to 1, not {shown(text)}")
    return _WHITE if (r, g, b) == _BLACK else (r, g, b)
