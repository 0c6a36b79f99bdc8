"""Street lamps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot
from morse.core.services import service
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.sun.almanac import RISES
from morse.plugins.sun.services import present

if TYPE_CHECKING:
    from morse.core.values import StateData
    from morse.core.world import Body


class StreetLamp(Robot):
    """A lamp that shines while the sun is down, or as clients say."""

    _name = "StreetLamp"
    _short_desc = "A lamp on a post that shines after sunset"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.sun.builder.StreetLamp")

    add_data("on", False, "bool", "Whether it shines")

    _dusk: float
    add_property(
        "_dusk", RISES, "Dusk", "float", "Elevation of the sun below which it shines", unit="deg", low=-90.0, high=90.0
    )

    add_state("_told", str, "on or off, if a client has said so; else empty")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._told = ""
        self._bulb = next((part for part in obj.children if part.node.light is not None), None)
        self._shine()

    @service
    def switch(self, state: Literal["on", "off", "auto"]) -> None:
        """Switch the lamp on or off, or let it follow the sun again."""
        self._told = "" if state == "auto" else state

    def default_action(self) -> None:
        """Look at the sun."""
        place = present(self.context)
        is_dark = place is not None and math.degrees(place.elevation) < self._dusk
        on = self._told == "on" if self._told else is_dark
        if on != self.local_data["on"]:
            self.local_data["on"] = on
            self._shine()

    def _shine(self) -> None:
        if self._bulb is not None:
            self._bulb.setVisible(self.local_data["on"])

    def set_state(self, state: StateData) -> None:
        """Restore a state, and the light with it."""
        super().set_state(state)
        self._shine()
