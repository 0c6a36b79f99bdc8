"""The sun while the simulation runs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject
from morse.core.services import service
from morse.helpers.geodesy import angle_against_north
from morse.plugins.sun import PROPERTY, axes, look
from morse.plugins.sun.almanac import Position, position

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.context import Context

#: rad; the light moves in steps of that size: each one draws all shadows again
_STEP = math.radians(0.25)
#: s between two looks at the sun, of the time of day
_OFTEN = 10.0


def services(context: Context) -> Sun | None:
    """Return the services of the sun, if the scene has one by date and place."""
    return Sun(context) if PROPERTY in context.scene.properties else None


def present(context: Context) -> Position | None:
    """Return the present direction to the sun; None in scenes without date and place."""
    for one in context.service_objects:
        if isinstance(one, Sun):
            return one.place
    return None


class Sun(AbstractObject):
    """The sun of a scene: ``sun.get``."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context = context
        self._plan: dict[str, Any] = dict(context.scene.properties[PROPERTY])  # type: ignore[call-overload]
        self._north = angle_against_north(context.scene.properties)
        self._stamp = -math.inf
        self.place = self._shown = self._at(self._plan["start"])

    def name(self) -> str:
        """``sun``."""
        return "sun"

    def _at(self, unix: float) -> Position:
        return position(unix, self._plan["latitude"], self._plan["longitude"])

    @property
    def _unix(self) -> float:
        return float(self._plan["start"] + self._context.clock.time * self._plan["speed"])

    def restart(self) -> None:
        """Begin with the date of the script."""
        self._stamp = -math.inf
        self.default_action()

    @service(changes=False)
    def get(self) -> dict[str, float]:
        """Return ``azimuth`` from north through east and ``elevation``, rad, and ``time``, s since 1970 UTC."""
        place = self._at(self._unix)
        return {"azimuth": place.azimuth, "elevation": place.elevation, "time": self._unix}

    def default_action(self) -> None:
        """Follow the time of day."""
        # the place follows from the tick alone, whatever was looked at before
        stamp = math.floor(self._unix / _OFTEN) * _OFTEN
        if stamp == self._stamp or not self._plan["speed"]:
            return
        self._stamp = stamp
        self.place = place = self._at(max(stamp, self._plan["start"]))
        # steps that follow from the place alone, too
        turned = Position(round(place.azimuth / _STEP) * _STEP, round(place.elevation / _STEP) * _STEP)
        if turned == self._shown:
            return
        self._shown = turned
        world = self._context.world
        lamp = world.objects_by_name.get(self._plan["lamp"])
        if lamp is None or lamp.node.light is None:
            return
        seen = look(turned.elevation)
        lamp.set_pose(lamp.world_pose()[0], axes(turned, self._north))
        lamp.node.light = replace(lamp.node.light, energy=seen.energy, color=seen.color)
        self._context.scene.settings.view.daylight = seen.sky
        world.appearance_changed(lamp)

    def get_state(self) -> object:
        """Return nothing: all follows from the time."""
        return {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Follow the time of the state."""
        self._stamp, self._shown = -math.inf, Position(math.inf, math.inf)
        self.default_action()
