"""The attributes of objects under the names of MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.mathutils import Matrix, Vector
from morse.physics.poses import rigid
from morse.physics.poses.convert import ANGULAR_VELOCITY, MOVEMENT, POSITION, ROTATION, VELOCITY, floats3, rotation_of

if TYPE_CHECKING:
    from collections.abc import Sequence

# ruff: noqa: N802, N815


def _matrix(r: Sequence[float]) -> Matrix:
    return Matrix(((r[0], r[1], r[2]), (r[3], r[4], r[5]), (r[6], r[7], r[8])))


class LegacyNames:
    """Poses, velocities and forces as attributes; see `morse.physics.objects.gameobject.GameObject`."""

    def world_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9) in the world."""
        raise NotImplementedError

    def local_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9) in the frame of the parent."""
        raise NotImplementedError

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose in the world."""
        raise NotImplementedError

    def set_local_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose in the frame of the parent."""
        raise NotImplementedError

    def velocity(self) -> tuple[Sequence[float], Sequence[float]]:
        """Linear and angular velocity of its origin, world axes."""
        raise NotImplementedError

    def set_velocity(self, linear: Sequence[float] | None, angular: Sequence[float] | None) -> None:
        """Set the velocity of its body in world axes; None keeps the present velocity."""
        raise NotImplementedError

    def wrench(self, force: Sequence[float], torque: Sequence[float], local: bool) -> None:
        """Apply a force and a torque at the centre of mass during the next tick."""
        raise NotImplementedError

    @property
    def worldPosition(self) -> Vector:
        """Position in the world, m."""
        return Vector(self.world_pose()[0])

    @worldPosition.setter
    def worldPosition(self, value: Sequence[float]) -> None:
        self.set_pose(floats3(value, POSITION), self.world_pose()[1])

    @property
    def worldOrientation(self) -> Matrix:
        """3x3 rotation from its axes to those of the world."""
        return _matrix(self.world_pose()[1])

    @worldOrientation.setter
    def worldOrientation(self, value: object) -> None:
        self.set_pose(self.world_pose()[0], rotation_of(value))

    @property
    def localPosition(self) -> Vector:
        """Position in the frame of its parent, m."""
        return Vector(self.local_pose()[0])

    @localPosition.setter
    def localPosition(self, value: Sequence[float]) -> None:
        self.set_local_pose(floats3(value, POSITION), self.local_pose()[1])

    @property
    def localOrientation(self) -> Matrix:
        """3x3 rotation from its axes to those of its parent."""
        return _matrix(self.local_pose()[1])

    @localOrientation.setter
    def localOrientation(self, value: object) -> None:
        self.set_local_pose(self.local_pose()[0], rotation_of(value))

    # 1.4 read these in the world frame and wrote them in the frame of the parent; scripts rely on both
    position = property(lambda self: self.worldPosition, lambda self, value: setattr(self, "localPosition", value))
    orientation = property(
        lambda self: self.worldOrientation, lambda self, value: setattr(self, "localOrientation", value)
    )

    @property
    def worldTransform(self) -> Matrix:
        """4x4 pose in the world."""
        p, r = self.world_pose()
        return Matrix(((*r[0:3], p[0]), (*r[3:6], p[1]), (*r[6:9], p[2]), (0.0, 0.0, 0.0, 1.0)))

    @worldTransform.setter
    def worldTransform(self, value: Sequence[Sequence[float]]) -> None:
        self.set_pose(floats3([value[i][3] for i in range(3)], POSITION), rotation_of([row[:3] for row in value][:3]))

    @property
    def worldLinearVelocity(self) -> Vector:
        """Velocity of its origin in world axes, m/s."""
        return Vector(self.velocity()[0])

    @worldLinearVelocity.setter
    def worldLinearVelocity(self, value: Sequence[float]) -> None:
        self.set_velocity(floats3(value, VELOCITY), None)

    @property
    def worldAngularVelocity(self) -> Vector:
        """Angular velocity in world axes, rad/s."""
        return Vector(self.velocity()[1])

    @worldAngularVelocity.setter
    def worldAngularVelocity(self, value: Sequence[float]) -> None:
        self.set_velocity(None, floats3(value, ANGULAR_VELOCITY))

    @property
    def localLinearVelocity(self) -> Vector:
        """Velocity of its origin in its own axes, m/s."""
        return Vector(rigid.turn_back(self.world_pose()[1], self.velocity()[0]))

    @localLinearVelocity.setter
    def localLinearVelocity(self, value: Sequence[float]) -> None:
        self.set_velocity(rigid.turn(self.world_pose()[1], floats3(value, VELOCITY)), None)

    @property
    def localAngularVelocity(self) -> Vector:
        """Angular velocity in its own axes, rad/s."""
        return Vector(rigid.turn_back(self.world_pose()[1], self.velocity()[1]))

    @localAngularVelocity.setter
    def localAngularVelocity(self, value: Sequence[float]) -> None:
        self.set_velocity(None, rigid.turn(self.world_pose()[1], floats3(value, ANGULAR_VELOCITY)))

    linearVelocity = property(
        lambda self: self.worldLinearVelocity, lambda self, value: setattr(self, "worldLinearVelocity", value)
    )
    angularVelocity = property(
        lambda self: self.worldAngularVelocity, lambda self, value: setattr(self, "worldAngularVelocity", value)
    )

    def getLinearVelocity(self, local: bool = False) -> Vector:
        """Velocity of its origin, m/s."""
        return self.localLinearVelocity if local else self.worldLinearVelocity

    def setLinearVelocity(self, velocity: Sequence[float], local: bool = False) -> None:
        """Set the velocity of its origin, m/s."""
        if local:
            self.localLinearVelocity = velocity
        else:
            self.worldLinearVelocity = velocity

    def getAngularVelocity(self, local: bool = False) -> Vector:
        """Angular velocity, rad/s."""
        return self.localAngularVelocity if local else self.worldAngularVelocity

    def setAngularVelocity(self, velocity: Sequence[float], local: bool = False) -> None:
        """Set the angular velocity, rad/s."""
        if local:
            self.localAngularVelocity = velocity
        else:
            self.worldAngularVelocity = velocity

    def applyForce(self, force: Sequence[float], local: bool = False) -> None:
        """Apply a force at the centre of mass during the next tick, N."""
        self.wrench(force, (0.0, 0.0, 0.0), local)

    def applyTorque(self, torque: Sequence[float], local: bool = False) -> None:
        """Apply a torque during the next tick, N m."""
        self.wrench((0.0, 0.0, 0.0), torque, local)

    def applyMovement(self, movement: Sequence[float], local: bool = False) -> None:
        """Move the object immediately, m."""
        p, r = self.world_pose()
        m = floats3(movement, MOVEMENT)
        x, y, z = rigid.turn(r, m) if local else m
        self.set_pose((p[0] + x, p[1] + y, p[2] + z), r)

    def applyRotation(self, rotation: Sequence[float], local: bool = False) -> None:
        """Rotate the object immediately, rad about each axis."""
        p, r = self.world_pose()
        matrix = rotation_of(list(floats3(rotation, ROTATION)))
        self.set_pose(p, rigid.product(r, matrix) if local else rigid.product(matrix, r))
