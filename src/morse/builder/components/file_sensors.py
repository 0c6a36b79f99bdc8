"""Sensors that the file of a robot declares."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from morse.builder.components.cameras import MOUNTED
from morse.builder.names.classes import load_class
from morse.mathutils import Euler, Matrix

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.scene.declared_sensor import DeclaredSensor


def add_sensors(robot: AbstractComponent, declared: Iterable[DeclaredSensor]) -> dict[str, Any]:
    """Create the sensors of a file on the links of a robot, and return them by name."""
    found: dict[str, Any] = {}
    for one in declared:
        name = base = re.sub(r"\W", "_", one.name, flags=re.ASCII) or "sensor"
        number = 1
        while name in found:
            number += 1
            name = f"{base}_{number}"
        made = load_class(f"morse.builder.sensors.{one.product}")(name)
        r = one.rotation
        turned = Matrix((r[:3], r[3:6], r[6:]))
        if hasattr(made, "rotate") and made.scene_node.rotation_euler[:] == list(MOUNTED):
            turned = turned @ Euler(MOUNTED).to_matrix()
        made.scene_node.location[:] = one.position
        made.scene_node.rotation_euler[:] = list(turned.to_euler())
        if one.properties:
            made.properties(**dict(one.properties))
        if one.frequency is not None:
            made.frequency(one.frequency)
        robot.append(made, one.link)
        found[name] = made
    return found
