"""Images of temperatures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.exceptions import MorseBuilderError
from morse.core.reports.quoting import shown
from morse.helpers.components import add_data, add_kind, add_property
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.rendering import Picture
    from morse.scene import Node

#: °C: temperatures of objects are limited to this range
COLDEST, HOTTEST = -273.15, 1e6
#: property of an object, and of the environment, with a temperature in °C
_TEMPERATURE = "Temperature"


def _temperatures(camera: ThermalCamera) -> NDArray[np.float32]:
    """(H, W), the top row first."""
    return camera.top_first(camera.local_data["image"])


class ThermalCamera(Camera):
    """Measures the temperature of the surface in each pixel.

    All surfaces of an object have one temperature: its property ``Temperature`` in °C, or that of its nearest parent.
    An object with the property ``FireTag`` is hotter than the environment by the value of this property, if it is a
    number, and by ``FireTemperature`` otherwise, as for the `Thermometer`. All other surfaces have the temperature
    ``DefaultTemperature``, or ``env.properties(Temperature=...)`` if a script does not set it, and the
    sky has ``SkyTemperature``. All surfaces are black bodies: they do not reflect the heat of others, and the air
    between them and the camera absorbs nothing.
    """

    _name = "Thermal camera"
    _short_desc = "A camera that measures the temperatures of surfaces"

    add_data(
        "image",
        np.zeros((0, 0), np.float32),
        "buffer",
        "Temperature of the surface in each pixel",
        unit="°C",
        frame="optical",
        shape=(None, None),
        dtype="float32",
        low=COLDEST,
    )
    add_data("intrinsic_matrix", **INTRINSIC)

    add_property(
        "_ambient", 15.0, "DefaultTemperature", "float", "Temperature of all other surfaces", unit="°C", low=COLDEST
    )
    add_property(
        "_sky",
        None,
        "SkyTemperature",
        "float",
        "Temperature without a surface; None for that of the other surfaces",
        unit="°C",
        low=COLDEST,
        allow=("none",),
    )
    add_property("_fire_tag", "Fire", "FireTag", "string", "Property that marks fires")
    add_property("_fire_temp", 200.0, "FireTemperature", "float", "Temperature increase of a fire", unit="K")

    add_kind("image", pixels=_temperatures, encoding="32FC1", unit="°C")
    add_kind("camera_info", **CAMERA_INFO)

    color = False
    uses = ("ids",)

    _ambient: float
    _sky: float | None
    _fire_tag: str
    _fire_temp: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        around = self.context.scene.properties.get(_TEMPERATURE)
        if around is not None and "DefaultTemperature" not in obj:
            ambient = _number(around)
            if ambient is None:
                raise MorseBuilderError(f"env.properties({_TEMPERATURE}={around!r}): expected degrees Celsius")
            self._ambient = ambient

    def note(self) -> NDArray[np.float32]:
        """Return the temperatures of all meshes, and last that of the sky."""
        temperatures: dict[Node, float] = {}
        values = [self._of(node, temperatures) for node in self.request.server.contents.nodes]
        sky = self._ambient if self._sky is None else self._sky
        return np.clip(np.array([*values, sky], np.float64), COLDEST, HOTTEST).astype(np.float32)

    def _of(self, node: Node, temperatures: dict[Node, float]) -> float:
        """The temperature of an object, which parts without a temperature of their own have as well."""
        if node not in temperatures:
            own = self._own(node)
            if own is None:
                own = self._ambient if node.parent is None else self._of(node.parent, temperatures)
            temperatures[node] = own
        return temperatures[node]

    def _own(self, node: Node) -> float | None:
        obj = self.context.world.find_object(node)
        if obj is None:
            return None
        own_value = obj.get(_TEMPERATURE)
        value = _number(own_value)
        if value is None and own_value is not None:
            text = f"{obj.name}: the property '{_TEMPERATURE}' is a number of degrees Celsius, not {shown(own_value)}"
            self.context.complaints.warn(text, text)
        if value is None and obj.get(self._fire_tag):
            heat = _number(obj.get(self._fire_tag))
            value = self._ambient + (self._fire_temp if heat is None else heat)
        return value

    def take(self, picture: Picture) -> None:
        """Store the temperatures."""
        # the last entry, for -1, is the temperature without a surface
        self.local_data["image"] = self.ordered(self.noted[picture.ids])


def _number(value: object) -> float | None:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    return None
