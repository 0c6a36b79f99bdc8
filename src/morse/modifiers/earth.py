"""The base class of modifiers with coordinates on the earth."""

from __future__ import annotations

from abc import abstractmethod
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from morse.core.modifier import AbstractModifier
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
