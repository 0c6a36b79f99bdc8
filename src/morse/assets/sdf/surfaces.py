"""Friction and restitution of collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.friction import friction_of
from morse.assets.gazebo.values import ValueMistakeError, boolean, number
from morse.scene import BodySettings, PhysicsType

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.scene import Bounds

_FRICTIONS = ("surface/friction/ode/mu", "surface/friction/bullet/friction")


def settings_of(collision: Element, bounds: Bounds | None) -> BodySettings:
    """The settings of a shape that collides."""
    body = BodySettings(type=PhysicsType.STATIC, bounds=bounds)
    body.friction = friction_of(collision, _FRICTIONS)
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
