"""Inverse kinematics targets for the tips of bones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.helpers.inverse_kinematics import Target, improve, kicked
from morse.mathutils.rotations import product, quaternion_from_rotation, rotation_from_quaternion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.core.values import Fields
    from morse.core.world import Body
    from morse.helpers.chain import Chain

#: prefix of the name of a target, followed by the names of the component and the bone
PREFIX = "ik_target"
#: property of a target with the name of its bone
BONE = "IK_Bone"
#: number of iterations per tick
_ITERATIONS = 4
#: number of restarts from other joint values, and the ticks for each
_ATTEMPTS, _PATIENCE = 12, 12
#: squared error above which the search is restarted, m^2
_FAR = 1e-6

_Pose = tuple["Sequence[float]", "Sequence[float]"]


class Follower:
    """Moves the tips of bones to their targets, with a few iterations in each tick.

    If the search is stuck in a local minimum, for example if the arm is stretched and the target is closer to its base,
    it is restarted from other joint values. The joints only move to solutions that are closer to the targets.
    """

    def __init__(self) -> None:
        self._goal: tuple[Any, ...] = ()
        self._trial: list[float] | None = None
        self._attempt = self._ticks = 0
        #: joint values that could not be improved
        self._settled: list[float] | None = None

    def follow(self, chain: Chain, targets: Sequence[Target], values: Sequence[float]) -> list[float]:
        """Return the joint values for this tick.

        Args:
            targets: poses of the targets in the frame of the armature.
            values: present joint values.
        """
        goal = tuple(targets)
        if goal != self._goal:
            self._goal, self._trial, self._attempt, self._ticks = goal, None, 0, 0
            self._settled = None
        if self._settled is not None and self._settled == values:
            return self._settled
        best = improve(chain, targets, values, 0 if self._trial is not None else _ITERATIONS)
        if self._trial is None:
            if best.is_final and best.error > _FAR and self._attempt < _ATTEMPTS:
                self._trial, self._ticks = kicked(chain, best.values, self._attempt), 0
                self._attempt += 1
            elif best.is_final:
                self._settled = best.values
            return best.values
        trial = improve(chain, targets, self._trial, _ITERATIONS)
        self._trial, self._ticks = trial.values, self._ticks + 1
        if trial.error < 0.5 * best.error:
            self._trial = None
            return trial.values
        if trial.is_final or self._ticks >= _PATIENCE:
            self._trial = None
        return best.values


def targets_of(obj: Body) -> Fields:
    """The targets of an armature by name."""
    return {child.name: child for child in obj.children if BONE in child.properties}


def seen_from(chain: Chain, targets: Iterable[Any], lever: float) -> list[Target]:
    """Return the targets of existing bones, in the frame of the armature.

    Args:
        lever: weight of an error of one radian, m.
    """
    poses = []
    for target in targets:
        index = chain.index(str(target.properties[BONE]))
        if index is not None:
            (x, y, z), r = target.local_pose()
            poses.append(Target(index, ((x, y, z), tuple(r)), lever))
    return poses


def nearer(here: _Pose, goal: _Pose, way: float, step_angle: float) -> tuple[_Pose, bool]:
    """Return the next pose on the way to a goal, and whether it is the goal.

    Args:
        way: largest distance to move, m.
        step_angle: largest angle to rotate, rad.
    """
    offset = [b - a for a, b in zip(here[0], goal[0], strict=True)]
    distance = math.hypot(*offset)
    a, b, c, d, e, f, g, h, i = here[1]
    turn_left = product((a, d, g, b, e, h, c, f, i), tuple(goal[1]))  # type: ignore[arg-type]
    w, x, y, z = quaternion_from_rotation(turn_left)
    sine = math.sqrt(x * x + y * y + z * z)
    angle = 2.0 * math.atan2(sine, w)
    there, is_aligned = distance <= way, angle <= step_angle
    position = tuple(goal[0]) if there else tuple(p + way / distance * m for p, m in zip(here[0], offset, strict=True))
    rotation = tuple(goal[1])
    if not is_aligned:
        half, unit = 0.5 * step_angle, math.sin(0.5 * step_angle) / sine
        step = rotation_from_quaternion(math.cos(half), unit * x, unit * y, unit * z)
        rotation = product(tuple(here[1]), step)  # type: ignore[arg-type]
    return (position, rotation), there and is_aligned
