"""The names that bodies had in MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.mathutils import Matrix, Vector


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
    def worldOrientation(self, value: Sequence[Sequence[float]]) -> None:  # noqa: N802
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

    def applyForce(self, force: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Apply a force at the centre of mass during the next tick, N."""

    def applyTorque(self, torque: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Apply a torque during the next tick, N m."""

    def applyMovement(self, movement: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Move the object immediately, m."""

    def applyRotation(self, rotation: Sequence[float], local: bool = False) -> None:  # noqa: N802
        """Rotate the object immediately, rad about each axis."""
