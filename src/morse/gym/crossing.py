"""Three robots whose ways cross, and that must not meet: a task for several agents."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.gym.reach import Reach, robot_with
from morse.gym.task import Command, Read, Touch

if TYPE_CHECKING:
    from collections.abc import Sequence

#: distance of the starts and the goals from the centre, m
_FAR = 2.5
AGENTS = ("r0", "r1", "r2")


def crossing() -> None:
    """The scene: three robots around a centre."""
    from morse.builder import Environment

    for number, name in enumerate(AGENTS):
        angle = 2.0 * math.pi * number / len(AGENTS)
        robot_with(name).translate(_FAR * math.cos(angle), _FAR * math.sin(angle), 0.0)
    Environment("empty")


class Crossing(Reach):
    """Each robot drives to the other side of a circle, as the others do; who touches another has failed.

    Observations, actions and rewards are those of `Reach`: a policy for one task is one for the other. For
    `morse.gym.parallel`, with the agents `AGENTS`.
    """

    limit, restarts, scene = 100, True, staticmethod(crossing)
    action = Command("{agent}.motion", v=(0.0, 1.0), w=(-1.5, 1.5))
    data: ClassVar[dict[str, Read | Touch]] = {
        "scan": Read("{agent}.laser", "range_list"),
        "pose": Read("{agent}.pose", "x", "y", "yaw"),
        "hit": Touch("{agent}"),
    }

    def __init__(self) -> None:
        pass

    def start(self, rows: Sequence[int], rngs: Sequence[np.random.Generator]) -> None:
        """Place each robot near its corner, and its goal on the other side."""
        if "goal" not in self.values:
            self.values["goal"] = np.zeros((len(self.many), 2))
        poses = []
        for row, rng in zip(rows, rngs, strict=True):
            angle = 2.0 * math.pi * row / len(AGENTS) + rng.uniform(-0.3, 0.3)
            here = _FAR * np.array([math.cos(angle), math.sin(angle)])
            poses.append([*here, angle + math.pi + rng.uniform(-0.5, 0.5)])
            self.values["goal"][row] = -here
        self.many.place(rows, "{agent}", poses)
