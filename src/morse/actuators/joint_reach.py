"""Services that bring a link of an arm to a pose."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from morse.actuators.joint_paths import GOAL_VIOLATED, JointPaths
from morse.core import status
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import EulerAngles, Point
from morse.core.reports.quoting import nearest, shown
from morse.core.services import async_service, interruptible, service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_state
from morse.helpers.inverse_kinematics import LEVER, Target, improve, kicked, off, reach
from morse.helpers.joint_trajectory import Plan, Tolerances, Trajectory
from morse.helpers.joint_trajectory import Point as PathPoint
from morse.mathutils import Euler
from morse.mathutils.rotations import (
    nine,
    product,
    quaternion_from_rotation,
    rotation_from_quaternion,
    rotation_of,
    turn,
    turn_back,
)
from morse.scene import JointKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.helpers.chain import Chain, Pose


_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
#: distance (m) and angle (rad) at which a motion ends, half of those that are promised, because the arm comes to rest
#: there; and the time within which the motors remove the sag, s
_NEAR, _ALIGNED, _PATIENCE = 5e-4, 2.5e-3, 3.0
#: share of the remaining error that each tick adds to the setpoints, and the largest correction, rad or m
_SHARE, _MOST = 0.2, 0.2
#: peak speed of a polynomial of degree 3 from rest to rest, as a multiple of its mean speed
_PEAK = 1.5

_Speed = Annotated[float, Range(1e-3, 1e4)]
_Frame = Literal["world", "robot"]


class JointReach(JointPaths):
    """Moves links to poses by inverse kinematics, and holds them there against gravity."""

    add_state("_target", tuple | None, "Pose that a link is brought to")
    add_state("_corrections", dict, "What is added to the setpoints so that the motors do not sag")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        self._mounts: dict[str, tuple[int, Pose]] = {}
        super().__init__(obj, parent)
        self._target: Target | None = None
        self._corrections: dict[str, float] = {}
        for child, index, position, rotation in self._hanging(obj):
            x, y, z = position
            self._mounts[child.node.plain_name] = index, ((x, y, z), rotation_of(rotation))

    @service(changes=False)
    def get_links(self) -> list[str]:
        """Return the names of the links, which `reach` can bring to a pose."""
        return list(self._mounts)

    @service(changes=False)
    def inverse_kinematics(
        self, link: str, position: Point, orientation: EulerAngles | None = None, point: Point | None = None,
        frame: _Frame = "world",
    ) -> dict[str, float]:  # fmt: skip
        """Return the values of the joints between the base and a link that bring it to a pose: name to rad or m.

        Raises an error with the smallest distance if the arm cannot reach the pose. The arguments are those of `reach`.
        """
        target = self._target_of(link, position, orientation, point, frame)
        solution = self._solution(link, target)
        return {self.joints[number]: solution[number] for number in self.chain.path(target.bone)}

    @interruptible
    @async_service
    def reach(
        self, link: str, position: Point, orientation: EulerAngles | None = None, speed: _Speed | None = None,
        point: Point | None = None, frame: _Frame = "world",
    ) -> None:  # fmt: skip
        """Bring a link to a pose within 1 mm and 5 mrad, and hold it there.

        All joints move at the same time, from rest to rest; then the motors remove what the weight of the arm still
        lets them sag. The service fails at once, and nothing moves, if the arm cannot reach the pose; it fails later if
        something keeps the arm from it for 3 s.

        Args:
            link: name of the link, see ``get_links``.
            position: x, y, z of the origin of the link, or of ``point``, m.
            orientation: roll, pitch and yaw of the link, rad; None for any.
            speed: largest speed of a joint, rad/s or m/s; None for RotationSpeed and LinearSpeed.
            point: a point in the frame of the link, such as the centre of the fingers, m; None for its origin.
            frame: axes and origin of the pose: ``world`` or ``robot``.
        """
        target = self._target_of(link, position, orientation, point, frame)
        solution = self._solution(link, target)
        # other joints, such as those of fingers, keep their setpoints
        path = self.chain.path(target.bone)
        names = [self.joints[number] for number in path]
        self._take_over(names)
        start, goal = [self._values[number] for number in path], [solution[number] for number in path]
        times = [
            _PEAK * abs(after - before) / self._speed(number, speed)
            for number, before, after in zip(path, start, goal, strict=True)
        ]
        end = PathPoint(max(1e-3, *times), tuple(goal), (0.0,) * len(path))
        plan = Plan(tuple(names), [end], None, Tolerances({}, {}, _PATIENCE))
        self._trajectory = Trajectory(plan, self.clock.time, start)
        self._target, self._corrections = target, dict.fromkeys(names, 0.0)

    def _speed(self, number: int, speed: float | None) -> float:
        joint = self.chain.joint(number)
        common = self._rotation_speed if joint.kind is JointKind.REVOLUTE else self._linear_speed
        most = joint.dynamics.speed if joint.dynamics is not None and joint.dynamics.speed > 0.0 else math.inf
        return max(min(common if speed is None else speed, most), 1e-3)

    def _target_of(
        self,
        link: str,
        position: Sequence[float],
        orientation: Sequence[float] | None,
        point: Sequence[float] | None,
        frame: str,
    ) -> Target:
        """The target in the frame of the armature."""
        if link not in self._mounts:
            raise MorseRPCInvokationError(f"{self.name()}: there is no link {shown(link)}{nearest(link, self._mounts)}")
        bone, (place, rotation) = self._mounts[link]
        self._demand_positions([self.joints[number] for number in self.chain.path(bone)])
        if point is not None:
            dx, dy, dz = turn(rotation, point)
            place = (place[0] + dx, place[1] + dy, place[2] + dz)
        x, y, z = map(float, position)
        axes = _IDENTITY if orientation is None else nine(list(Euler(orientation).to_matrix()))
        if frame == "robot":
            (rx, ry, rz), r = self.robot_parent.bge_object.world_pose()
            dx, dy, dz = turn(r, (x, y, z))
            x, y, z, axes = rx + dx, ry + dy, rz + dz, product(tuple(r), axes)
        (ox, oy, oz), r = self.bge_object.world_pose()
        back = (r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8])
        pose = turn_back(r, (x - ox, y - oy, z - oz)), product(back, axes)
        return Target(bone, pose, 0.0 if orientation is None else LEVER, (place, rotation))

    def _solution(self, link: str, target: Target) -> list[float]:
        values = [self.chain.clamped(number, value) for number, value in enumerate(self.joint_values)]
        nearby = reach(self.chain, target, values)
        if not nearby.is_there:
            rotation_text = f" and turned by {nearby.angle:.3g} rad" if nearby.angle else ""
            raise MorseRPCInvokationError(
                f"{self.name()}: '{link}' cannot reach that pose: the nearest one is {nearby.distance:.3g} m away"
                f"{rotation_text}"
            )
        return nearby.values

    # -- motion ----------------------------------------------------------------------------

    def _hold(self, trajectory: Trajectory) -> None:
        super()._hold(trajectory)
        self._target = None

    def _arrive(self, trajectory: Trajectory, *, is_late: bool) -> None:
        """Remove the sag of the motors at the end of a motion to a pose."""
        if self._target is None:
            super()._arrive(trajectory, is_late=is_late)
            return
        values = self.joint_values
        distance, angle = off(self.chain, self._target, values)
        is_there = distance <= _NEAR and angle <= _ALIGNED
        for name, goal in zip(trajectory.joints, trajectory.points[-1].positions, strict=True):
            here = values[self.joints.index(name)]
            correction = self._corrections[name] + _SHARE * (goal - here)
            self._corrections[name] = min(max(correction, -_MOST), _MOST)
            self.local_data[name] = goal + self._corrections[name]
        if not is_there and not is_late:
            return
        self._trajectory = self._target = None
        if is_there:
            self._end(status.SUCCESS)
        else:
            rotation_text = f" and turned by {angle:.3g} rad" if angle else ""
            text = f"{GOAL_VIOLATED}: the link is {distance:.3g} m away{rotation_text}: something holds it back"
            self._end(status.FAILED, text)


#: prefix of the name of a target, followed by the names of the component and the bone
PREFIX = "ik_target"
#: property of a target with the name of its bone
BONE = "IK_Bone"
#: number of iterations per tick
_ITERATIONS = 4
#: number of restarts from other joint values, and the ticks for each
_ATTEMPTS, _MOST_TICKS = 12, 12
#: squared error above which the search is restarted, m^2
_FAR = 1e-6

_Pose = tuple["Sequence[float]", "Sequence[float]"]


class Follower:
    """Moves the tips of bones to their targets, with a few iterations in each tick.

    If the search is stuck in a local minimum, for example if the arm is stretched and the target is closer to its base,
    it is restarted from other joint values. The joints only move to solutions that are closer to the targets.
    """

    def __init__(self) -> None:
        self._goal: tuple[object, ...] = ()
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
        if trial.is_final or self._ticks >= _MOST_TICKS:
            self._trial = None
        return best.values


def targets_of(obj: Body) -> dict[str, Body]:
    """The targets of an armature by name."""
    return {child.name: child for child in obj.children if BONE in child.properties}


def seen_from(chain: Chain, targets: Iterable[Body], lever: float) -> list[Target]:
    """Return the targets of existing bones, in the frame of the armature.

    Args:
        lever: weight of an error of one radian, m.
    """
    poses = []
    for target in targets:
        index = chain.index(str(target.properties[BONE]))
        if index is not None:
            (x, y, z), r = target.local_pose()
            poses.append(Target(index, ((x, y, z), rotation_of(r)), lever))
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
    turn_left = product((a, d, g, b, e, h, c, f, i), tuple(goal[1]))
    w, x, y, z = quaternion_from_rotation(turn_left)
    sine = math.sqrt(x * x + y * y + z * z)
    angle = 2.0 * math.atan2(sine, w)
    there, is_aligned = distance <= way, angle <= step_angle
    position = tuple(goal[0]) if there else tuple(p + way / distance * m for p, m in zip(here[0], offset, strict=True))
    rotation = tuple(goal[1])
    if not is_aligned:
        half, unit = 0.5 * step_angle, math.sin(0.5 * step_angle) / sine
        step = rotation_from_quaternion(math.cos(half), unit * x, unit * y, unit * z)
        rotation = product(tuple(here[1]), step)
    return (position, rotation), there and is_aligned
