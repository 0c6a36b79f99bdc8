"""Sensors and actuators that the file of a robot declares."""

from __future__ import annotations

import logging
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder.components.sensors import MOUNTED
from morse.builder.errors.declared import check_declared
from morse.builder.names.catalog import load_class
from morse.core.declarations import properties
from morse.core.validation.spec import PropertyError
from morse.mathutils import Euler, Matrix

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.scene import Node
    from morse.scene.component import DeclaredSensor

logger = logging.getLogger(__name__)


def add_walkers(roots: Iterable[Node], declarations: Iterable[DeclaredSensor], file: str) -> None:
    """Make robots, which carry nothing but their path, of the objects of a world that move."""
    from morse.builder import workspace

    nodes = {root.source_name: root for root in roots}
    for one in declarations:
        node = nodes.get(one.link)
        if node is None:
            continue
        robot = load_class("morse.builder.robots.FakeRobot")(re.sub(r"\W", "_", one.name, flags=re.ASCII) or "actor")
        robot.scene_node.location[:] = node.location
        robot.scene_node.rotation_euler[:] = node.rotation_euler
        node.location[:] = node.rotation_euler[:] = 0.0, 0.0, 0.0
        workspace.current().attach(robot.scene_node, node)
        add_sensors(robot, [replace(one, name="path", link="")], file, "actuators")


def add_sensors(
    robot: AbstractComponent, declarations: Iterable[DeclaredSensor], file: str, package: str = "sensors"
) -> dict[str, AbstractComponent]:
    """Create the sensors or actuators of a file on the links of a robot, and return them by name.

    What has a value that its class refuses is left out, with a warning.

    Args:
        file: its name, for warnings.
    """
    sensors: dict[str, AbstractComponent] = {}
    for one in declarations:
        name = base = re.sub(r"\W", "_", one.name, flags=re.ASCII) or package[:-1]
        number = 1
        while name in sensors:
            number += 1
            name = f"{base}_{number}"
        product = load_class(f"morse.builder.{package}.{one.product}")
        try:
            check_declared(load_class(product._classpath), dict(one.properties))
        except PropertyError as error:
            logger.warning("%s: %s is left out: %s", file, one.origin or f"'{one.name:.80}'", error)
            continue
        sensor = product(name)
        r = one.rotation
        rotation = Matrix((r[:3], r[3:6], r[6:]))
        if hasattr(sensor, "rotate") and sensor.scene_node.rotation_euler[:] == list(MOUNTED):
            rotation = rotation @ Euler(MOUNTED).to_matrix()
        sensor.scene_node.location[:] = one.position
        sensor.scene_node.rotation_euler[:] = list(rotation.to_euler())
        if one.properties:
            sensor.properties(**dict(one.properties))
        if "on_demand" in properties(sensor.component_class()):
            # many are for other programs, and images and rays cost more than the physics
            sensor.properties(on_demand=True)
        if one.frequency is not None:
            sensor.frequency(one.frequency)
            sensor._keeps_tick = True
        for field, deviation in one.noise:
            sensor.noise(gaussian=deviation, field=field or None)
        if one.has_own_visual:
            for node in sensor.own_nodes():
                node.visible = False
        sensor._is_optional = True
        sensor._file_options = dict(one.stream)
        robot.append(sensor, one.link if one.link and one.link != robot.scene_node.source_name else None)
        sensors[name] = sensor
    return sensors
