"""Walk over rough ground on four legs: a task with a robot from a file."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from gymnasium import spaces

import morse
from morse.gym.task import Command, Read, Task
from morse.many.parameters import uniform
from morse.mathutils import portable

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.many.parameters import Distribution

_MODEL = Path(morse.__file__).parent / "data" / "examples" / "legs" / "walker.urdf"
LEGS = ("front_left", "front_right", "rear_left", "rear_right")
#: height at which the robot begins, m; hip and knee at rest, and how far an action moves them, rad
_HEIGHT, _HIP, _KNEE, _SWAY = 0.48, 0.6, -1.2, 0.6
#: number of slabs on the ground; half of their side, m; their least and largest thickness, m
_SLABS, _SIDE, _THIN, _THICK = 16, 0.3, 0.005, 0.025
#: steps of each leg in a second; speed beyond which there is no reward, m/s; tilt (rad) and height (m) of a fall
_PACE, _SPEED, _TILT, _LOW = 1.6, 0.6, 0.8, 0.2


def rough_ground(layout: int) -> None:
    """The scene of a layout: the robot with four legs, and slabs of 5 to 25 mm on the ground ahead of it."""
    from morse.builder import IMU, Armature, Cube, Environment, Pose, Robot

    rng = np.random.default_rng(layout)
    for number in range(_SLABS):
        thickness = rng.uniform(_THIN, _THICK)
        slab = Cube(f"Slab{number}")
        slab.scale = (_SIDE, _SIDE, 0.5 * thickness)
        slab.location = (rng.uniform(0.8, 5.0), rng.uniform(-1.0, 1.0), 0.5 * thickness)
        slab.rotation_euler = (0.0, 0.0, rng.uniform(0.0, math.pi))
        slab.static()
    walker = Robot(str(_MODEL), name="walker")
    walker.translate(z=_HEIGHT)
    legs = Armature("legs", armature_name="walker_joints")
    legs.properties(RotationSpeed=12.0)
    for part in (legs, Pose("pose"), IMU("imu")):
        walker.append(part)
    Environment("empty")


class Walk(Task):
    """Walk ahead, along X, on four legs over rough ground; a fall ends the episode.

    The robot is that of the demo ``legs``, with the joints of a URDF file. The reward is the way ahead, of which no
    more counts than at 0.6 m/s, less half of the way aside, m, and −3 for a fall. Mass and friction differ between
    episodes.

    The actions are the setpoints of hip and knee of the legs (front left, front right, rear left, rear right), rad. The
    observation is (8,): sine and cosine of the phase of a clock of 1.6 Hz, for the rhythm of the steps; roll, pitch and
    yaw, rad; the rates about x, y and z, rad/s.

    Args:
        layouts: numbers of the layouts of the ground, which the rows use in turn.
    """

    ticks, limit = 2, 180
    action = Command(
        "walker.legs",
        **{f"{leg}_hip": (_HIP - _SWAY, _HIP + _SWAY) for leg in LEGS},
        **{f"{leg}_knee": (_KNEE - _SWAY, _KNEE + _SWAY) for leg in LEGS},
    )
    observation = spaces.Box(-10.0, 10.0, (8,), np.float32)
    data: ClassVar[dict[str, Read]] = {
        "pose": Read("walker.pose", "x", "y", "z", "roll", "pitch", "yaw"),
        "rates": Read("walker.imu", "angular_velocity"),
    }
    vary: ClassVar[Mapping[str, Mapping[str, Distribution]]] = {
        "walker": {"mass": uniform(10.0, 14.0), "friction": uniform(0.6, 1.0)}
    }

    def __init__(self, layouts: Sequence[int] = tuple(range(64))) -> None:
        self.scene = [partial(rough_ground, layout) for layout in layouts]

    def start(self, rows: Sequence[int], rngs: Sequence[np.random.Generator]) -> None:
        """Stand at a random place beside the middle, turned by up to 0.2 rad."""
        if "phase" not in self.values:
            self.values["phase"] = np.zeros(len(self.many))
        self.values["phase"][list(rows)] = 0.0
        poses = [[0.0, rng.uniform(-0.5, 0.5), rng.uniform(-0.2, 0.2)] for rng in rngs]
        self.many.place(rows, "walker", poses)

    def observe(self, data: dict[str, NDArray[np.floating]]) -> NDArray[np.float32]:
        """See the class."""
        phase = data["phase"]
        clock = [portable.sin(phase), portable.cos(phase)]
        rates = np.clip(data["rates"], -10.0, 10.0)
        return np.column_stack([*clock, data["pose"][:, 3:], rates]).astype(np.float32)

    def reward(
        self, before: dict[str, NDArray[np.floating]], now: dict[str, NDArray[np.floating]]
    ) -> tuple[NDArray[np.floating], NDArray[np.bool_], dict[str, NDArray[np.floating]]]:
        """See the class; the infos have ``way``, how far ahead the robot is, m."""
        self.values["phase"] += 2.0 * math.pi * _PACE * self.ticks / 60.0
        pose = now["pose"]
        step = pose[:, :2] - before["pose"][:, :2]
        fallen = (np.abs(pose[:, 3:5]).max(axis=1) > _TILT) | (pose[:, 2] < _LOW)
        ahead = np.minimum(step[:, 0], _SPEED * self.ticks / 60.0)
        return ahead - 0.5 * np.abs(step[:, 1]) - 3.0 * fallen, fallen, {"way": pose[:, 0]}
