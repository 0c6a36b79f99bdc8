"""The changes of a scene since its script was run."""

from __future__ import annotations

from dataclasses import dataclass, field

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Addition:
    """A robot, an object or a component of a robot that was added.

    Attributes:
        name: in the scene, without the name of the robot; also the variable of the script, so that it is a free one.
        kind: name of a builder class, also ``package.builder.robots:Class`` of a project, or name of a model, with
            ``#`` and the name of an object of it.
        position: in the world, or in the frame of what carries it, m.
        angles: Euler angles XYZ, rad.
        robot: name of the robot or the component that carries a component; empty for others.
        part: name of the part of what carries it to which it is attached; empty for the usual one.
        scale: factor along each axis.
        own_position, own_angles: the pose that the builder gives to such an object.
        has_own_name: whether the builder gives such an object a name, so that it is not called as its variable.
        calls: of its methods, as text: ``frequency(10)``.
    """

    name: str
    kind: str
    position: Triple
    angles: Triple = (0.0, 0.0, 0.0)
    robot: str = ""
    own_position: Triple = (0.0, 0.0, 0.0)
    own_angles: Triple = (0.0, 0.0, 0.0)
    has_own_name: bool = False
    calls: tuple[str, ...] = ()
    scale: Triple = (1.0, 1.0, 1.0)
    part: str = ""

    @property
    def scene_name(self) -> str:
        """Its name in the scene."""
        return f"{self.robot}.{self.name}" if self.robot else self.name


@dataclass(frozen=True, slots=True)
class Move:
    """An object of the script or of its world, or a component, has another pose.

    Attributes:
        position, angles: the new pose: m, Euler angles XYZ in rad; of a component in the frame of what carries it.
        old_position, old_angles: the pose when the script was run.
    """

    name: str
    position: Triple
    angles: Triple
    old_position: Triple
    old_angles: Triple


@dataclass(frozen=True, slots=True)
class Changes:
    """All changes of a scene.

    Attributes:
        additions: in the order in which they were made.
        moves: of objects that exist when the script is run.
        deletions: names of root objects, with the names of the objects below each, and of components.
        calls: of methods of components that exist when the script is run, by the name of the component.
        settings: calls of methods of the environment, as text.
    """

    additions: list[Addition] = field(default_factory=list)
    moves: list[Move] = field(default_factory=list)
    deletions: dict[str, list[str]] = field(default_factory=dict)
    calls: dict[str, list[str]] = field(default_factory=dict)
    settings: list[str] = field(default_factory=list)


class UnwritableError(ValueError):
    """A change cannot be written into the script; the message tells the user what to do."""
