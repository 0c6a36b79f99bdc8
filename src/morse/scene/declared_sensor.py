"""Sensors that a model file declares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils.rotations import Rotation9


@dataclass(frozen=True, slots=True)
class DeclaredSensor:
    """A sensor of a robot as its file has it.

    Attributes:
        name: in the file.
        product: the class in scene scripts, ``VideoCamera`` for instance.
        link: name of the node that carries it, in the file.
        position: m, in the frame of the link.
        rotation: 9 numbers, row by row, from the frame of the sensor (X forward, Z up) to that of the link.
        properties: names and values of the properties that the file sets.
        frequency: Hz, or None.
    """

    name: str
    product: str
    link: str
    position: tuple[float, float, float]
    rotation: Rotation9
    properties: tuple[tuple[str, float | int], ...] = ()
    frequency: float | None = None
