"""Declarations of robots, sensors and actuators in a scene, and of the noise and delay of sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils.rotations import Rotation9
    from morse.scene.node import Node


@dataclass(frozen=True, slots=True)
class SourceLine:
    """A location in the script of the user."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


@dataclass(eq=False, slots=True)
class StreamDeclaration:
    """A data stream of a component.

    Attributes:
        manager: class path of the stream manager.
        stream: class path of the publisher or reader.
        direction: ``IN`` or ``OUT``.
        options: options from the script: topic, port, frame_id, ...
    """

    manager: str
    stream: str
    direction: str
    options: dict[str, object] = field(default_factory=dict)
    where: SourceLine | None = None


@dataclass(eq=False, slots=True)
class ModifierDeclaration:
    """A modifier of a component: class path and options.

    Attributes:
        direction: ``IN`` or ``OUT`` if the script says so; only components that both read and publish use it.
    """

    classpath: str
    options: dict[str, object] = field(default_factory=dict)
    where: SourceLine | None = None
    direction: str | None = None


@dataclass(eq=False, slots=True)
class SensorAlteration:
    """A modifier of all sensors of a scene that it fits: its name and options, from ``env.alter``."""

    name: str
    options: dict[str, object] = field(default_factory=dict)
    where: SourceLine | None = None


@dataclass(eq=False, slots=True)
class OverlayDeclaration:
    """An overlay: class path, options and request manager."""

    manager: str
    classpath: str
    options: dict[str, object] = field(default_factory=dict)
    where: SourceLine | None = None


@dataclass(eq=False, slots=True)
class ComponentDeclaration:
    """A robot, sensor or actuator of the scene.

    Its name is the name of its node, e.g. ``robot.arm.pose``; its property values are the
    properties of its node.

    Attributes:
        kind: ``robot``, ``external_robot``, ``sensor`` or ``actuator``.
        classpath: class path of the component.
        robot: the node of the robot that carries it (the node itself for a robot).
        frequency: Hz, or None for every tick.
        level: abstraction level, or None for the default one.
        managers: class paths of the request managers that offer its services.
        profile: whether to show its computation time.
        where: the line of the script that created it.
        is_optional: whether the scene is loaded without it, with a warning, if it cannot work, because a model file
            declares it.
        measures_joint: whether a sensor measures the load of the joint that carries its link, also of a fixed joint.
        placed: root objects that it places when the simulation starts: the boxes of a dispenser.
    """

    node: Node
    kind: str
    classpath: str
    robot: Node
    frequency: float | None = None
    level: str | None = None
    streams: list[StreamDeclaration] = field(default_factory=list)
    managers: list[str] = field(default_factory=list)
    modifiers: list[ModifierDeclaration] = field(default_factory=list)
    overlays: list[OverlayDeclaration] = field(default_factory=list)
    options: dict[str, object] = field(default_factory=dict)
    profile: bool = False
    where: SourceLine | None = None
    is_optional: bool = False
    measures_joint: bool = False
    placed: list[Node] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The fully qualified name."""
        return self.node.name


@dataclass(frozen=True, slots=True)
class DeclaredSensor:
    """A sensor or actuator of a robot, as declared in the file of the robot.

    Attributes:
        name: name in the file.
        product: the class in scene scripts, e.g. ``VideoCamera``.
        link: name of the node that carries it, in the file.
        position: position in the frame of the link, m.
        rotation: 9 numbers, row by row, from the frame of the sensor (X forward, Z up) to that of the link.
        properties: names and values of the properties that the file sets.
        frequency: Hz, or None.
        noise: standard deviations of the white noise of fields; an empty name stands for all of them.
        has_own_visual: whether the file shows what the sensor looks like.
        stream: options of its streams that the file sets, such as the topic.
        origin: the element of the file for messages, such as ``the plugin 'drive' (line 9)``.
    """

    name: str
    product: str
    link: str
    position: tuple[float, float, float]
    rotation: Rotation9
    properties: tuple[tuple[str, float | int | str], ...] = ()
    frequency: float | None = None
    stream: tuple[tuple[str, str | bool], ...] = ()
    noise: tuple[tuple[str, float], ...] = ()
    has_own_visual: bool = False
    origin: str = ""


def _checked(name: str, value: object, unit: str) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name} takes a number{unit}, got {value!r}")
    if not 0.0 <= value < math.inf:
        raise ValueError(f"{name} takes a number{unit} of at least 0, got {value!r}")


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """The errors of a field.

    Attributes:
        gaussian: standard deviation of white noise, in the unit of the field.
        bias_walk: standard deviation of the bias after one second, in the unit of the field. The bias is a random walk
            from 0, which grows with the square root of time.
        quantization: step of the values, in the unit of the field.
        dropout: probability that a value is lost, 0..1.

    Raises:
        TypeError: a value is not a number.
        ValueError: a number is negative or not finite, or a probability is above 1.
    """

    gaussian: float = 0.0
    bias_walk: float = 0.0
    quantization: float = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            _checked(item.name, getattr(self, item.name), "")
        if self.dropout > 1.0:
            raise ValueError(f"dropout takes a probability from 0 to 1, got {self.dropout!r}")


@dataclass(frozen=True, slots=True)
class RealismModel:
    """The phase, delay and noise of a sensor.

    Attributes:
        phase: time of the first measurement after the start, s.
        delay: time from a measurement until its data are published, s.
        noise: field to its noise; the empty name stands for all fields that can have noise.

    Raises:
        TypeError: a value is not a number.
        ValueError: a number is negative or not finite.
    """

    phase: float = 0.0
    delay: float = 0.0
    noise: dict[str, NoiseModel] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _checked("phase", self.phase, " of seconds")
        _checked("delay", self.delay, " of seconds")


def is_numeric(value: object) -> bool:
    """Whether noise can be added: to numbers, and to vectors and lists of numbers, but not to booleans or strings."""
    if isinstance(value, (bool, str, bytes, dict)) or value is None:
        return False
    if isinstance(value, (int, float)):
        return True
    return hasattr(value, "__iter__") and all(is_numeric(item) for item in value)
