"""A page for each robot."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from component_library import pictures, scenes
from component_library.declared import own_services, property_table, service_list
from component_library.markdown import block, code, page, prose, section, table
from component_library.sizes import extent
from morse.builder import robots, workspace
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot

if TYPE_CHECKING:
    from collections.abc import Iterator


def robot_classes() -> dict[str, type[Robot]]:
    """The robots of MORSE by name, sorted."""
    return {name: getattr(robots, name) for name in sorted(robots.__all__)}


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    return {f"robots/{name.lower()}": _page(name, cls) for name, cls in robot_classes().items()}


def short_description(builder: type[Robot]) -> str:
    """What a robot is, in one sentence."""
    return prose(inspect.getdoc(builder)).split("\n\n")[0]


def moved_by(builder: type[Robot]) -> str:
    """How a robot is moved."""
    if issubclass(builder, WheeledRobot):
        return "its wheels, which motors turn"
    if issubclass(builder, GroundRobot):
        return "velocities, as one body that stays on the ground"
    return "velocities, forces or poses, as one body"


def motion_of(builder: type[Robot]) -> str:
    """An actuator that suits a robot."""
    if issubclass(builder, WheeledRobot):
        return "MotionVWDiff"
    return "MotionVW" if issubclass(builder, GroundRobot) else "Teleport"


def bodiless() -> set[str]:
    """The names of the pages of robots that cannot be seen: no picture shows them."""
    names = set()
    for name, builder in robot_classes().items():
        workspace.reset()
        if extent(builder().scene_node) is None:
            names.add(name.lower())
    return names


def _page(name: str, builder: type[Robot]) -> str:
    workspace.reset()
    robot = builder()
    cls = robot.component_class()
    assert cls is not None
    return page(
        name,
        prose(inspect.getdoc(builder)),
        pictures.of(name),
        table(["", ""], _facts(name, robot)),
        section("Use", block("python", _scene(name, builder))),
        section("Properties", property_table(cls, robot.scene_node.properties)),
        section("Services", service_list(cls, own_services(cls))),
    )


def _scene(name: str, builder: type[Robot]) -> str:
    on_the_ground = issubclass(builder, (GroundRobot, WheeledRobot))
    return scenes.robot_scene(name, motion=motion_of(builder), height=0.0 if on_the_ground else 1.0)


def _facts(name: str, robot: Robot) -> Iterator[list[str]]:
    yield ["in scene scripts", code(f"{name}()")]
    yield ["runs", code(robot.classpath)]
    size = extent(robot.scene_node)
    if size is not None:
        yield ["size", " × ".join(f"{length:.2f}" for length in size) + " m (X, Y, Z)"]
    body = robot.scene_node.body
    yield ["physics", code(body.type)]
    if body.moves:
        yield ["mass", f"{sum(part.mass for part in _masses(robot)):g} kg"]
    yield ["moved by", moved_by(type(robot))]


def _masses(robot: Robot) -> list[object]:
    wheels = robot.wheels() if isinstance(robot, WheeledRobot) else []
    return [robot.scene_node.body, *(wheel.body for wheel in wheels)]
