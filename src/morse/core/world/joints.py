"""Joints and wheels that the physics moves, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.world.body import Body
    from morse.scene import Control
    from morse.scene.couplings import TendonMotor


class TendonSlot(Protocol):
    """A motor that pulls a tendon.

    Attributes:
        motor: its description.
        start: initial command.
    """

    motor: TendonMotor
    start: float


class Joints(Protocol):
    """The joints of an armature: m, m/s and N, or rad, rad/s and N m."""

    def tell(self, names: Sequence[str], values: Sequence[float]) -> None:
        """Set the commands of motors: positions, velocities or efforts, see `morse.scene.Control`."""

    def set_control(self, name: str, control: Control, command: float) -> None:
        """Change the control mode of a motor, and its command."""

    @property
    def tendon_motors(self) -> Sequence[TendonSlot]:
        """The motors of the tendons of the armature."""

    def pull(self, commands: Mapping[str, float]) -> None:
        """Set the commands of motors of tendons: name to command."""

    def tendons(self) -> dict[str, tuple[float, float, float]]:
        """Return the tendons that have a motor: name of the motor to length (m), speed (m/s) and force (N)."""

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
