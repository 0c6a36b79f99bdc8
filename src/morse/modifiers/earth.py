"""What modifiers that give places on the earth have in common."""

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
    """Changes x, y and z between the world and coordinates of the earth.

    The environment says where the world is: ``env.properties(longitude=..., latitude=..., altitude=...)``, degrees and
    metres above the WGS84 ellipsoid, and perhaps ``angle_against_north``, radians.

    Raises:
        GeodesyError: the environment does not have these properties.
    """

    options: ClassVar[Mapping[str, Option]] = MappingProxyType({})

    def initialize(self) -> None:
        """Find out where the world is."""
        self.plane = LocalPlane.of(self.component_instance.context.scene.properties)

    @abstractmethod
    def converted(self, place: Triple) -> Triple:
        """The coordinates of a place, given in the others."""

    def modify(self) -> None:
        """Change the coordinates."""
        data = self.data
        try:
            place = data["x"], data["y"], data["z"]
        except KeyError as missing:
            self.key_error(missing)
        else:
            data["x"], data["y"], data["z"] = self.converted(place)
