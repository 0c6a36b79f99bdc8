"""Tasks of the tests."""

import numpy as np
from gymnasium import spaces

from morse.core.sensor import Sensor
from morse.gym import Command, Read, Task, Touch
from morse.helpers.components import add_data
from morse.many import uniform


def look_around():
    from morse.builder import ATRV, Cube, DepthVideoCamera, Environment, MotionVW, Pose, VideoCamera

    robot = ATRV("robot")
    camera, depth = VideoCamera("camera"), DepthVideoCamera("depth")
    for eye in (camera, depth):
        eye.properties(cam_width=40, cam_height=36)
        eye.translate(0.4, 0.0, 0.9)
        robot.append(eye)
    for part in (MotionVW("motion"), Pose("pose")):
        robot.append(part)
    wall = Cube("Wall")
    wall.scale, wall.location = (0.1, 3.0, 1.0), (4.0, 0.0, 1.0)
    wall._bpy_object.game.physics_type = "STATIC"
    Environment("empty")


class LookAround(Task):
    """A dictionary of a picture, distances, a pose, a touch, and a value of the task."""

    scene, ticks, limit, camera = look_around, 6, 12, "robot.camera"
    action = Command("robot.motion", v=(-1.0, 1.0), w=(-1.0, 1.0))
    observation = {  # noqa: RUF012
        "image": Read("robot.camera", "image"),
        "pose": Read("robot.pose", "x", "y", "yaw"),
        "hit": Touch("robot"),
        "goal": spaces.Box(-1.0, 1.0, (2,), np.float32),
    }

    def start(self, rows, rngs):
        for row, rng in zip(rows, rngs, strict=True):
            self.values["goal"][row] = rng.uniform(-1.0, 1.0, 2)
        self.many.place(rows, "robot", [[0.0, rng.uniform(-1.0, 1.0), 0.0] for rng in rngs])

    def reward(self, before, now):
        gain = now["pose"][:, 0] - before["pose"][:, 0]
        return gain, np.abs(now["pose"][:, 1]) > 3.0, {"x": now["pose"][:, 0]}


class Picture(LookAround):
    """A picture alone."""

    observation = Read("robot.camera", "image")
    data = {"pose": Read("robot.pose", "x", "y", "yaw")}  # noqa: RUF012

    def start(self, rows, rngs):
        pass


def two_robots():
    from morse.builder import ATRV, Environment, MotionVW, Pose

    for number in range(2):
        robot = ATRV(f"r{number}")
        robot.translate(0.0, 4.0 * number)
        for part in (MotionVW("motion"), Pose("pose")):
            robot.append(part)
    Environment("empty")


class Meet(Task):
    """Two robots of one world drive towards x = 2."""

    scene, ticks, limit = two_robots, 6, 20
    action = Command("{agent}.motion", v=(-1.0, 1.0), w=(-1.0, 1.0))
    observation = Read("{agent}.pose", "x", "y", "yaw")

    def start(self, rows, rngs):
        self.many.place(
            rows, "{agent}", [[rng.uniform(-1.0, 1.0), 4.0 * row, 0.0] for row, rng in zip(rows, rngs, strict=True)]
        )

    def reward(self, before, now):
        x = now["observation"][:, 0]
        return -np.abs(x - 2.0), x > 2.0, {}


def drive_about():
    from morse.builder import ATRV, Environment, MotionVW, Pose

    robot = ATRV("robot")
    pose = Pose("pose")
    pose.noise(gaussian=0.01)
    for part in (MotionVW("motion"), pose):
        robot.append(part)
    Environment("empty")


class DriveAbout(Task):
    """Short episodes from places at random, a noisy sensor, and infos of all forms."""

    scene, ticks, limit = drive_about, 2, 7
    action = Command("robot.motion", v=(-1.0, 1.0), w=(-1.0, 1.0))
    observation = Read("robot.pose", "x", "y", "yaw")
    vary = {"robot": {"mass": uniform(20.0, 30.0)}}  # noqa: RUF012

    def start(self, rows, rngs):
        self.many.place(rows, "robot", [[*rng.uniform(-2.0, 2.0, 2), 0.0] for rng in rngs])

    def reward(self, before, now):
        x = now["observation"][:, 0]
        names = np.array(["far" if abs(value) > 1.0 else "quite near" for value in x])
        return x, np.abs(x) > 2.02, {"x": x, "ticks": self.ticks, "where": names, "pair": np.stack([x, -x], 1)}


class Frail(Sensor):
    """A sensor that fails in its fourth measurement, or while it ends."""

    add_data("count", 0, "int", "Number of measurements")
    fails = "in its fourth measurement"

    def default_action(self):
        self.local_data["count"] += 1
        if self.local_data["count"] > 3 and self.fails == "in its fourth measurement":
            raise ValueError("too frail")

    def finalize(self):
        super().finalize()
        if self.fails == "while it ends":
            raise OSError("no end")


def frail():
    from morse.builder import ATRV, Environment, MotionVW, Pose

    robot = ATRV("robot")
    for part in (MotionVW("motion"), Pose("pose"), Frail("frail")):
        robot.append(part)
    Environment("empty", fastmode=True)


class Fragile(Task):
    """Its scene has a sensor that fails."""

    scene, ticks, limit = frail, 6, 100
    action = Command("robot.motion", v=(-1.0, 1.0), w=(-1.0, 1.0))
    observation = Read("robot.pose", "x", "y")

    def reward(self, before, now):
        x = now["observation"][:, 0]
        return x, np.zeros(len(x), bool), {}
