"""The names for scene scripts: ``from morse.builder import *``.

A script creates robots, appends sensors and actuators to them, and finally creates an `Environment`. There is one class
for each component in ``morse/sensors`` and ``morse/actuators``, with the name of the component.
"""

# every name of this module is meant for scripts
# ruff: noqa: F401

import logging
import math
import os
import pprint
import sys

from morse import mathutils
from morse.builder import actuators, bpymorse, robots, sensors
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.component import Component
from morse.builder.components.passive import PassiveObject, Zone
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.components.sensors import LaserSensorWithArc
from morse.builder.components.solids import (
    Camera,
    Cone,
    Coordsys,
    Cube,
    Cylinder,
    Empty,
    IcoSphere,
    Mesh,
    Plane,
    Sphere,
    Spot,
    Torus,
)
from morse.builder.creator import ActuatorCreator, ComponentCreator, SensorCreator
from morse.builder.data import Configuration
from morse.builder.derive import installed_classes
from morse.builder.environment import Environment
from morse.builder.names.projects import ProjectFinder
from morse.core.classes.plugins import entry_points
from morse.core.exceptions import (
    BadSyntaxError,
    MorseBuilderBadSyntaxError,
    MorseBuilderError,
    MorseBuilderNoComponentError,
    MorseBuilderUnexportableError,
    MorseDeclarationError,
    MorseEnvironmentError,
    MorseError,
    MorseMethodNotFoundError,
    MorseMiddlewareError,
    MorseMultinodeError,
    MorseRPCInvokationError,
    MorseRPCNbArgsError,
    MorseRPCTypeError,
    MorseServiceAlreadyRunningError,
    MorseServiceError,
    MorseWrongArgsError,
    NoComponentError,
    UnexportableError,
)
from morse.scene import TimeStrategies
from morse.system import OF_MACHINE as _OF_MACHINE

logger = logging.getLogger("morse.builder")

for _module in (sensors, actuators, robots):
    globals().update({_name: getattr(_module, _name) for _name in _module.__all__})

ProjectFinder().install()

#: the packages whose components are among these names, and the names; a project brings others for its own code alone
_points = entry_points("morse.components")
_packaged = installed_classes(__name__)
for _name, _class in _packaged.items():
    if _name in globals():
        logger.warning(
            "%s of an installed package is left out: MORSE has a class of that name", _name, extra=_OF_MACHINE
        )
    else:
        globals()[_name] = _class

# scripts of 1.4 use these modules without importing them
_MODULES = ("bpymorse", "logging", "math", "mathutils", "os", "pprint", "sys")

__all__ = [
    name
    for name, value in list(globals().items())
    if not name.startswith("_")
    and name not in ("ProjectFinder", "annotations", "entry_points", "installed_classes")
    and (name in _MODULES or not isinstance(value, type(sys)))
]
