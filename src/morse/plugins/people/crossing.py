"""Cross a crowd: a task of reinforcement learning, with the measures that are usual for robots among people."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from gymnasium import spaces

from morse.gym.reach import robot_with
from morse.gym.task import Command, Read, Task, Touch
from morse.mathutils import portable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.gym.values import Arrays

#: number of people; of those that the robot sees, the nearest ones
_PEOPLE, _SEEN = 12, 5
#: m: distance of start and goal from the middle; radius of the robot; distance at which the goal is reached
_FAR, _RADIUS, _REACHED = 4.0, 0.2, 0.4
#: m: personal space (Hall 1966), between the surface of the robot and the middle of a person
_PERSONAL = 1.2
#: m: half of the breadth of a person
_BODY = 0.2


def crossing(people: int = _PEOPLE) -> None:
    """The scene: two streams of people along Y, and a robot that has to come from one side to the other."""
    from morse.builder import Environment
    from morse.plugins.people.builder import Crowd

    half = people // 2
    crowd = Crowd("people", people)
    down, up = [(-2.5, -7.0), (2.5, -6.0)], [(-2.5, 6.0), (2.5, 7.0)]
    crowd.start([(-2.5, -6.0), (2.5, 6.0)], half, goals=[up, down], then="repeat")
    crowd.start([(-2.5, -6.0), (2.5, 6.0)], people - half, goals=[down, up], then="repeat")
    robot_with("robot").translate(-_FAR, 0.0, 0.0)
    Environment("empty")


class CrossCrowd(Task):
    """Drive through two streams of people to a goal on the other side, 8 m away; a collision ends the episode.

    The observation is (28,): distance of the goal / 10 m, cosine and sine of its bearing; then of each of the five
    nearest people, the nearest first: position / 5 m and velocity, m/s, in the axes of the robot, and gap of both
    bodies / 5 m.

    The infos are the measures of the episode so far: ``time`` (s), ``closest`` (m, between the robot and the nearest
    body), ``intrusion`` (s, in which somebody was within 1.2 m, the personal space of Hall 1966), ``collisions``, and
    ``is_success``.

    Args:
        people: number of people.
    """

    ticks, limit, restarts = 6, 300, True
    action = Command("robot.motion", v=(0.0, 1.2), w=(-1.5, 1.5))
    observation = spaces.Box(-8.0, 8.0, (3 + 5 * _SEEN,), np.float32)
    data: ClassVar[dict[str, Read | Touch]] = {
        "pose": Read("robot.pose", "x", "y", "yaw"),
        "positions": Read("people", "positions"),
        "velocities": Read("people", "velocities"),
        "hit": Touch("robot"),
    }

    def __init__(self, people: int = _PEOPLE) -> None:
        if not 1 <= people <= 200:
            raise ValueError(f"CrossCrowd(people) is 1 to 200, not {people}")

        def scene() -> None:
            crossing(people)

        self.scene = scene

    def start(self, rows: Sequence[int], rngs: Sequence[np.random.Generator]) -> None:
        """Place the robot at its side, and begin the measures."""
        count = len(self.many)
        for name in ("time", "intrusion", "collisions"):
            self.values.setdefault(name, np.zeros(count))[rows] = 0.0
        self.values.setdefault("closest", np.zeros(count))[rows] = math.inf
        self.values.setdefault("touched", np.zeros(count, dtype=bool))[rows] = False
        goals = self.values.setdefault("goal", np.zeros((count, 2)))
        poses = []
        for row, rng in zip(rows, rngs, strict=True):
            poses.append([-_FAR, rng.uniform(-1.0, 1.0), rng.uniform(-0.3, 0.3)])
            goals[row] = (_FAR, rng.uniform(-1.0, 1.0))
        self.many.place(rows, "robot", poses)

    def observe(self, data: Arrays) -> NDArray[np.float32]:
        """See the class."""
        pose = data["pose"]
        c, s = portable.cos(pose[:, 2]), portable.sin(pose[:, 2])

        def own(vectors: np.ndarray) -> np.ndarray:
            x, y = vectors[..., 0], vectors[..., 1]
            turned = [c[:, None] * x + s[:, None] * y, c[:, None] * y - s[:, None] * x]
            return np.stack(turned, axis=-1)

        ahead = own((data["goal"] - pose[:, :2])[:, None])[:, 0]
        far = np.maximum(np.sqrt((ahead * ahead).sum(axis=1)), 1e-9)
        apart, gap = self._gaps(data)
        order = np.argsort(gap, axis=1, kind="stable")[:, :_SEEN]
        rows = np.arange(len(pose))[:, None]
        velocities = _people(data["velocities"])[rows, order]
        seen = np.zeros((len(pose), _SEEN, 5))
        seen[:, :, 0] = seen[:, :, 4] = 1.0
        seen[:, : order.shape[1], :2] = own(apart[rows, order]) / 5.0
        seen[:, : order.shape[1], 2:4] = own(velocities)
        seen[:, : order.shape[1], 4] = gap[rows, order] / 5.0
        parts = [far[:, None] / 10.0, ahead / far[:, None], seen.reshape(len(pose), -1)]
        seen_by_the_robot: NDArray[np.float32] = np.clip(np.concatenate(parts, axis=1), -8.0, 8.0).astype(np.float32)
        return seen_by_the_robot

    @staticmethod
    def _gaps(data: Arrays) -> tuple[np.ndarray, np.ndarray]:
        """Return the vectors (N, P, 2) to people and the gaps (N, P) to their bodies, m."""
        apart = _people(data["positions"]) - data["pose"][:, None, :2]
        return apart, np.sqrt((apart * apart).sum(axis=2)) - _RADIUS - _BODY

    def reward(self, before: Arrays, now: Arrays) -> tuple[np.ndarray, np.ndarray, Arrays]:
        """The way towards the goal, m; -0.02 in personal space; +5 at the goal, -5 for a collision."""
        seconds = self.ticks / 60.0
        was, far = (np.hypot(*(data["goal"] - data["pose"][:, :2]).T) for data in (before, now))
        _, gap = self._gaps(now)
        nearest = gap.min(axis=1)
        close = nearest < _PERSONAL - _BODY
        hit = now["hit"].astype(bool) | (nearest <= 0.0)
        reached = (far < _REACHED) & ~hit
        values = self.values
        values["time"] += seconds
        values["intrusion"] += seconds * close
        values["collisions"] += hit & ~values["touched"]
        values["touched"] = hit
        values["closest"] = np.minimum(values["closest"], np.maximum(nearest, 0.0))
        infos = {name: values[name].copy() for name in ("time", "closest", "intrusion", "collisions")}
        reward = was - far - 0.01 - 0.02 * close + 5.0 * reached - 5.0 * hit
        return reward, reached | hit, {**infos, "is_success": reached}


def _people(flat: np.ndarray) -> np.ndarray:
    """Return places or velocities (N, P, 2) of numbers (N, P, 3) or (N, 3 P)."""
    return flat.reshape(len(flat), -1, 3)[:, :, :2]


#: the entry point ``morse.tasks``: name to the class
TASKS = {"morse/CrossCrowd-v0": "morse.plugins.people.crossing:CrossCrowd"}
