"""Coordinates of the Universal Transverse Mercator grid, as an offset to the coordinates of the world."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from morse.core.declarations import Option
from morse.core.exceptions import MorseBuilderError
from morse.core.modifier import AbstractModifier
from morse.core.reports.quoting import shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.mathutils.rotations import Triple

_PROPERTIES = {"x": "UTMXOffset", "y": "UTMYOffset", "z": "UTMZOffset"}


class UTMModifier(AbstractModifier):
    """Shifts coordinates by the position of the origin of the world in the grid.

    Options ``x_offset``, ``y_offset``, ``z_offset``, in metres; else the properties ``UTMXOffset``, ``UTMYOffset`` and
    ``UTMZOffset`` of the environment, which may be strings; else 0.
    """

    options: ClassVar[Mapping[str, Option]] = MappingProxyType(
        {
            f"{axis}_offset": Option(
                (float, int, str), 0.0, "Position of the origin of the world in the grid", unit="m"
            )
            for axis in "xyz"
        }
    )
    changes: Mapping[str, Mapping[str, object]] = MappingProxyType(
        # the axes of the grid are parallel to those of the world
        {name: {"frame": "utm"} for name in ("x", "y", "z", "roll", "pitch", "yaw")}
    )
    _sign = 1.0

    def initialize(self) -> None:
        """Get the offsets.

        Raises:
            MorseBuilderError: an offset is not a number.
        """
        self._offsets = {axis: self._offset(axis) for axis in "xyz"}

    def _offset(self, axis: str) -> float:
        value = self.parameter(f"{axis}_offset", prop=_PROPERTIES[axis], default=0.0)
        try:
            offset = float(value)
        except (TypeError, ValueError):
            offset = math.nan
        if not math.isfinite(offset):
            raise MorseBuilderError(f"{_PROPERTIES[axis]}, or {axis}_offset, is a number of metres, not {shown(value)}")
        return offset

    def origin(self) -> Triple:
        """See `AbstractModifier.origin`."""
        return -self._offsets["x"], -self._offsets["y"], -self._offsets["z"]

    def modify(self) -> None:
        """Shift the coordinates."""
        for axis, offset in self._offsets.items():
            try:
                self.data[axis] += self._sign * offset
            except KeyError as missing:
                self.key_error(missing)


class CoordinatesToUTM(UTMModifier):
    """Converts the coordinates of a measurement to the grid."""

    _names = ("UTM",)
    _components = ("Pose", "GPS")


class CoordinatesFromUTM(UTMModifier):
    """Converts the coordinates of a command from the grid."""

    _names = ("UTM",)
    _components = ("Destination", "Waypoint")
    _sign = -1.0
