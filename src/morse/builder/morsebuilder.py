"""The kinds of components, under the module name that scripts of MORSE 1.4 import them from."""

from morse.builder.components.component import Component
from morse.builder.components.passive import PassiveObject, Zone
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.environment import Environment
from morse.builder.robots import FakeRobot

__all__ = [
    "Component",
    "Environment",
    "FakeRobot",
    "GroundRobot",
    "PassiveObject",
    "Robot",
    "WheeledRobot",
    "Zone",
]
