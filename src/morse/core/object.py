"""The base class of robots, sensors and actuators."""

from __future__ import annotations

import copy
import logging
from typing import TYPE_CHECKING, Any

from morse.core import context as _context
from morse.core.abstractobject import AbstractObject
from morse.core.declarations import data_fields, levels, properties
from morse.core.services import service
from morse.helpers.transformation import Transformation3d

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context

logger = logging.getLogger("morse." + __name__)


class Object(AbstractObject):
    """A component: something with a place in the world that does some work every tick.

    Attributes:
        bge_object: the object of the world that carries it (`morse.physics.GameObject`).
        robot_parent: the robot that carries it, or None for a robot.
        position_3d: its pose in the world, updated before each action.
        level: abstraction level.
        frequency: Hz.
        context: the running simulation.
    """

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__()
        self.bge_object = obj
        self.robot_parent = parent
        self.context: Context = _context.current()
        self.clock = self.context.clock
        self._active = True
        self.frequency = float(obj.get("frequency", self.clock.frequency))
        self.level = self._chosen_level(obj.get("abstraction_level"))
        for name, field in data_fields(type(self)).items():
            if field.level == "all" or self.level is None or self.level in _as_tuple(field.level):
                self.local_data[name] = copy.deepcopy(field.default)
        for python_name, prop in properties(type(self)).items():
            setattr(self, python_name, obj[prop.name] if prop.name in obj else copy.deepcopy(prop.default))
        self.position_3d = Transformation3d(obj)
        self.initial_position_3d = Transformation3d(obj)
        self.input_functions: list[Callable[[Any], bool]] = []
        self.output_functions: list[Callable[[Any], Any]] = []
        self.input_modifiers: list[Any] = []
        self.output_modifiers: list[Any] = []

    def _chosen_level(self, asked: Any) -> str | None:
        declared = levels(type(self))
        if asked in declared:
            return str(asked)
        return next((name for name, level in declared.items() if level.default), None)

    def name(self) -> str:
        """The fully qualified name, e.g. ``robot.arm.pose``."""
        return str(self.bge_object.name)

    @property
    def active(self) -> bool:
        """Whether it acts at all."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        self._active = bool(value)

    def toggle_active(self) -> None:
        """Switch between active and inactive."""
        self._active = not self._active

    def periodic_call(self) -> bool:
        """Whether it is the turn of this component: always, as its action is called at its frequency alone."""
        return True

    def gettime(self) -> float:
        """Simulated time, s."""
        return self.clock.time

    def sensor_to_robot_position_3d(self) -> Transformation3d:
        """The pose of the component in the frame of its robot."""
        main = Transformation3d(self.robot_parent.bge_object)
        return main.transformation3d_with(Transformation3d(self.bge_object))

    def in_zones(self, name: str | None = None, type: str | None = None) -> set[str]:
        """Names of the zones that the component is in, of that name or type if given."""
        x, y, z = self.bge_object.worldPosition
        inside = set()
        for zone in self.context.scene.zones:
            if (name is not None and zone.node.name != name) or (type is not None and zone.type != type):
                continue
            centre, half = zone.node.location, zone.node.scale
            if all(abs(p - c) <= h for p, c, h in zip((x, y, z), centre, half, strict=True)):
                inside.add(zone.node.name)
        return inside

    @service
    def get_properties(self) -> dict[str, dict[str, tuple[Any, str, str, str]]]:
        """The properties: name to value, type, documentation, name in Python."""
        return {
            "properties": {
                prop.name: (getattr(self, python_name), prop.type, prop.doc, python_name)
                for python_name, prop in properties(type(self)).items()
            }
        }

    @service
    def set_property(self, name: str, value: Any) -> None:
        """Change a property while the simulation runs."""
        from morse.core.values import checked_property

        python_name, checked = checked_property(self, name, value)
        setattr(self, python_name, checked)

    @service
    def get_configurations(self) -> dict[str, Any]:
        """The values of the properties, and where the component sits on its robot."""
        configuration: dict[str, Any] = {
            prop.name: getattr(self, python_name) for python_name, prop in properties(type(self)).items()
        }
        if self.robot_parent is not None:
            pose = self.sensor_to_robot_position_3d()
            configuration["object_to_robot"] = {"rotation": pose.rotation_matrix, "translation": pose.translation}
        return {"configurations": configuration}

    def update_pose(self) -> None:
        """Take the present pose of the object into ``position_3d``."""
        self.position_3d.update(self.bge_object)


def _as_tuple(level: str | tuple[str, ...]) -> tuple[str, ...]:
    return (level,) if isinstance(level, str) else level
