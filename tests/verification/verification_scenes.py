"""Worlds with many events that might not be repeatable."""

#: robots that drive randomly through heaps of boxes and into each other; lasers and noise
CROWD = """
from morse.builder import *
from morse.builder.creator import ActuatorCreator

class Wander(ActuatorCreator):
    _classpath = "verification_parts.Wander"

for number in range(3):
    robot = ATRV(f"r{number}")
    robot.translate(1.5 * number, 0.0, 0.0)
    robot.append(Wander(f"wander{number}"))
    pose, odometry, sick, near = Pose(), Odometry(), Sick(), Proximity()
    pose.noise(gaussian=0.05, bias_walk=0.01)
    sick.noise(gaussian=0.01, dropout=0.01)
    sick.delay(0.05)
    for sensor in (pose, odometry, sick, near):
        robot.append(sensor)
        sensor.add_stream("socket")
for number in range(12):
    box = Cube(f"Box{number}")
    box.scale = (0.1, 0.1, 0.1)
    box.location = (0.75 + 1.5 * (number % 3), 0.02 * number, 0.1 + 0.21 * (number // 3))
    box._bpy_object.game.physics_type = "RIGID_BODY"
ball = Sphere("Ball")
ball.scale = (0.2, 0.2, 0.2)
ball.location = (0.0, 1.5, 1.0)
ball._bpy_object.game.physics_type = "RIGID_BODY"
ball._bpy_object.game.elasticity = 0.8
env = Environment("indoors-1/boxes", fastmode=True)
env.set_seed(11)
"""

#: real wheels on a floor, on objects with meshes; a robot that is moved instead of driven
WHEELS = """
from morse.builder import *
from morse.builder.creator import ActuatorCreator

class WheelWander(ActuatorCreator):
    _classpath = "verification_parts.WheelWander"

class Wander(ActuatorCreator):
    _classpath = "verification_parts.Wander"

for number in range(2):
    robot = Pioneer3DX(f"p{number}")
    robot.translate(0.0, 1.2 * number, 0.0)
    robot.append(WheelWander())
    for sensor in (Odometry(), Pose(), Infrared()):
        robot.append(sensor)
        sensor.add_stream("socket")
shifted = Morsy()
shifted.translate(-2.0, 0.0, 0.0)
wander = Wander()
wander.properties(Kind="Position")
shifted.append(wander)
thing = PassiveObject("props/objects", "RollingChair")
thing.translate(1.5, 0.0, 0.5)
env = Environment("sandbox", fastmode=True)
env.set_seed(12)
"""

#: robots that clients drive, into boxes and each other
DRIVEN = """
from morse.builder import *

for number in range(2):
    robot = ATRV(f"r{number}")
    robot.translate(1.2 * number, 0.0, 0.0)
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    pose.noise(gaussian=0.1)
    robot.append(pose)
    robot.add_default_interface("socket")
env = Environment("indoors-1/boxes", fastmode=True)
"""
