"""The robot for one component, ``class=Pose``, with the component or without; the class ``empty`` does nothing."""

import sys

import morse.builder
from morse.builder import *
from morse.builder.creator import SensorCreator

ARGUMENTS = dict(word.split("=") for word in sys.argv[1:] if "=" in word)
NAME, CARRIES = ARGUMENTS["class"], ARGUMENTS["carries"] == "True"
WHEELED, FLYING = ("MotionVWDiff", "WheelEncoders"), ("Quadrotor", "Rotorcraft", "StabilizedQuadrotor")
HOLDERS = {"ArmaturePose": "KukaLWR", "PTUPosture": "PTU"}


class Idle(SensorCreator):
    _classpath = "benchmarks.scenes.idle.Idle"


def made(name):
    if name == "empty":
        return Idle("component")
    if name == "Armature":
        return Armature("kuka_armature", model_name="kuka_lwr")
    if name == "CompoundSensor":
        parts = [Pose("one"), Velocity("other")]
        for part in parts:
            robot.append(part)
        return CompoundSensor(parts)
    return getattr(morse.builder, name)("component")


if NAME in WHEELED:
    robot = Pioneer3DX("robot")
elif NAME == "SteerForce":
    robot = Hummer("robot")
elif NAME.startswith(FLYING):
    robot = Quadrotor("robot")
    robot.translate(z=5.0)
elif NAME in ("Drag", "Hydrodynamics"):
    robot = Submarine("robot")
    robot.translate(z=5.0)
else:
    robot = Morsy("robot")

holder = robot
if NAME in HOLDERS:
    holder = getattr(morse.builder, HOLDERS[NAME])("holder")
    robot.append(holder)
if CARRIES:
    component = made(NAME)
    component.frequency(60)
    if NAME == "Destination":
        # as fast as the robots that are driven otherwise: its own speed leads over the edge of the floor
        component.properties(Speed=0.5)
    # usual mounting positions: arms on top, bumpers in front
    if NAME in ("Armature", "KukaLWR", "PA10"):
        component.translate(z=1.7)
    elif NAME in ("Bumper", "Collision"):
        component.translate(x=0.6, z=0.5)
    holder.append(component)

env = Environment("indoors-1/boxes", fastmode=True)
env.properties(longitude=1.43, latitude=43.6, altitude=135.0)
