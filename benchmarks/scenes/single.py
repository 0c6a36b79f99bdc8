"""One robot with one component: ``class=Pose``; ``class=empty`` for one that does nothing."""

import sys

import morse.builder
from morse.builder import *
from morse.builder.creator import SensorCreator

(NAME,) = (argument.removeprefix("class=") for argument in sys.argv[1:])


class Idle(SensorCreator):
    _classpath = "benchmarks.scenes.idle.Idle"


robot = Pioneer3DX("robot") if NAME == "MotionVWDiff" else Morsy("robot")
component = Idle("component") if NAME == "empty" else getattr(morse.builder, NAME)("component")
robot.append(component)

env = Environment("indoors-1/boxes", fastmode=True)
