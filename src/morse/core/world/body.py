"""The bodies and the wheels of the world, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeAlias, TypeVar, overload

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.values import Properties, Value
    from morse.mathutils import Matrix, Quaternion, Vector
    from morse.scene import Control, Node


class BodyNames(Protocol):
    """Pose, velocity and forces under the names of MORSE 1.4.

    "World" values are in the axes of the world, "local" ones in the axes of the parent (poses) or of the body itself
    (velocities and forces). Vectors and matrices can be assigned in any form that `morse.mathutils` converts.
    """

    @property
    def worldPosition(self) -> Vector:  # noqa: N802
        """Position in the world, m."""

    @worldPosition.setter
    def worldPosition(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    @property
    def worldOrientation(self) -> Matrix:  # noqa: N802
        """3x3 rotation from its axes to those of the world."""

    @worldOrientation.setter
    def worldOrientation(self, value: Sequence[Sequence[float]] | Sequence[float] | Quaternion) -> None:  # noqa: N802
        ...

    @property
    def localPosition(self) -> Vector:  # noqa: N802
        """Position in the frame of its parent, m."""

    @localPosition.setter
    def localPosition(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    @property
    def localOrientation(self) -> Matrix:  # noqa: N802
        """3x3 rotation from its axes to those of its parent."""

    @localOrientation.setter
    def localOrientation(self, value: Sequence[Sequence[float]]) -> None:  # noqa: N802
        ...

    @property
    def worldTransform(self) -> Matrix:  # noqa: N802
        """4x4 pose in the world."""

    @worldTransform.setter
    def worldTransform(self, value: Sequence[Sequence[float]]) -> None:  # noqa: N802
        ...

    @property
    def worldLinearVelocity(self) -> Vector:  # noqa: N802
        """Velocity of its origin in world axes, m/s."""

    @worldLinearVelocity.setter
    def worldLinearVelocity(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    @property
    def worldAngularVelocity(self) -> Vector:  # noqa: N802
        """Angular velocity in world axes, rad/s."""

    @worldAngularVelocity.setter
    def worldAngularVelocity(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    @property
    def localLinearVelocity(self) -> Vector:  # noqa: N802
        """Velocity of its origin in its own axes, m/s."""

    @localLinearVelocity.setter
    def localLinearVelocity(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    @property
    def localAngularVelocity(self) -> Vector:  # noqa: N802
        """Angular velocity in its own axes, rad/s."""

    @localAngularVelocity.setter
    def localAngularVelocity(self, value: Sequence[float]) -> None:  # noqa: N802
        ...

    def getLinearVelocity(self, local: bool = False) -> Vector:  # noqa: N802
        """Velocity of its origin, m/s."""

    def setLinearVelocity(self, velocity: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Set the velocity of its origin, m/s."""

    def getAngularVelocity(self, local: bool = False) -> Vector:  # noqa: N802
        """Angular velocity, rad/s."""

    def setAngularVelocity(self, velocity: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Set the angular velocity, rad/s."""

    @property
    def twist_place(self) -> int | None:
        """Number of the first of its six speeds in the engine; None unless it moves freely.

        These are the velocity of its origin in the axes of the world, and the rates of turn in its own axes.
        """

    def applyForce(self, force: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Apply a force at the centre of mass during the next tick, N."""

    def applyTorque(self, torque: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Apply a torque during the next tick, N m."""

    def applyMovement(self, movement: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Move the object immediately, m."""

    def applyRotation(self, rotation: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Rotate the object immediately, rad about each axis."""


_D = TypeVar("_D")

Pose: TypeAlias = tuple["Sequence[float]", "Sequence[float]"]
"""Position (3), m, and rotation (9, row by row)."""


class Mounting(Protocol):
    """The pose of an object in its rigid group."""

    @property
    def offset(self) -> Sequence[float]:
        """Position (3), m."""

    @property
    def turned(self) -> Sequence[float]:
        """Rotation, 9 numbers row by row."""

    @property
    def is_apart(self) -> bool:
        """Whether the pose differs from the pose of the group."""


class Bodies(Protocol):
    """Bodies, by number or by name."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[Body]: ...

    def __contains__(self, item: object) -> bool: ...

    @overload
    def __getitem__(self, key: int | str) -> Body: ...

    @overload
    def __getitem__(self, key: slice) -> Sequence[Body]: ...

    def get(self, name: str, default: _D | None = None) -> Body | _D | None:
        """Return the body of that name, or ``default``."""


class ContactMoment(Protocol):
    """The contacts of bodies at one moment."""

    def forces(self, obj: Body) -> Sequence[tuple[Body, Sequence[float]]]:
        """See `Body.contact_forces`."""


class JointMoment(Protocol):
    """What loads the joints that carry bodies, at one moment."""

    def is_carried(self, obj: Body) -> bool:
        """Whether a joint carries a body, be it fixed."""

    def load(self, obj: Body, origin: Sequence[float]) -> tuple[Sequence[float], Sequence[float]]:
        """Return force (N) and torque (N m) as `Body.joint_load` does, about a point of the world, m."""


class Body(BodyNames, Protocol):
    """An object of the running world: its pose, velocity, properties and children.

    Positions are metres, rotations are 3x3 matrices, velocities m/s and rad/s. It is ``bge_object`` of components: the
    name is that of MORSE 1.4, as are the names in `BodyNames`.

    Attributes:
        node: the node of the scene for this object.
        slot: index of the rigid group of the object.
        visible: whether cameras and the live view show the object.
        properties: the properties of the object, by name.
    """

    node: Node
    slot: int
    visible: bool
    properties: Properties

    @property
    def offset(self) -> Pose:
        """Position and rotation in the rigid group of the object."""

    @property
    def mounting(self) -> Mounting:
        """The pose of the object in its rigid group."""

    @property
    def name(self) -> str:
        """The name in the scene."""

    @property
    def is_dynamic(self) -> bool:
        """Whether the object is a dynamic body, or a link that a joint moves."""

    @property
    def mass(self) -> float:
        """Mass, kg; 0 for an object that is not dynamic."""

    @property
    def localInertia(self) -> Vector:  # noqa: N802
        """Principal moments of inertia, kg m^2."""

    @property
    def parent(self) -> Body | None:
        """The object to which this object is attached, in the scene or later by `setParent`."""

    @property
    def children(self) -> Bodies:
        """The objects that are attached to this object."""

    @property
    def childrenRecursive(self) -> Bodies:  # noqa: N802
        """All objects below this object in the tree."""

    def setParent(self, parent: Body, compound: bool = True, ghost: bool = True) -> None:  # noqa: N802
        """Attach this object to another object at its present relative pose."""

    def removeParent(self) -> None:  # noqa: N802
        """Undo `setParent`."""

    def __getitem__(self, name: str) -> Value:
        """Return a property."""

    def __setitem__(self, name: str, value: object) -> None:
        """Set a property."""

    def __contains__(self, name: object) -> bool:
        """Whether a property exists."""

    def get(self, name: str, default: object = None) -> Value:
        """Return a property, or ``default``."""

    def getPropertyNames(self) -> list[str]:  # noqa: N802
        """Return the names of the properties."""

    def pose_of(self, row: int, /) -> Pose:
        """Return `world_pose`, for a pose that follows this object."""

    def world_pose(self) -> Pose:
        """Return the position (3) and rotation (9, row-major) in the world, as plain floats."""

    @property
    def stamp(self) -> int:
        """A value that changes whenever an object has moved."""

    def local_pose(self) -> Pose:
        """Position (3) and rotation (9) in the frame of the parent."""

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose of the object in the world, with all attached objects; its velocity is unchanged.

        Raises:
            ValueError: a value is not finite or exceeds `morse.physics.poses.convert.POSITION`.
        """

    def set_local_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose of the object in the frame of its parent; see `set_pose`."""

    def velocity(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return the linear and angular velocity of its origin, in world axes."""

    def set_velocity(self, linear: Sequence[float] | None, angular: Sequence[float] | None) -> None:
        """Set the velocity of its body in world axes; None keeps the present velocity."""

    def drive(
        self, linear: Sequence[float], angular: Sequence[float], *, position: bool = False, ground: bool = False
    ) -> None:
        """Move with a velocity in the axes of the object during the next tick.

        Args:
            position: whether the object moves without gaining momentum.
            ground: whether gravity and contacts control the vertical speed and the roll and pitch rates.
        """

    def halt(self) -> None:
        """Set the velocity to 0."""

    def wrench(self, force: Sequence[float], torque: Sequence[float], local: bool) -> None:
        """Apply a force (N) and a torque (N m) at the centre of mass during the next tick."""

    def set_added_mass(self, mass: Sequence[float], inertia: Sequence[float]) -> None:
        """Set the mass of the fluid that moves along with a free body, until the next call.

        Args:
            mass: along each axis of the body, kg.
            inertia: about each axis of the body, kg m^2.
        """

    def pull(
        self, anchor: Sequence[float], target: Sequence[float], stiffness: float, damping: float, strongest: float
    ) -> None:
        """Pull a point of the body towards a target during the next tick, like a damped spring.

        Args:
            anchor: the point, in the frame of the object, m.
            target: the target in the world, m.
            stiffness: spring constant divided by the mass, 1/s^2.
            damping: damping constant divided by the mass, 1/s.
            strongest: largest acceleration, m/s^2.
        """

    def contact_forces(self) -> Sequence[tuple[Body, Sequence[float]]]:
        """Return what presses on this object and the objects below it: other objects, and forces (N, world axes)."""

    def joint_load(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return force (N) and torque (N m, about the origin of the object) in the joint that carries the object.

        They are those that the object exerts on what carries it, in world axes; 0 if it does not move.
        """

    def suspendDynamics(self, ghost: bool = False) -> None:  # noqa: N802
        """Keep the object at its pose, independent of the forces on it."""

    def restoreDynamics(self) -> None:  # noqa: N802
        """Resume the physics of the object."""

    @property
    def isSuspendDynamics(self) -> bool:  # noqa: N802
        """Whether the physics of the object is suspended."""

    def disable_gravity(self) -> None:
        """Disable gravity for the object."""

    def wheels(self) -> Sequence[Wheel]:
        """The driven wheels of a wheeled robot."""

    def joints(self) -> Joints | None:
        """The joints of an armature, or None if the physics does not move them."""

    def getDistanceTo(self, other: Body | Sequence[float]) -> float:  # noqa: N802
        """Return the distance between origins, m."""

    def getVectTo(self, other: Body | Sequence[float]) -> tuple[float, Vector, Vector]:  # noqa: N802
        """Return the distance (m) and the unit vector to an object or point, in world axes and in object axes."""

    def rayCast(  # noqa: N802
        self,
        objto: Body | Sequence[float],
        objfrom: Body | Sequence[float] | None = None,
        dist: float = 0.0,
        prop: str = "",
        face: int = 0,
        xray: int = 0,
        poly: int = 0,
    ) -> tuple[Body | None, Vector | None, Vector | None]:
        """Return the first object on the line to a point: object, hit point and normal, or three None.

        Args:
            dist: length of the ray, m, which may be beyond the target; 0 for up to the target.
            prop: if given, only objects with this property are hit.
            xray: whether the ray passes through objects without the property.
        """

    def rayCastTo(self, other: Body | Sequence[float], dist: float = 0.0, prop: str = "") -> Body | None:  # noqa: N802
        """Return the first object on the line to a point, or None."""

    def setVisible(self, visible: bool, recursive: bool = False) -> None:  # noqa: N802
        """Show or hide the object."""


class Wheel(Protocol):
    """A driven wheel of a robot.

    Attributes:
        radius: m.
        offset_y: distance to the left of the centre of the robot, m.
    """

    @property
    def object(self) -> Body:
        """The body of the wheel."""

    radius: float
    offset_y: float

    def set_speed(self, speed: float) -> None:
        """Set the speed of the motor, rad/s; positive drives forward. Larger values are limited to the maximum speed.

        Raises:
            ValueError: the value is not a number.
        """

    @property
    def angle(self) -> float:
        """Angle since the start, rad."""

    @property
    def speed(self) -> float:
        """Angular speed, rad/s."""


class FileMotor(Protocol):
    """An actuator of a model file that is not a motor of a single joint: of a tendon, a muscle.

    Attributes:
        name: its name.
        commands: smallest and largest command.
        start: initial command.
        actuator: its number among the commands of the world.
    """

    name: str
    commands: tuple[float, float]
    start: float
    actuator: int


class Joints(Protocol):
    """The joints of an armature: m, m/s and N, or rad, rad/s and N m."""

    def tell(self, names: Sequence[str], values: Sequence[float]) -> None:
        """Set the commands of motors: positions, velocities or efforts, see `morse.scene.Control`."""

    def set_control(self, name: str, control: Control, command: float) -> None:
        """Change the control mode of a motor, and its command."""

    def gains(self, names: Sequence[str]) -> Sequence[tuple[float, float]]:
        """Return stiffness and damping of motors."""

    def set_gains(self, name: str, stiffness: float | None, damping: float | None) -> None:
        """Set stiffness and damping of a motor; None to keep them."""

    @property
    def file_motors(self) -> Sequence[FileMotor]:
        """The actuators of the file of the armature that are not motors of single joints."""

    def measured(self, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the positions, velocities and efforts of J joints, (J,) each, which nobody changes afterwards."""

    def pull(self, commands: Mapping[str, float]) -> None:
        """Set the commands of actuators of the file: name to command."""

    def tendons(self) -> dict[str, tuple[float, float, float]]:
        """Return the actuators of the file: name to length (m), speed (m/s) and force (N)."""

    def loose(self, name: str) -> tuple[list[float], list[float]]:
        """Return the position and the velocity of a bone without a joint value, as stored in the engine.

        Returns:
            Displacements (m) along the axes of the bone, then an angle (rad) or a quaternion w, x, y, z; and their
            velocities, m/s and rad/s. Both are empty if no object is attached to the bone.
        """

    def positions(self, names: Sequence[str]) -> list[float]:
        """Return the measured positions."""

    def velocities(self, names: Sequence[str]) -> list[float]:
        """Return the measured velocities."""

    def efforts(self, names: Sequence[str]) -> list[float]:
        """Return the efforts that the motors exert."""

    def places(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of joints among the positions of the world; -1 for a joint that nothing hangs on."""

    def channels(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of the motors of joints among the commands of the world; -1 for a joint without motor."""
