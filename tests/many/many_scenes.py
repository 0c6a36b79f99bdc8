"""Scenes of the tests of batches."""

from __future__ import annotations


def body(robot, mass=10.0, radius=0.2):
    """Give a robot a cylinder as its body."""
    from morse.builder import Cylinder

    shape = Cylinder(f"body_of_{robot.name}")
    shape.scale, shape.location = (radius, radius, 0.15), (0.0, 0.0, 0.15)
    game = shape._bpy_object.game
    game.physics_type, game.collision_bounds_type, game.use_collision_bounds = "RIGID_BODY", "CYLINDER", True
    robot.properties(GroundRobot=True)
    robot.append(shape)
    robot.set_rigid_body()
    robot.set_mass(mass)


def block(name, x, y, half_x, half_y, static=True):
    from morse.builder import Cube

    cube = Cube(name)
    cube.scale, cube.location = (half_x, half_y, 0.5), (x, y, 0.5)
    cube._bpy_object.game.physics_type = "STATIC" if static else "RIGID_BODY"
    return cube


def arena():
    """A planar robot with a scanner between four walls, 2 m from its start."""
    from morse.builder import Environment, MotionVW, Pose, Robot, Sick

    robot = Robot(name="robot")
    body(robot)
    laser = Sick("laser")
    laser.translate(0.0, 0.0, 0.2)
    laser.frequency(10)
    laser.level("range")
    for part in (MotionVW("motion"), Pose("pose"), laser):
        robot.append(part)
    walls = [(2.0, 0.0, 0.1, 2.0), (-2.0, 0.0, 0.1, 2.0), (0.0, 2.0, 2.0, 0.1), (0.0, -2.0, 2.0, 0.1)]
    for number, wall in enumerate(walls):
        block(f"Wall{number}", *wall)
    Environment("empty")


def crowded_arena():
    """A robot with sensors of many kinds, noise and a delay, beside a second robot and a crate."""
    from morse.builder import (
        GPS,
        IMU,
        Accelerometer,
        Clock,
        Collision,
        DepthVideoCamera,
        Environment,
        MotionVWDiff,
        MotionXYW,
        Odometry,
        Pioneer3DX,
        Pose,
        Proximity,
        Robot,
        Sick,
        VideoCamera,
    )

    robot = Pioneer3DX("robot")
    gps = GPS("gps")
    gps.noise(gaussian=0.1)
    pose = Pose("pose")
    pose.delay(0.07)
    laser = Sick("laser")
    laser.noise(gaussian=0.01, field="range_list")
    laser.frequency(7)
    camera, depth = VideoCamera("camera"), DepthVideoCamera("depth")
    for eye in (camera, depth):
        eye.properties(cam_width=16, cam_height=12)
        eye.translate(0.3, 0.0, 0.6)
    parts = [
        MotionVWDiff("motion"), gps, pose, laser, camera, depth, IMU("imu"), Odometry("odometry"),
        Accelerometer("accelerometer"), Collision("bumper"), Proximity("proximity"), Clock("clock"),
    ]  # fmt: skip
    for part in parts:
        robot.append(part)
    second = Robot(name="second")
    body(second)
    second.translate(1.5, 0.2, 0.0)
    for part in (MotionXYW("motion"), Pose("pose")):
        second.append(part)
    block("Crate", -1.5, 0.0, 0.3, 0.3, static=False)
    block("Wall", 3.0, 0.0, 0.1, 3.0)
    Environment("empty")
