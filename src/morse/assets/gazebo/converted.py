"""The actuators and sensors that plugins of Gazebo and ROS stand for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError
from morse.mathutils import Matrix
from morse.mathutils.rotations import nine
from morse.scene.component import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Callable
    from xml.etree.ElementTree import Element

    from morse.assets.urdf.structure import Joint

#: names between the names of nested models
_SEPARATOR = "::"
Properties = dict[str, float | int | str]
Options = dict[str, str | bool]


class Plugins:
    """Collects what the plugins of a model stand for.

    Args:
        joints: of the model, by name.
        links: names of its links, the one that carries the others first.
        prefix: what the names of the links begin with in the scene.
        body: name of the node of the model, below which ``<body>_joints`` is the armature of the joints.
        warn: receives what is left out.

    Attributes:
        actuators, sensors: what the plugins stand for.
        driven: names of the joints that they move.
        torques: of the motors of joints, N m, as the plugins limit them.
    """

    def __init__(
        self, joints: dict[str, Joint], links: list[str], prefix: str, body: str, warn: Callable[[str], None]
    ) -> None:
        self.joints, self.links, self.prefix, self.body, self.warn = joints, links, prefix, body, warn
        self.driven: set[str] = set()
        self.torques: dict[str, float] = {}
        self.actuators: list[DeclaredSensor] = []
        self.sensors: list[DeclaredSensor] = []

    def named(self, element: Element, prefix: str, *tags: str) -> str:
        """The joints in some elements, separated by commas."""
        names = [(child.text or "").strip() for tag in tags for child in element.findall(tag)]
        return ", ".join(self.joint(name, prefix) for name in names if name)

    def joint(self, name: str, prefix: str) -> str:
        """The name of a joint in the scene, which the plugin moves."""
        for candidate in (f"{prefix}{name}", name, name.rpartition(_SEPARATOR)[2]):
            if candidate in self.joints:
                self.driven.add(candidate)
                return candidate
        raise ValueMistakeError(f"the model has no joint '{name[:60]}'")

    def link(self, name: str, prefix: str) -> str:
        """The name of a link in the scene, without the prefix of the model."""
        for candidate in (f"{prefix}{name}", name):
            if candidate in self.links:
                return candidate
        raise ValueMistakeError(f"the model has no link '{name[:60]}'")

    def add(
        self,
        name: str,
        product: str,
        properties: Properties,
        link: str = "",
        pose: Matrix | None = None,
        options: Options | None = None,
    ) -> None:
        """Add an actuator to a link, by default the one that carries the others."""
        place = pose or Matrix.Identity(4)
        x, y, z = place.translation
        rotation = nine(list(place.to_3x3()))
        self.actuators.append(
            DeclaredSensor(
                name, product, f"{self.prefix}{link or self.links[0]}", (x, y, z), rotation, tuple(properties.items()),
                stream=tuple((options or {}).items()),
            )
        )  # fmt: skip

    def measure(self, name: str, product: str, options: Options, frequency: float, *, joints: bool = False) -> None:
        """Add a sensor to the body or the joints, unless the model has one of that name."""
        if any(one.name == name for one in self.sensors):
            return
        self.sensors.append(
            DeclaredSensor(
                name, product, f"{self.body}_joints" if joints else self.body, (0.0, 0.0, 0.0),
                nine(list(Matrix.Identity(3))), frequency=frequency if 0.0 < frequency <= 10_000.0 else None,
                stream=tuple(options.items()),
            )
        )  # fmt: skip
