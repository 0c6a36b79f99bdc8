"""A lamp that shines forward."""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from typing import Any

from morse.core.actuator import Actuator
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property

logger = logging.getLogger(__name__)

_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


class Light(Actuator):
    """A spot light along the X axis that is switched on and off."""

    _name = "Light"
    _short_desc = "A lamp on a robot that can be switched"

    add_data("emit", True, "bool", "Whether it shines; at first the property emit")
    add_kind("switch", on="emit")
    add_property("_emit", True, "emit", "bool", "Whether it shines at the start")
    add_property("_distance", 10.0, "distance", "float", "Where it has faded to half", unit="m", low=0.0)
    add_property("_color", "(0,0,0)", "color", "string", "Red, green, blue, 0 to 1; (0,0,0) leaves it white")
    add_property("_size", math.pi / 2.0, "size", "float", "Angle of the cone", unit="rad", low=0.0, high=math.pi)
    add_property("_energy", 1.0, "energy", "float", "Brightness; that of a normal lamp is 1", low=0.0)

    not_state = ("_lamp",)

    _emit: bool
    _distance: float
    _color: str
    _size: float
    _energy: float

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.local_data["emit"] = bool(self._emit)
        self._lamp = next((part for part in obj.children if part.node.light is not None), None)
        if self._lamp is None:
            logger.warning("%s has no lamp: nothing will shine", self.name())
            return
        self._lamp.node.light = replace(
            self._lamp.node.light,
            distance=float(self._distance),
            color=_color(self._color),
            spot_size=float(self._size),
            energy=float(self._energy),
        )

    @service
    def toggle(self, emit: bool | None = None) -> None:
        """Switch it.

        Args:
            emit: on or off; None for the other way than now.
        """
        self.local_data["emit"] = not self.local_data["emit"] if emit is None else bool(emit)

    def default_action(self) -> None:
        """Shine or not."""
        if self._lamp is not None and self._lamp.visible != self.local_data["emit"]:
            self._lamp.setVisible(self.local_data["emit"])


def _color(text: str) -> tuple[float, float, float]:
    """The colour that a property gives: three numbers from 0 to 1.

    Raises:
        ValueError: it is something else.
    """
    try:
        r, g, b = (float(part) for part in str(text).strip().strip("()[]").split(","))
    except ValueError:
        raise ValueError(
            f"the property color is '(red, green, blue)', three numbers from 0 to 1, not {text!r}"
        ) from None
    if not all(0.0 <= part <= 1.0 for part in (r, g, b)):
        raise ValueError(f"the numbers of the property color go from 0 to 1, not {text!r}")
    return _WHITE if (r, g, b) == _BLACK else (r, g, b)
