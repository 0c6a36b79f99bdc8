"""Joints that the physics moves, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.scene import Control


class FileMotor(Protocol):
    """An actuator of a model file that is no motor of a single joint: of a tendon, a muscle.

    Attributes:
        name: its name.
        commands: smallest and largest command.
        start: initial command.
    """

    name: str
    commands: tuple[float, float]
    start: float


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
        """The actuators of the file of the armature that are no motors of single joints."""

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
