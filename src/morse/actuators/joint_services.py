"""Services that move joints by name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.calls import of_joints
from morse.core.declarations import DataField
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import Angle, Position
from morse.core.reports.quoting import nearest, shown
from morse.core.robot_parts import link_parts
from morse.core.services import async_service, interruptible, service
from morse.core.validation.arguments import Range, check_of
from morse.helpers.chain import Chain
from morse.helpers.components import add_property, add_state
from morse.mathutils.rotations import product, turn_back
from morse.scene import JointKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from morse.core.robot import Robot
    from morse.core.robot_parts import MovingPart
    from morse.core.world import Body, Hanging
    from morse.scene import Bone


class JointMotion(Actuator):
    """Moves the joints of its armature, and the objects that are attached to the bones.

    ``local_data`` contains the setpoint of each joint. Joints stay within their limits.
    """

    add_state("_values", list, "Joint values of the last action")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        node = obj.node
        if not node.bones:
            raise ValueError(
                f"'{node.plain_name}' has no bones: an armature is an object of the type Armature in Blender whose "
                "bones have unlocked axes (Bone > Inverse Kinematics)"
            )
        stretch = rigid_frame(node).stretch
        self.chain = Chain(node.bones, sum(float(stretch[i][i]) for i in range(3)) / 3.0)
        self._values = list(self.chain.start)
        self.local_data.update(zip(self.chain.names, self._values, strict=True))
        #: the last setpoints, and the clamped setpoints
        self._told: list[object] = []
        self._limits = [(low, high) for _, low, high in self.chain.limits]
        self._told_bounds: Sequence[tuple[float, float]] = self._limits
        self._clamped: list[float] = []
        self._linkage = self.context.world.linkage(obj, self.chain.linked, list(self._hanging(obj)))

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Return one field for each joint."""
        fields = {}
        for index in self.chain.joints:
            bone = self.chain.bones[index]
            turns = bone.kind is JointKind.REVOLUTE
            fields[bone.name] = DataField(
                bone.value,
                "float",
                f"{'Angle' if turns else 'Displacement'} to move to, from {bone.low:g} to {bone.high:g}",
                unit="rad" if turns else "m",
                frame="joint",
                low=-1e6,
                high=1e6,
            )
        return fields

    @property
    def joints(self) -> tuple[str, ...]:
        """The names of the joints, from the root to the tips."""
        return self.chain.names

    @property
    def joint_values(self) -> tuple[float, ...]:
        """The present joint values, rad or m."""
        return tuple(self._values)

    def moving_parts(self) -> list[MovingPart]:
        """The links of the armature, with the names of its file."""
        return link_parts(self.bge_object, self.chain, lambda: self.joint_values, self.context.components)

    def _hanging(self, obj: Body) -> Iterator[Hanging]:
        """The objects attached to bones: object, index of the bone, and its pose in the frame of the bone."""
        frames = self.chain.frames(self.chain.start)
        for child in obj.children:
            index = self.chain.index(child.node.bone) if child.node.bone else None
            if index is not None:
                (x, y, z), rotation = child.local_pose()
                (px, py, pz), r = frames[index]
                back = (r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8])
                yield child, index, turn_back(r, (x - px, y - py, z - pz)), product(back, tuple(rotation))

    def _wanted(self) -> list[float]:
        """Return the setpoints, clamped to the limits; the list must not be modified."""
        data = self.local_data
        targets = [data[name] for name in self.chain.names]
        bounds = self._bounds()
        if targets != self._told or bounds is not self._told_bounds:
            # most setpoints do not change for many ticks
            self._told, self._told_bounds = targets, bounds
            self._clamped = [
                low if value < low else high if value > high else value
                for value, (low, high) in zip(map(float, targets), bounds, strict=True)
            ]
        return self._clamped

    def _bounds(self) -> Sequence[tuple[float, float]]:
        """Return the limits of the setpoints; the same object as long as they are the same."""
        return self._limits

    def _move_to(self, values: Sequence[float]) -> None:
        """Set the joint values immediately, and move the attached objects."""
        if list(values) == self._values:
            return
        self._values = list(values)
        self._linkage.move(self.chain.bone_values(self._values))


_Speed = Annotated[float, Range(0.0, 1e4)]
_REVOLUTE, _PRISMATIC = JointKind.REVOLUTE, JointKind.PRISMATIC
_MOTIONS = {_REVOLUTE: "rotation", _PRISMATIC: "translation"}
_CHECKS = {_REVOLUTE: check_of(Angle), _PRISMATIC: check_of(Position)}


class JointServices(JointMotion):
    """Services that set single joints, immediately or at limited speed."""

    add_property(
        "_distance_tolerance",
        0.005,
        "DistanceTolerance",
        "float",
        "A service ends when a prismatic joint is this close to its setpoint",
        unit="m",
        low=0.0,
    )
    add_property(
        "_angle_tolerance",
        0.01,
        "AngleTolerance",
        "float",
        "A service ends when a revolute joint is this close to its setpoint",
        unit="rad",
        low=0.0,
    )
    add_property(
        "_rotation_speed", 0.8, "RotationSpeed", "float", "Speed of revolute joints", unit="rad/s", low=0.0, high=1e4
    )
    add_property(
        "_linear_speed", 0.05, "LinearSpeed", "float", "Speed of prismatic joints", unit="m/s", low=0.0, high=1e4
    )

    add_state("_awaited", list | None, "Joints that the running service waits for")
    add_state("_speeds", dict, "Speeds from the arguments of services")

    _distance_tolerance: float
    _angle_tolerance: float
    _rotation_speed: float
    _linear_speed: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        #: speeds from the arguments of services
        self._speeds: dict[str, float] = {}
        #: speeds and frequency, and the step per tick computed from them
        self._usual: tuple[tuple[float, ...], list[float]] = (), []
        #: the last steps, and whether one of them is a limit
        self._known_steps: list[float] = []
        self._has_steps = True
        #: the joints that a running service waits for; None if no service waits
        self._awaited: list[str] | None = None

    def default_action(self) -> None:
        """Move towards the setpoints."""
        targets = self._wanted()
        if targets != self._values:
            steps = self._steps()
            if steps is not self._known_steps:
                self._known_steps, self._has_steps = steps, any(step < math.inf for step in steps)
            if self._has_steps:
                self._move_to(
                    [
                        value if -step <= value - here <= step else here + (step if value > here else -step)
                        for value, here, step in zip(targets, self._values, steps, strict=True)
                    ]
                )
            else:
                self._move_to(targets)
        if self._awaited is not None:
            self._end_if_there(self._awaited, targets)

    def _steps(self) -> list[float]:
        """Return the largest step of each joint in this tick."""
        given = (self._rotation_speed, self._linear_speed, self.frequency)
        if self._speeds or given != self._usual[0]:
            turn, slide, rate = given
            speeds = {_REVOLUTE: turn, _PRISMATIC: slide}
            joints = map(self.chain.joint, range(len(self.joints)))
            steps = [self._speeds.get(joint.name, speeds[joint.kind]) / rate for joint in joints]
            if self._speeds:
                return steps
            self._usual = given, steps
        return self._usual[1]

    def _end_if_there(self, names: list[str], targets: list[float]) -> None:
        for number, value in enumerate(targets):
            joint = self.chain.joint(number)
            near = self._angle_tolerance if joint.kind is _REVOLUTE else self._distance_tolerance
            if joint.name in names and abs(value - self._values[number]) > near:
                return
        self._awaited, self._speeds = None, {}
        if self.on_completion is not None:
            self.completed(status.SUCCESS)

    def interrupt(self) -> None:
        """Stop at the present joint values."""
        self._stop()
        super().interrupt()

    def progress(self) -> dict[str, object]:
        """Return the values of the joints and their setpoints."""
        return of_joints(self.joints, self._values, self._wanted())

    def _stop(self) -> None:
        """Cancel the motion that a service started."""
        for name in self._awaited or ():
            self.local_data[name] = self._values[self.joints.index(name)]
        self._awaited, self._speeds = None, {}

    def _take_over(self, names: list[str]) -> None:
        """Called when joints get setpoints, which ends other motions."""
        if self.on_completion is not None and set(self._awaited or ()) & set(names):
            self.interrupt()

    # -- queries ---------------------------------------------------------------------------

    @service(changes=False)
    def get_joints(self) -> list[str]:
        """Return the names of the joints, from the root to the tips."""
        return list(self.joints)

    @service(changes=False)
    def get_dofs(self) -> dict[str, list[int]]:
        """Return the rotation axes of each joint: the name of the joint, and three numbers, 1 or 0, for X, Y and Z of
        the bone.
        """
        return {name: [int(free) for free in self._joint(name)[1].free] for name in self.joints}

    @service(changes=False)
    def get_IK_limits(self, joint: str) -> list[float]:  # noqa: N802 (its name in MORSE 1.4)
        """Return the smallest and the largest value of a joint, rad or m."""
        bone = self._joint(joint)[1]
        return [bone.low, bone.high]

    # -- services --------------------------------------------------------------------------

    @service
    def set_rotation(self, joint: str, rotation: Angle) -> None:
        """Rotate a joint immediately.

        Args:
            joint: name of a revolute joint.
            rotation: radians.
        """
        self._put({joint: rotation}, _REVOLUTE)

    @service
    def set_rotations(self, rotations: list[float]) -> None:
        """Rotate the first joints immediately; if one of them is prismatic, none is moved.

        Args:
            rotations: radians, from the root to the tips; surplus values are ignored.
        """
        self._put(self._first(rotations), _REVOLUTE)

    @service
    def set_translation(self, joint: str, translation: Position) -> None:
        """Translate a joint immediately.

        Args:
            joint: name of a prismatic joint.
            translation: metres.
        """
        self._put({joint: translation}, _PRISMATIC)

    @service
    def set_translations(self, translations: list[float]) -> None:
        """Translate the first joints immediately; if one of them is revolute, none is moved.

        Args:
            translations: metres, from the root to the tips; surplus values are ignored.
        """
        self._put(self._first(translations), _PRISMATIC)

    @interruptible
    @async_service
    def rotate(self, joint: str, rotation: Angle, speed: _Speed | None = None) -> None:
        """Rotate a joint at limited speed; the service ends when the joint has arrived.

        Args:
            joint: name of a revolute joint.
            rotation: radians.
            speed: rad/s; None for RotationSpeed.
        """
        self._go({joint: rotation}, _REVOLUTE, speed)

    @interruptible
    @async_service
    def rotate_joints(self, joint_rotations: dict[str, float], speed: _Speed | None = None) -> None:
        """Rotate several joints at limited speed; the service ends when all have arrived.

        Args:
            joint_rotations: name to radians.
            speed: speed of each joint, rad/s; None for RotationSpeed.
        """
        self._go(joint_rotations, _REVOLUTE, speed)

    @interruptible
    @async_service
    def translate(self, joint: str, translation: Position, speed: _Speed | None = None) -> None:
        """Translate a joint at limited speed; the service ends when the joint has arrived.

        Args:
            joint: name of a prismatic joint.
            translation: metres.
            speed: m/s; None for LinearSpeed.
        """
        self._go({joint: translation}, _PRISMATIC, speed)

    @interruptible
    @async_service
    def translate_joints(self, joint_translations: dict[str, float], speed: _Speed | None = None) -> None:
        """Translate several joints at limited speed; the service ends when all have arrived.

        Args:
            joint_translations: name to metres.
            speed: speed of each joint, m/s; None for LinearSpeed.
        """
        self._go(joint_translations, _PRISMATIC, speed)

    def _joint(self, name: str) -> tuple[int, Bone]:
        """Return the index and the bone of a joint."""
        if name not in self.joints:
            raise MorseRPCInvokationError(f"{self.name()}: there is no joint {shown(name)}{nearest(name, self.joints)}")
        number = self.joints.index(name)
        return number, self.chain.joint(number)

    def _first(self, values: list[float]) -> dict[str, float]:
        return dict(zip(self.joints, values, strict=False))

    def _checked(self, values: dict[str, float], kind: JointKind) -> dict[str, float]:
        """Validate values for joints of one kind."""
        numbers = {}
        for name, value in values.items():
            joint = self._joint(name)[1]
            if joint.kind is not kind:
                raise MorseRPCInvokationError(
                    f"{self.name()}: '{name}' is a {joint.kind} joint and has no {_MOTIONS[kind]}: call "
                    f"the service for a {_MOTIONS[joint.kind]}"
                )
            try:
                numbers[name] = float(_CHECKS[kind](value))
            except ValueError as error:
                raise MorseRPCInvokationError(
                    f"{self.name()}: the {_MOTIONS[kind]} of '{name}' is {error}, not {shown(value)}"
                ) from None
        return numbers

    def _put(self, values: dict[str, float], kind: JointKind) -> None:
        numbers = self._checked(values, kind)
        self._take_over(list(numbers))
        self.local_data.update(numbers)
        targets = list(self._values)
        for name, value in numbers.items():
            number = self.joints.index(name)
            targets[number] = self.chain.clamped(number, value)
        self._move_to(targets)

    def _go(self, values: dict[str, float], kind: JointKind, speed: float | None) -> None:
        numbers = self._checked(values, kind)
        self._take_over(list(numbers))
        self.local_data.update(numbers)
        self._awaited = list(numbers)
        self._speeds = {} if speed is None else dict.fromkeys(numbers, speed)
