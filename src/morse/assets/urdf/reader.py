"""URDF files: links, joints, shapes. See http://wiki.ros.org/urdf/XML."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.description import (
    LOOSE,
    WORLD,
    Joint,
    Link,
    RobotDescription,
    Shape,
    check_counts,
    check_depth,
    inertial_of,
    settle_mimics,
)
from morse.assets.errors import AssetError
from morse.assets.gazebo.sensors import sensors_of
from morse.assets.robot_nodes import robot_library
from morse.assets.triangle_limit import check_parts
from morse.assets.urdf.drives import add_plugins
from morse.assets.urdf.expansion import read_expanded, text_with_urls
from morse.assets.xml_files import line_of
from morse.mathutils import Euler, Matrix
from morse.mathutils.portable import linear_color
from morse.scene import JointDynamics

if TYPE_CHECKING:
    from xml.etree import ElementTree

    from morse.scene import Inertial, Library

_FARTHEST = 1e6
#: rad or m, for joints without limits
_ENDLESS = 1e4
#: elements whose number is limited
_COUNTED = ("link", "joint", "visual", "collision", "material", "sensor", "gazebo", "transmission")
_SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")
_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")


class _Parser:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.warnings: list[str] = []
        self.colors: dict[str, tuple[float, float, float, float]] = {}

    def fail(self, message: str, element: ElementTree.Element | None = None) -> AssetError:
        return AssetError(self.path, f"{message}{line_of(element)}")

    def numbers(self, element: ElementTree.Element | None, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
        text = None if element is None else element.get(name)
        if text is None or element is None or not text.strip():
            return default
        try:
            numbers = tuple(float(word) for word in text.replace(",", " ").split())
        except ValueError:
            numbers = ()
        if len(numbers) > len(default):
            self.warnings.append(f"<{element.tag} {name}={text[:60]!r}>: only the first {len(default)} are used")
            numbers = numbers[: len(default)]
        if len(numbers) != len(default) or not all(abs(value) <= _FARTHEST for value in numbers):
            count = "a number" if len(default) == 1 else f"{len(default)} numbers"
            raise self.fail(f"<{element.tag} {name}={text[:60]!r}>: expected {count}", element)
        return numbers

    def name(self, element: ElementTree.Element, path: str = "", attribute: str = "name") -> str:
        """An attribute of an element, or of one below it."""
        place = element.find(path) if path else element
        name = None if place is None else place.get(attribute)
        if not name:
            raise self.fail(f"a <{path or element.tag}> has no '{attribute}'", element if place is None else place)
        return name

    def origin(self, element: ElementTree.Element) -> Matrix:
        origin = element.find("origin")
        result = Euler(self.numbers(origin, "rpy", (0.0, 0.0, 0.0))).to_matrix().to_4x4()
        result.translation = self.numbers(origin, "xyz", (0.0, 0.0, 0.0))
        return result

    def shapes(self, link: ElementTree.Element, tag: str) -> list[Shape]:
        shapes = []
        for element in link.findall(tag):
            geometry = element.find("geometry")
            kinds = [] if geometry is None else [child for child in geometry if isinstance(child.tag, str)]
            shape = next((child for child in kinds if child.tag in _SHAPES), None)
            if shape is None:
                what = kinds[0].tag if kinds else "nothing"
                self.warnings.append(f"a <{tag}> of the link '{link.get('name')}' is {what}; it is left out")
                continue
            origin, color = self.origin(element), self.color(element)
            if shape.tag == "mesh":
                scale, file = self.numbers(shape, "scale", (1.0, 1.0, 1.0)), shape.get("filename")
                if file:
                    shapes.append(Shape("mesh", scale, file, origin, color))
                else:
                    self.warnings.append(f"a <mesh> of the link '{link.get('name')}' has no 'filename'; it is left out")
                continue
            size = self.size(shape)
            if min(size) <= 0.0:
                self.warnings.append(f"a <{shape.tag}> of the link '{link.get('name')}' has no size; it is left out")
                continue
            shapes.append(Shape(shape.tag, size, "", origin, color))
        return shapes

    def size(self, shape: ElementTree.Element) -> tuple[float, ...]:
        if shape.tag == "box":
            return tuple(0.5 * side for side in self.numbers(shape, "size", (0.0, 0.0, 0.0)))
        (radius,) = self.numbers(shape, "radius", (0.0,))
        return (radius,) if shape.tag == "sphere" else (radius, 0.5 * self.numbers(shape, "length", (0.0,))[0])

    def color(self, element: ElementTree.Element) -> tuple[float, float, float, float] | None:
        material = element.find("material")
        if material is None:
            return None
        return self.define(material)

    def define(self, material: ElementTree.Element) -> tuple[float, float, float, float] | None:
        """Return the colour of a material; the colour of a named material is stored for later references."""
        color = material.find("color")
        if color is None:
            return self.colors.get(material.get("name") or "")
        r, g, b, a = self.numbers(color, "rgba", (0.8, 0.8, 0.8, 1.0))
        rgba = linear_color([min(max(value, 0.0), 1.0) for value in (r, g, b, a)])
        if material.get("name"):
            self.colors[str(material.get("name"))] = rgba
        return rgba

    def link(self, element: ElementTree.Element) -> Link:
        name = self.name(element)
        return Link(
            name, self.inertial(name, element), self.shapes(element, "visual"), self.shapes(element, "collision")
        )

    def inertial(self, link: str, element: ElementTree.Element) -> Inertial | None:
        inertial = element.find("inertial")
        mass_element = None if inertial is None else inertial.find("mass")
        if inertial is None or mass_element is None:
            return None
        mass = self.numbers(mass_element, "value", (0.0,))[0]
        if mass < 0.0:
            raise self.fail(f"the link '{link}' has the mass {mass:g} kg", mass_element)
        origin, tensor = self.origin(inertial), inertial.find("inertia")
        moments = None
        if tensor is not None:
            moments = tuple(
                self.numbers(tensor, name, (0.0,))[0] for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            )
        inertia, remark = inertial_of(mass, origin, moments)
        if remark:
            self.warnings.append(f"the link '{link}': {remark}")
        return inertia

    def joint(self, element: ElementTree.Element) -> Joint:
        name, kind = self.name(element), (element.get("type") or "").strip().lower()
        kind = "spherical" if kind == "ball" else kind
        if kind not in _KINDS:
            raise self.fail(f"the joint '{name}' is of the type {kind!r}, expected one of {', '.join(_KINDS)}", element)
        x, y, z = self.numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0))
        length = math.sqrt(x * x + y * y + z * z)
        if length < 1e-9 and kind not in ("fixed", "floating", "spherical"):
            # other readers load such a file, and nothing says where the joint would go
            self.warnings.append(f"the joint '{name}' has an axis of length 0{line_of(element)}: it is fixed")
            kind = "fixed"
        limit, dynamics = element.find("limit"), element.find("dynamics")
        (low,), (high,) = (self.limit(limit, name) for name in ("lower", "upper"))
        if kind in LOOSE:
            low = high = 0.0
        elif kind == "continuous" or (kind != "fixed" and not self.has_range(limit)):
            # a joint that nothing limits; 0 for both, the default of the format, would lock it, and no engine does
            low, high = -_ENDLESS, _ENDLESS
        if low > high:
            self.warnings.append(f"the joint '{name}' goes from {low:g} to {high:g}; it has no limits here")
            low, high = -_ENDLESS, _ENDLESS
        axis = (x / length, y / length, z / length) if length >= 1e-9 else (1.0, 0.0, 0.0)
        parent = self.name(element, "parent", "link")
        child = self.name(element, "child", "link")
        effort, speed = self.most(limit, "effort"), self.most(limit, "velocity")
        (damping,), (friction,) = self.numbers(dynamics, "damping", (0.0,)), self.numbers(dynamics, "friction", (0.0,))
        moves = JointDynamics(
            damping=max(damping, 0.0),
            friction=max(friction, 0.0),
            effort=effort,
            speed=speed,
            limited=kind not in LOOSE and (low > -_ENDLESS or high < _ENDLESS),
        )
        return Joint(name, kind, parent, child, self.origin(element), axis, low, high, moves, self.mimic(element))

    @staticmethod
    def has_range(element: ElementTree.Element | None) -> bool:
        """Whether one of the limits is given."""
        return element is not None and any(element.get(name, "").strip() for name in ("lower", "upper"))

    def limit(self, element: ElementTree.Element | None, name: str) -> tuple[float]:
        """Return a limit of a joint; very large numbers, and infinity, stand for no limit."""
        text = "" if element is None else element.get(name, "")
        try:
            number = float(text)
        except ValueError:
            return (self.numbers(element, name, (0.0,))[0],)
        return (math.copysign(_ENDLESS, number) if abs(number) > _ENDLESS else number,)

    def most(self, element: ElementTree.Element | None, name: str) -> float:
        """Return the largest effort or speed of a motor; 0 and very large numbers stand for no limit."""
        text = "" if element is None else element.get(name, "")
        try:
            number = float(text)
        except ValueError:
            (number,) = self.numbers(element, name, (0.0,))
        return number if 0.0 < number <= _FARTHEST else math.inf

    def mimic(self, element: ElementTree.Element) -> tuple[str, float, float] | None:
        mimic = element.find("mimic")
        if mimic is None:
            return None
        (factor,), (offset,) = self.numbers(mimic, "multiplier", (1.0,)), self.numbers(mimic, "offset", (0.0,))
        return self.name(element, "mimic", "joint"), factor, offset


def read_urdf(path: str | Path) -> Library:
    """Read a robot.

    Its links become nodes with the same names below the armature ``<robot>_joints``, whose bones are the joints.

    Raises:
        AssetError: the file is broken or contradicts itself.
        OSError: it cannot be opened.
    """
    path = Path(path)
    return robot_library(path, parse(path))


def parse(path: Path) -> RobotDescription:
    """Read a file.

    Raises:
        AssetError: it is not XML, not URDF, or contradicts itself.
        OSError: it cannot be opened.
    """
    parser = _Parser(path)
    robot = read_expanded(path)
    if robot.tag != "robot":
        raise parser.fail(f"it is not URDF: it begins with <{str(robot.tag)[:60]}>, expected <robot>")
    for tag in _COUNTED:
        check_parts(path, sum(1 for _ in robot.iter(tag)), f"elements <{tag}>")
    for material in robot.findall("material"):
        parser.define(material)
    links = {link.name: link for link in map(parser.link, robot.findall("link"))}
    joints = [parser.joint(element) for element in robot.findall("joint")]
    if any(joint.parent == WORLD for joint in joints):
        # joints fix robots to the world also in files that do not declare it
        links.setdefault(WORLD, Link(WORLD))
    root, sequence = _tree(parser, links, joints, robot.findall("joint"))
    root, sequence = _let_float(parser, links, root, sequence)
    sensors, remarks = sensors_of(robot, links)
    document = RobotDescription(
        robot.get("name") or path.stem, links, sequence, root, [*parser.warnings, *remarks], sensors
    )
    add_plugins(robot, document)
    document.text, document.files = text_with_urls(robot, path)
    return document


def _let_float(parser: _Parser, links: dict[str, Link], root: str, sequence: list[Joint]) -> tuple[str, list[Joint]]:
    """Return the root and the joints without a link of no substance relative to which the robot floats: it is free."""
    first = [joint for joint in sequence if joint.parent == root]
    is_marker = root == WORLD or (links[root].inertial is None and not links[root].collisions)
    if not is_marker or len(first) != 1 or first[0].kind != "floating":
        return root, sequence
    x, y, z = first[0].origin.translation
    if max(map(abs, (x, y, z))) > 1e-9:
        parser.warnings.append(
            f"the joint '{first[0].name}' places the robot at {x:g} {y:g} {z:g}: set the position in the script "
            "instead, with translate()"
        )
    if links[root].visuals:
        parser.warnings.append(f"the link '{root}', relative to which the robot floats, is not shown")
    del links[root]
    return first[0].child, [joint for joint in sequence if joint is not first[0]]


def _tree(
    parser: _Parser, links: dict[str, Link], joints: list[Joint], places: list[ElementTree.Element]
) -> tuple[str, list[Joint]]:
    """The root, and the joints in an order in which the parent of each is known.

    Args:
        places: the elements of the joints.
    """
    if not links:
        raise parser.fail("it has no links")
    check_counts(parser.path, len(links), sum(joint.kind != "fixed" for joint in joints))
    names: set[str] = set()
    above: dict[str, Joint] = {}
    below: dict[str, list[Joint]] = {}
    for joint, place in zip(joints, places, strict=True):
        for link in (joint.parent, joint.child):
            if link not in links:
                raise parser.fail(f"the joint '{joint.name}' refers to the link '{link}', which does not exist", place)
        if joint.name in names:
            raise parser.fail(f"two joints have the name '{joint.name}'", place)
        if joint.child in above:
            raise parser.fail(f"the link '{joint.child}' is the child of two joints", place)
        names.add(joint.name)
        above[joint.child] = joint
        below.setdefault(joint.parent, []).append(joint)
    roots = [name for name in links if name not in above]
    if len(roots) != 1:
        what = (
            f"it has {len(roots)} links without a parent: {', '.join(roots[:4])}"
            if roots
            else "its joints form a cycle"
        )
        raise parser.fail(what)
    sequence, queue, depth = [], [roots[0]], {roots[0]: 0}
    while queue:
        link = queue.pop(0)
        check_depth(parser.path, depth[link], link)
        for joint in below.get(link, ()):
            sequence.append(joint)
            queue.append(joint.child)
            depth[joint.child] = depth[link] + 1
    if len(sequence) != len(joints):
        raise parser.fail("its joints form a cycle")
    settle_mimics(sequence, parser.warnings.append)
    return roots[0], sequence
