"""Inverse kinematics: joint values that move the tips of bones to given poses.

Damped least squares (Levenberg-Marquardt) on the geometric Jacobian; see Buss, "Introduction to Inverse Kinematics
with Jacobian Transpose, Pseudoinverse and Damped Least Squares methods" (2009). Joints at a limit are excluded from a
step, so that the others compensate. The result only depends on the arguments.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.portable import matmul, solve
from morse.mathutils.rotations import product, rotation_vector, turn
from morse.scene import JointKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.helpers.chain import Chain, Pose


#: default weight of an error of one radian, m: an arm that cannot reach its target keeps the orientation, as in 1.4
LEVER = 1.5
#: maximum step of a joint in one iteration, rad or m
_STRIDE = 0.4
#: damping, as a factor of the squared error: far from the target, steps are short and safe; near the target, they are
#: Newton steps (Sugihara, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method", 2011)
_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 0.2, 1e-3, 1e4
_FLOOR = 1e-9
#: primes; multiples of their square roots fill the unit cube evenly
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)
#: squared error, m^2, below which a target counts as reached
REACHED = 1e-14
_STALLED = 1e-9


class Target(NamedTuple):
    """The target of the tip of a bone.

    Attributes:
        bone: index of the bone.
        pose: position and rotation, in the frame of the armature.
        lever: weight of an error of one radian, m; 0 for any orientation.
        mount: what is brought to the pose, in the frame of the bone; None for its tip.
    """

    bone: int
    pose: Pose
    lever: float = LEVER
    mount: Pose | None = None


class Solution(NamedTuple):
    """Values of the joints.

    Attributes:
        values: values of all joints of the chain.
        error: squared error, m^2; an error of 1 rad counts as the lever of its target.
        is_final: whether further iterations would not improve the values.
    """

    values: list[float]
    error: float
    is_final: bool


def placed(chain: Chain, target: Target, frames: Sequence[Pose]) -> Pose:
    """The pose of what a target is for, given the frames of all bones."""
    frame = frames[target.bone]
    if target.mount is None:
        return chain.tip(frame, target.bone)
    (px, py, pz), rotation = frame
    x, y, z = turn(rotation, target.mount[0])
    return (px + x, py + y, pz + z), product(rotation, target.mount[1])


def improve(chain: Chain, targets: Sequence[Target], values: Sequence[float], iterations: int) -> Solution:
    """Iterate towards the targets.

    Args:
        targets: targets with poses in the frame of the armature; several bones have equal weights.
        values: initial values, within the limits.
        iterations: maximum number of iterations.

    Returns:
        Values that are never farther from the targets than the initial values.
    """
    values = list(values)
    paths = [chain.path(target.bone) for target in targets]
    movable = sorted({number for path in paths for number in path})
    if not movable:
        return Solution(values, 0.0, True)
    frames = chain.frames(values)
    errors = _errors(chain, targets, frames)
    cost, damping = float(matmul(errors, errors)), _DAMPING
    jacobian: NDArray[np.float64] | None = None
    for _ in range(iterations):
        if cost <= REACHED:
            return Solution(values, cost, True)
        if jacobian is None:
            jacobian = _jacobian(chain, targets, paths, movable, frames)
        step = _step(chain, movable, values, jacobian, errors, damping * cost + _FLOOR)
        if float(np.abs(step).max()) < _STALLED:
            return Solution(values, cost, True)
        trial = list(values)
        for number, change in zip(movable, step.tolist(), strict=True):
            trial[number] = chain.clamped(number, values[number] + change)
        frames_there = chain.frames(trial)
        errors_there = _errors(chain, targets, frames_there)
        cost_there = float(matmul(errors_there, errors_there))
        if cost_there < cost:
            values, frames, errors, cost, jacobian = trial, frames_there, errors_there, cost_there, None
            damping = max(0.2 * damping, _LEAST_DAMPING)
        elif damping >= _MOST_DAMPING:
            return Solution(values, cost, True)
        else:
            damping = min(8.0 * damping, _MOST_DAMPING)
    return Solution(values, cost, cost <= REACHED)


def _errors(chain: Chain, targets: Sequence[Target], frames: Sequence[Pose]) -> NDArray[np.float64]:
    """(6 T,) errors: metres, and radians times the weight."""
    errors: list[float] = []
    for target in targets:
        (x, y, z), rotation = placed(chain, target, frames)
        (tx, ty, tz), target_rotation = target.pose
        lever = target.lever
        a, b, c = rotation_vector(rotation, target_rotation)
        # rotation from the axes of the bone to those of the armature
        r = rotation
        errors += (tx - x, ty - y, tz - z)
        errors += (
            lever * (r[0] * a + r[1] * b + r[2] * c),
            lever * (r[3] * a + r[4] * b + r[5] * c),
            lever * (r[6] * a + r[7] * b + r[8] * c),
        )
    return np.array(errors)


def _jacobian(
    chain: Chain,
    targets: Sequence[Target],
    paths: Sequence[Sequence[int]],
    movable: Sequence[int],
    frames: Sequence[Pose],
) -> NDArray[np.float64]:
    """(6 T, N) Jacobian of the poses of the tips."""
    columns = {number: column for column, number in enumerate(movable)}
    result = np.zeros((6 * len(targets), len(movable)))
    for k, (target, path) in enumerate(zip(targets, paths, strict=True)):
        tx, ty, tz = placed(chain, target, frames)[0]
        lever = target.lever
        for number in path:
            index = chain.joints[number]
            bone = chain.bones[index]
            (px, py, pz), r = frames[index]
            a, b, c = r[bone.axis], r[bone.axis + 3], r[bone.axis + 6]
            if bone.kind is JointKind.PRISMATIC:
                change = (a, b, c, 0.0, 0.0, 0.0)
            else:
                x, y, z = tx - px, ty - py, tz - pz
                change = (b * z - c * y, c * x - a * z, a * y - b * x, lever * a, lever * b, lever * c)
            result[6 * k : 6 * k + 6, columns[number]] = change
    return result


def _step(
    chain: Chain,
    movable: Sequence[int],
    values: Sequence[float],
    jacobian: NDArray[np.float64],
    errors: NDArray[np.float64],
    damping: float,
) -> NDArray[np.generic]:
    """(N,) a step of the joints; joints that would exceed their limits are not moved."""
    free = np.ones(len(movable), dtype=bool)
    step: NDArray[np.float64] = np.zeros(len(movable))
    for _ in range(3):
        part = jacobian * free
        step = _damped(part, errors, damping) * free
        leaving = [
            i
            for i, number in enumerate(movable)
            if free[i]
            and (
                (values[number] >= chain.joint(number).high and step[i] > 0.0)
                or (values[number] <= chain.joint(number).low and step[i] < 0.0)
            )
        ]
        if not leaving:
            break
        free[leaving] = False
        step[leaving] = 0.0
    longest = float(np.abs(step).max())
    return step * (_STRIDE / longest) if longest > _STRIDE else step


def _damped(jacobian: NDArray[np.float64], errors: NDArray[np.float64], damping: float) -> NDArray[np.float64]:
    """(N,) the damped least squares step, by the smaller of the two equivalent systems of equations."""
    count, joints = jacobian.shape
    normal = matmul(jacobian, jacobian.T) if count < joints else matmul(jacobian.T, jacobian)
    normal.flat[:: len(normal) + 1] += damping
    if count < joints:
        weights = solve(normal, errors)
        return np.zeros(joints) if weights is None else np.asarray(matmul(jacobian.T, weights))
    step = solve(normal, matmul(jacobian.T, errors))
    return np.zeros(joints) if step is None else step


def kicked(chain: Chain, values: Sequence[float], attempt: int) -> list[float]:
    """Initial values for another attempt if the search is stuck in a local minimum, e.g. if an arm is stretched.

    The first attempt begins near the present values, the others at points that fill the ranges of the revolute joints.

    Args:
        attempt: 0, 1, ...; each attempt has other values.
    """
    values_near = list(values)
    for number, value in enumerate(values):
        joint = chain.joint(number)
        if joint.kind is not JointKind.REVOLUTE:
            continue
        if attempt == 0:
            values_near[number] = chain.clamped(number, value + 0.3 * math.sin(1.0 + 2.4 * number))
        else:
            share = math.modf(attempt * math.sqrt(_PRIMES[number % len(_PRIMES)]))[0]
            values_near[number] = joint.low + share * (joint.high - joint.low)
    return values_near


#: number of searches from other joint values, and of iterations of each
_ATTEMPTS, _ITERATIONS = 24, 60
#: weight of an error of one radian, m
LEVER_OF_REACH = 0.3
#: errors of a solution: m, rad
NEAR, ALIGNED = 1e-5, 1e-4


class Reached(NamedTuple):
    """The nearest joint values.

    Attributes:
        values: of all joints.
        distance: distance from the position of the target, m.
        angle: angle from its orientation, rad; 0 if any orientation will do.
    """

    values: list[float]
    distance: float
    angle: float

    @property
    def is_there(self) -> bool:
        """Whether the target is reached."""
        return self.distance <= NEAR and self.angle <= ALIGNED


def off(chain: Chain, target: Target, values: Sequence[float]) -> tuple[float, float]:
    """The distance (m) and the angle (rad; 0 if any orientation will do) from a target."""
    position, rotation = placed(chain, target, chain.frames(values))
    angle = math.hypot(*rotation_vector(rotation, target.pose[1])) if target.lever else 0.0
    return math.dist(position, target.pose[0]), angle


def reach(chain: Chain, target: Target, values: Sequence[float]) -> Reached:
    """Search the joint values for a target, near the present ones first, then all over the ranges of the joints."""
    best = improve(chain, [target], values, _ITERATIONS)
    for attempt in range(_ATTEMPTS):
        if Reached(best.values, *off(chain, target, best.values)).is_there:
            break
        trial = improve(chain, [target], kicked(chain, best.values, attempt), _ITERATIONS)
        if trial.error < best.error:
            best = trial
    return Reached(best.values, *off(chain, target, best.values))
