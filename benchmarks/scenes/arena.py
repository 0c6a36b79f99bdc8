"""Robots on the ground of the empty environment between walls and boxes, each with a pose and optional sensors.

Arguments: ``count=10``; ``drive=planar`` or ``wheels``; ``sensors=pose``, ``scan`` or ``panorama``;
``port=60000`` for the pose of the first robot.
"""

import sys

from benchmarks import work
from morse.builder import *
from morse.builder.creator import SensorCreator

ASKED = {"count": "1", "drive": "planar", "sensors": "pose", "port": ""}
ASKED.update(word.split("=") for word in sys.argv[1:] if "=" in word)


class Panorama(SensorCreator):
    _classpath = "benchmarks.scenes.panorama.Panorama"


def block(name, x, y, z, sx, sy, sz):
    made = Cube(name)
    made.scale = (sx / 2, sy / 2, sz / 2)
    made.location = (x, y, z)
    made._bpy_object.game.physics_type = "STATIC"


def cylinder(name, radius, height, z):
    made = Cylinder(name)
    made.scale = (radius, radius, height / 2)
    made.location = (0, 0, z)
    return collide(made, "CYLINDER")


def collide(made, bounds):
    game = made._bpy_object.game
    game.physics_type = "RIGID_BODY"
    game.collision_bounds_type = bounds
    game.use_collision_bounds = True
    return made


def planar_robot(number):
    robot = Robot(name=f"r{number}")
    robot.properties(GroundRobot=True)
    robot.append(cylinder(f"body{number}", work.RADIUS, work.HEIGHT, work.HEIGHT / 2))
    robot.set_rigid_body()
    robot.set_mass(work.MASS)
    return robot, MotionVW(f"motion{number}")


def wheeled_robot(number):
    return Pioneer3DX(f"r{number}"), MotionVWDiff(f"motion{number}")


for number, sizes in enumerate(work.blocks(int(ASKED["count"]))):
    block(f"Block{number}", *sizes)

for number, (x, y, yaw) in enumerate(work.starts(int(ASKED["count"]))):
    robot, motion = (planar_robot if ASKED["drive"] == "planar" else wheeled_robot)(number)
    robot.translate(x, y, 0.0)
    robot.rotate(0, 0, yaw)
    robot.append(motion)
    pose = Pose(f"pose{number}")
    robot.append(pose)
    if ASKED["sensors"] == "scan":
        laser = Sick(f"laser{number}")
        laser.translate(0, 0, work.SCAN_HEIGHT)
        robot.append(laser)
    elif ASKED["sensors"] == "panorama":
        eye = Panorama(f"eye{number}")
        eye.translate(0, 0, work.PANORAMA_HEIGHT)
        eye.frequency(work.SCAN_RATE)
        robot.append(eye)
    robot.add_default_interface("socket")
    if ASKED["port"] and number == 0:
        pose.add_stream("socket", port=int(ASKED["port"]))

env = Environment("empty", fastmode=True)
