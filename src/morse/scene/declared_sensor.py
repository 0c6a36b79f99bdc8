"""Sensors and actuators that a model file declares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils.rotations import Rotation9


@dataclass(frozen=True, slots=True)
class DeclaredSensor:
    """A sensor or actuator of a robot, as declared in the file of the robot.

    Attributes:
        name: name in the file.
        product: the class in scene scripts, e.g. ``VideoCamera``.
        link: name of the node that carries it, in the file.
        position: position in the frame of the link, m.
        rotation: 9 numbers, row by row, from the frame of the sensor (X forward, Z up) to that of the link.
        properties: names and values of the properties that the file sets.
        frequency: Hz, or None.
        noise: standard deviations of the white noise of fields; an empty name stands for all of them.
        has_own_visual: whether the file shows what the sensor looks like.
        stream: options of its streams that the file sets, such as the topic.
    """

    name: str
    product: str
    link: str
    position: tuple[float, float, float]
    rotation: Rotation9
    properties: tuple[tuple[str, float | int | str], ...] = ()
    frequency: float | None = None
    stream: tuple[tuple[str, str | bool], ...] = ()
    noise: tuple[tuple[str, float], ...] = ()
    has_own_visual: bool = False
