"""The kinds of components, under the module name that scripts of MORSE 1.4 import them from."""

import logging
import math
import os
import sys

from morse.builder import bpymorse
from morse.builder.abstractcomponent import AbstractComponent, Configuration, timer
from morse.builder.components.component import Component
from morse.builder.components.passive import PassiveObject, Zone
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.environment import Environment
from morse.builder.robots import FakeRobot
from morse.scene import TimeStrategies

# scripts of 1.4 use the modules without importing them
__all__ = [
    "AbstractComponent",
    "Component",
    "Configuration",
    "Environment",
    "FakeRobot",
    "GroundRobot",
    "PassiveObject",
    "Robot",
    "TimeStrategies",
    "WheeledRobot",
    "Zone",
    "bpymorse",
    "logging",
    "math",
    "os",
    "sys",
    "timer",
]
