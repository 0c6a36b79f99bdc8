"""Robots that are created from the declarations of their class."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets import search
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.names.classes import load_class
from morse.core.classes.builder_defaults import RobotDefaults

if TYPE_CHECKING:
    from collections.abc import Mapping

#: ``RobotDefaults.drive`` to the builder class that implements it
DRIVES: Mapping[str, type[Robot]] = {"free": Robot, "ground": GroundRobot, "wheels": WheeledRobot}


def robot_defaults(cls: type) -> RobotDefaults:
    """Return the declaration of a robot class; the default is a ground robot with the model of the same name."""
    defaults = getattr(cls, "_builder", None)
    if isinstance(defaults, RobotDefaults):
        return defaults
    project, _, file = cls.__module__.rpartition(".robots.")
    own = f"{project}/robots/{file}.blend"
    try:
        search.find(own, "robots")
    except FileNotFoundError:
        own = ""
    wheeled = any(base.__name__ == "PhysicsDifferentialRobot" for base in cls.__mro__)
    return RobotDefaults(own or None, drive="wheels" if wheeled else "ground")


class DeclaredRobot(Robot):
    """A robot whose model and properties come from the `RobotDefaults` of its component class.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
    """

    def __init__(self, name: str | None = None) -> None:
        defaults = robot_defaults(load_class(self._classpath))
        super().__init__(defaults.model or "", name)
        if defaults.rigid_body:
            self.set_rigid_body()
        if not defaults.collides:
            self.set_no_collision()
        self.properties(**defaults.properties)
