"""The noise of sensors in the files of Gazebo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, number

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

#: fields of products, and where the standard deviations of their noise may be
_FIELDS: dict[str, dict[str, tuple[str, ...]]] = {
    "VideoCamera": {"image": (".//noise/stddev",)},
    "IMU": {
        "angular_velocity": (".//angular_velocity/x/noise/stddev", ".//noise/rate/stddev"),
        "linear_acceleration": (".//linear_acceleration/x/noise/stddev", ".//noise/accel/stddev"),
    },
    "GPS": {
        "x": (".//position_sensing/horizontal/noise/stddev",),
        "y": (".//position_sensing/horizontal/noise/stddev",),
        "z": (".//position_sensing/vertical/noise/stddev",),
    },
}
_ALL: dict[str, tuple[str, ...]] = {"": (".//noise/stddev",)}
#: pictures have values up to 255, those of Gazebo up to 1
_SCALES = {"VideoCamera": 255.0}


def noise_of(element: Element, product: str) -> Iterator[tuple[str, float]]:
    """The standard deviations of the white noise of a sensor: name of the field, or an empty one for all.

    Raises:
        ValueError: one is not a number.
    """
    for field, paths in _FIELDS.get(product, _ALL).items():
        try:
            deviation = next((value for path in paths if (value := number(element, path, 0.0)) > 0.0), 0.0)
        except ValueMistakeError as error:
            raise ValueError(f"its noise is wrong: {error}") from None
        if deviation:
            yield field, deviation * _SCALES.get(product, 1.0)
