"""Friction and restitution of collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, boolean, number
from morse.scene import BodySettings, PhysicsType

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.scene import Bounds

#: The smaller friction coefficient of two surfaces applies in Gazebo. Its default, and larger ones, mean that the other
#: surface decides, as the default of MORSE does.
_ROUGH = 1.0
_FRICTIONS = ("surface/friction/ode/mu", "surface/friction/bullet/friction")


def settings_of(collision: Element, bounds: Bounds | None) -> BodySettings:
    """The settings of a shape that collides."""
    body = BodySettings(type=PhysicsType.STATIC, bounds=bounds)
    for path in _FRICTIONS:
        mu = _number(collision, path)
        if mu is not None and 0.0 <= mu < _ROUGH:
            body.friction = mu
            break
    restitution = _number(collision, "surface/bounce/restitution_coefficient")
    if restitution is not None:
        body.restitution = min(max(restitution, 0.0), 1.0)
    body.ghost = boolean(collision, "surface/contact/collide_without_contact")
    return body


def _number(element: Element, path: str) -> float | None:
    try:
        value = number(element, path, -1.0)
    except ValueMistakeError:
        return None
    return value if value >= 0.0 else None
