"""The masses of links."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, number, text_of, vector
from morse.assets.inertial import inertial_of

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.flat import FlatLink
    from morse.scene import Inertial

_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
#: moments, kg m^2, of a link without an element for them
_USUAL = {"ixx": 1.0, "iyy": 1.0, "izz": 1.0}
#: kg/m^3
_WATER = 1000.0


def inertial_in(link: FlatLink) -> tuple[Inertial, str]:
    """Return the mass of a link, and a warning if the file is wrong (else an empty string).

    A link without a mass weighs 1 kg; with ``auto``, its mass is that of its shapes.

    Raises:
        ValueMistakeError: a number is wrong, or the mass is negative.
    """
    element = link.part.element.find("inertial")
    if element is not None and (element.get("auto") or "").lower() in ("true", "1"):
        mass = sum(
            _mass(collision, number(element, "density", _WATER)) for collision in link.part.element.findall("collision")
        )
        return inertial_of(mass or 1.0, link.place(element), None)
    mass = number(element, "mass", 1.0)
    if mass < 0.0:
        raise ValueMistakeError(f"its mass is {mass:g} kg")
    tensor = None if element is None else element.find("inertia")
    moments = [number(tensor, name, _USUAL.get(name, 0.0)) for name in _MOMENTS]
    place = link.place(element) if element is not None else link.place(link.part.element.makeelement("inertial", {}))
    return inertial_of(mass, place, moments)


def _mass(collision: Element, density: float) -> float:
    """The mass of a shape, kg; 0 for meshes, which are not measured."""
    density = number(collision, "density", density)
    geometry = collision.find("geometry")
    kind = next((child.tag for child in geometry if isinstance(child.tag, str)), "") if geometry is not None else ""
    shape = None if geometry is None else geometry.find(kind) if kind else None
    radius, length = number(shape, "radius", 0.0), number(shape, "length", 0.0)
    volumes = {
        "box": math.prod(vector(shape, "size", (0.0, 0.0, 0.0))) if text_of(shape, "size") and kind == "box" else 0.0,
        "sphere": 4.0 / 3.0 * math.pi * radius**3,
        "cylinder": math.pi * radius**2 * length,
        "cone": math.pi * radius**2 * length / 3.0,
        "capsule": math.pi * radius**2 * (length + 4.0 / 3.0 * radius),
        "ellipsoid": 4.0 / 3.0 * math.pi * math.prod(vector(shape, "radii", (0.0, 0.0, 0.0))),
    }
    return abs(density * volumes.get(kind, 0.0))
