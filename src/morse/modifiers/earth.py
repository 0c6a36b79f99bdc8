"""The base class of modifiers with coordinates on the earth."""

from __future__ import annotations

import math
from abc import abstractmethod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.exceptions import MorseBuilderError
from morse.core.modifier import AbstractModifier
from morse.core.reports.quoting import nearest, shown
from morse.helpers.geodesy import LocalPlane

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option
    from morse.mathutils.rotations import Triple


class EarthModifier(AbstractModifier):
    """Converts x, y and z between the world and coordinates on the earth.

    The position of the world is a property of the environment: ``env.properties(longitude=..., latitude=...,
    altitude=...)``, degrees and metres above the WGS84 ellipsoid, and optionally ``angle_against_north``, rad.

    Raises:
        GeodesyError: the environment does not have these properties.
    """

    options: ClassVar[Mapping[str, Option]] = MappingProxyType({})

    def initialize(self) -> None:
        """Read the position of the world."""
        self.plane = LocalPlane.of(self.component_instance.context.scene.properties)

    @abstractmethod
    def converted(self, place: Triple) -> Triple:
        """Convert a position."""

    def modify(self) -> None:
        """Convert the coordinates."""
        data = self.data
        try:
            place = data["x"], data["y"], data["z"]
        except KeyError as missing:
            self.key_error(missing)
        else:
            data["x"], data["y"], data["z"] = self.converted(place)


def deviations(option: str, numbers: Any, axes: tuple[str, ...]) -> dict[str, float]:
    """Return the standard deviation of each axis; axes that are missing in a dictionary are omitted.

    Args:
        option: name of the option, for messages.
        numbers: a number of at least 0, or a dictionary of such numbers.
        axes: the keys that the dictionary may have.

    Raises:
        MorseBuilderError: the value is neither of the two.
    """
    by_axis = numbers if isinstance(numbers, dict) else dict.fromkeys(axes, numbers)
    for axis, value in by_axis.items():
        if axis not in axes:
            raise MorseBuilderError(f"option '{option}' has no axis {shown(axis)}{nearest(axis, axes)}")
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < math.inf:
            raise MorseBuilderError(f"option '{option}' takes a standard deviation of at least 0, not {shown(value)}")
    return {axis: float(by_axis.get(axis, 0.0)) for axis in axes}
