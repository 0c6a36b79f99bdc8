"""A model as robots: its links and joints in the description that URDF files have, and the nodes of these."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.description import Link, RobotDescription, check_counts, inertial_of
from morse.assets.gazebo.plugins import Plugins, prepare_motors, read_plugins
from morse.assets.gazebo.sensors import declared_sensors
from morse.assets.gazebo.values import ValueMistakeError, boolean, number, text_of, vector
from morse.assets.robot_nodes import robot_library
from morse.assets.sdf.joints import JointTree
from morse.assets.sdf.scope import SEPARATOR, WORLD, FlatLink, joints_of, links_of
from morse.assets.sdf.worlds import light_node
from morse.assets.xml_files import LocatedElement
from morse.mathutils import Matrix

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.geometry import Geometry
    from morse.assets.sdf.includes import Includes
    from morse.assets.sdf.scope import FlatJoint, Scope
    from morse.scene import Inertial, Node
    from morse.scene.component import DeclaredSensor

_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
#: moments, kg m^2, of a link without an element for them
_USUAL = {"ixx": 1.0, "iyy": 1.0, "izz": 1.0}
#: kg/m^3
_WATER = 1000.0


def inertial_in(link: FlatLink) -> tuple[Inertial, str]:
    """Return the mass of a link, and a warning if the file is wrong (else an empty string).

    A link without a mass weighs 1 kg; with ``auto``, its mass is that of its shapes.

    Raises:
        ValueMistakeError: a number is wrong, or the mass is negative.
    """
    element = link.part.element.find("inertial")
    if element is not None and (element.get("auto") or "").lower() in ("true", "1"):
        mass = sum(
            _mass(collision, number(element, "density", _WATER)) for collision in link.part.element.findall("collision")
        )
        return inertial_of(mass or 1.0, link.place(element), None)
    mass = number(element, "mass", 1.0)
    if mass < 0.0:
        raise ValueMistakeError(f"its mass is {mass:g} kg")
    tensor = None if element is None else element.find("inertia")
    moments = [number(tensor, name, _USUAL.get(name, 0.0)) for name in _MOMENTS]
    place = link.place(element) if element is not None else link.place(link.part.element.makeelement("inertial", {}))
    return inertial_of(mass, place, moments)


def _mass(collision: Element, density: float) -> float:
    """The mass of a shape, kg; 0 for meshes, which are not measured."""
    density = number(collision, "density", density)
    geometry = collision.find("geometry")
    kind = next((child.tag for child in geometry if isinstance(child.tag, str)), "") if geometry is not None else ""
    shape = None if geometry is None else geometry.find(kind) if kind else None
    radius, length = number(shape, "radius", 0.0), number(shape, "length", 0.0)
    volumes = {
        "box": math.prod(vector(shape, "size", (0.0, 0.0, 0.0))) if text_of(shape, "size") and kind == "box" else 0.0,
        "sphere": 4.0 / 3.0 * math.pi * radius**3,
        "cylinder": math.pi * radius**2 * length,
        "cone": math.pi * radius**2 * length / 3.0,
        "capsule": math.pi * radius**2 * (length + 4.0 / 3.0 * radius),
        "ellipsoid": 4.0 / 3.0 * math.pi * math.prod(vector(shape, "radii", (0.0, 0.0, 0.0))),
    }
    return abs(density * volumes.get(kind, 0.0))


class Models:
    """Converts models to nodes.

    Attributes:
        sensors, actuators: those of the last model.
    """

    def __init__(self, path: Path, includes: Includes, geometry: Geometry) -> None:
        self._path, self._includes, self._geometry = path, includes, geometry
        self._warn = includes.warn
        self.sensors: list[DeclaredSensor] = []
        self.actuators: list[DeclaredSensor] = []
        self._moving = 0

    def node(self, model: Scope, pose: Matrix, *, prefix: str = "") -> Node | None:
        """The node of a model and everything below it; None if it has no links.

        Links that no joints connect with the first one move freely.

        Args:
            pose: 4x4 of the model in the world.
            prefix: what the names of its links begin with.
        """
        links = {link.name: link for link in links_of(model)}
        if not links:
            return None
        joints = list(joints_of(model, self._warn))
        document = self._document(model, links, joints, prefix)
        plugins = self._plugins(model, document, list(links), prefix)
        self.actuators = plugins.actuators
        library = robot_library(self._path, document)
        for warning in library.warnings:
            self._warn(warning)
        self.sensors = document.sensors + plugins.sensors
        root = library.roots[0]
        root.location, root.rotation_euler = list(pose.translation), list(pose.to_euler())
        root.body.gravity = any(boolean(link.part.element, "gravity", True) for link in links.values())
        armature = root.children[0]
        if document.root != f"{prefix}{WORLD}":
            base = links[document.root.removeprefix(prefix)].pose
            armature.location, armature.rotation_euler = list(base.translation), list(base.to_euler())
        return root

    def _plugins(self, model: Scope, document: RobotDescription, links: list[str], prefix: str) -> Plugins:
        first = document.root.removeprefix(prefix)
        links.sort(key=lambda name: name != first)
        plugins = Plugins({joint.name: joint for joint in document.joints}, links, prefix, document.name, self._warn)
        read_plugins(plugins, _plugins_of(model))
        prepare_motors(document, plugins)
        return plugins

    def _document(
        self, model: Scope, links: dict[str, FlatLink], joints: list[FlatJoint], prefix: str
    ) -> RobotDescription:
        poses = {name: link.pose for name, link in links.items()} | {WORLD: Matrix.Identity(4)}
        tree = JointTree(self._path, poses, self._warn)
        is_static = all(link.is_static for link in links.values())
        is_tied = WORLD in links or any(WORLD in (joint.parent, joint.child) for joint in joints)
        root = WORLD if is_tied else model.first_link()
        left = tree.grow(root, joints)
        for name in links:
            if name != root and not any(joint.child == name for joint in tree.joints):
                if is_static:
                    tree.fix(root, name)
                else:
                    tree.float(root, name)
                left = tree.grow(name, left)
        tree.settle_mimics()
        self._moving += 0 if is_static else sum(joint.kind != "fixed" for joint in tree.joints)
        check_counts(self._path, len(links), self._moving)
        names = dict.fromkeys([*([WORLD] if root == WORLD else []), *links])
        # the link that carries the others comes first
        parts = {
            f"{prefix}{name}": self._link(links.get(name), f"{prefix}{name}", is_static=is_static) for name in names
        }
        parts |= {f"{prefix}{link.name}": Link(f"{prefix}{link.name}") for link in tree.extra}
        for joint in tree.joints:
            joint.parent, joint.child = f"{prefix}{joint.parent}", f"{prefix}{joint.child}"
            if is_static:
                joint.kind, joint.mimic = "fixed", None
        sensors, remarks = self._sensors(links, joints, prefix)
        for remark in remarks:
            self._warn(remark)
        return RobotDescription(
            # the engine has a body of this name
            model.name if model.name != WORLD else f"{WORLD}_model",
            parts,
            tree.joints,
            f"{prefix}{root}",
            [],
            sensors,
            fixed=is_static or root == WORLD,
            constraints=tuple(tree.constraints),
            self_collision=model.self_collide,
        )

    def _link(self, link: FlatLink | None, name: str, *, is_static: bool) -> Link:
        if link is None:
            return Link(name)
        result = Link(name)
        try:
            result.inertial, remark = inertial_in(link)
            if remark and not is_static:
                self._warn(f"the link '{name:.80}': {remark}")
        except ValueMistakeError as error:
            self._warn(f"the mass of the link '{name:.80}' is left out: {error}")
        element = link.part.element
        for index, child in enumerate([*element.findall("visual"), *element.findall("collision")], 1):
            try:
                pose = link.place(child, child.get("name", ""))
            except ValueMistakeError as error:
                self._warn(f"a <{child.tag}> of the link '{name:.80}' is left out: {error}")
                continue
            part = self._geometry.node(
                child, link.part.path, f"{name}_{child.get('name') or index}", pose, is_static=is_static
            )
            if part is not None:
                result.parts.append(part)
        for light in element.findall("light"):
            try:
                result.parts.append(light_node(light, link.place(light)))
            except ValueMistakeError as error:
                self._warn(f"the light '{(light.get('name') or '')[:80]}' is left out: {error}")
        return result

    def _sensors(
        self, links: dict[str, FlatLink], joints: list[FlatJoint], prefix: str
    ) -> tuple[list[DeclaredSensor], list[str]]:
        wrong: list[str] = []

        def elements() -> Iterator[tuple[Element, str]]:
            for link in links.values():
                for element in link.part.element.findall("sensor"):
                    try:
                        yield _in_link(element, link), f"{prefix}{link.name}"
                    except ValueMistakeError as error:
                        wrong.append(f"the sensor '{element.get('name', '')[:60]}' is left out: {error}")

            for joint in joints:
                yield from ((element, f"{prefix}{joint.child}") for element in joint.element.findall("sensor"))

        visible = {f"{prefix}{name}" for name, link in links.items() if link.part.element.find("visual") is not None}
        sensors, remarks = declared_sensors(elements(), {f"{prefix}{name}" for name in links}, visible)
        return sensors, [*wrong, *remarks]


def _plugins_of(model: Scope, prefix: str = "") -> Iterator[tuple[Element, str]]:
    """The plugins of a model and its nested models, with the prefixes of names in these."""
    for element, _ in model.plugins:
        yield element, prefix
    for name, child in model.models.items():
        yield from _plugins_of(child, f"{prefix}{name}{SEPARATOR}")


def _in_link(element: Element, link: FlatLink) -> Element:
    """A sensor whose pose is in the frame of its link, as six numbers."""
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return element
    place = link.place(element, element.get("name", ""))
    copy = LocatedElement(element.tag, dict(element.attrib))
    copy.line = getattr(element, "line", 0)
    own = copy.makeelement("pose", {})
    own.text = " ".join(repr(value) for value in (*place.translation, *place.to_euler()))
    copy.extend([own, *(child for child in element if child is not pose)])
    return copy
