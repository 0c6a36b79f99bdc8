# Written by `python -m tools` from what the components declare: do not edit.

from typing import Any
from morse.builder.components.robot import GroundRobot as GroundRobot
from morse.builder.components.robot import Robot as Robot
from morse.builder.components.robot import WheeledRobot as WheeledRobot
from morse.builder.components.robots import BarePR2 as BarePR2
from morse.builder.components.robots import BasePR2 as BasePR2
from morse.builder.components.robots import DeclaredRobot as DeclaredRobot
from morse.builder.components.robots import Human as Human
from morse.builder.components.robots import LocalizedPR2 as LocalizedPR2
from morse.builder.components.robots import Morsy as Morsy
from morse.builder.components.robots import NavPR2 as NavPR2

__all__ = [
    "ATRV",
    "B21",
    "BarePR2",
    "BasePR2",
    "FakeRobot",
    "Human",
    "Hummer",
    "Jido",
    "LocalizedPR2",
    "Morsy",
    "NavPR2",
    "PatrolBot",
    "Pioneer3DX",
    "QUAD2012",
    "Quadrotor",
    "RMax",
    "SegwayRMP400",
    "Submarine",
    "Victim",
]

class ATRV(DeclaredRobot, GroundRobot):
    """A four-wheeled outdoor robot, driven as one rigid body."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class B21(DeclaredRobot, GroundRobot):
    """A round indoor robot."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class FakeRobot(DeclaredRobot, Robot):
    """A frame without a body that only carries components."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class Hummer(DeclaredRobot, GroundRobot):
    """An off-road vehicle with steered wheels."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class Jido(DeclaredRobot, GroundRobot):
    """An indoor robot with a mast."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class PatrolBot(DeclaredRobot, WheeledRobot):
    """An indoor robot with two driven wheels and casters."""
    def properties(
        self,
        *,
        NoGravity: bool = ...,
        GroundRobot: bool = ...,
        FixTurningSpeed: float = ...,
        Influence: float = ...,
        Friction: float = ...,
        HasSuspension: bool = ...,
        RideHeight: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Pioneer3DX(DeclaredRobot, WheeledRobot):
    """A small indoor robot with two driven wheels and a caster."""
    def properties(
        self,
        *,
        NoGravity: bool = ...,
        GroundRobot: bool = ...,
        FixTurningSpeed: float = ...,
        Influence: float = ...,
        Friction: float = ...,
        HasSuspension: bool = ...,
        RideHeight: float = ...,
        **kwargs: Any,
    ) -> None: ...

class QUAD2012(DeclaredRobot, Robot):
    """A quadrotor without collision."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class Quadrotor(DeclaredRobot, Robot):
    """A quadrotor with a rigid body."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class RMax(DeclaredRobot, Robot):
    """A helicopter."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class SegwayRMP400(DeclaredRobot, WheeledRobot):
    """An outdoor robot with four driven wheels."""
    def properties(
        self,
        *,
        NoGravity: bool = ...,
        GroundRobot: bool = ...,
        FixTurningSpeed: float = ...,
        Influence: float = ...,
        Friction: float = ...,
        HasSuspension: bool = ...,
        RideHeight: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Submarine(DeclaredRobot, Robot):
    """A submarine with neutral buoyancy."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...

class Victim(DeclaredRobot, GroundRobot):
    """A person who can be found and healed (see the sensor SearchAndRescue)."""
    def properties(self, *, NoGravity: bool = ..., GroundRobot: bool = ..., **kwargs: Any) -> None: ...
