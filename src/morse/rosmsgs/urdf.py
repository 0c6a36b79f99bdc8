"""The description of a robot as URDF: its frames, its joints, and its collision shapes.

Source of the format: wiki.ros.org/urdf/XML.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple
from xml.etree import ElementTree

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.rosmsgs.parts import product
from morse.scene.body import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.rosmsgs.moving import Joint
    from morse.scene import Node

_ONE_AXIS = ("continuous", "revolute", "prismatic")
_GREY = (0.6, 0.6, 0.6, 1.0)
#: size of a shape without extent along an axis, m
_THIN = 1e-3


class Carried(NamedTuple):
    """A component with a frame.

    Attributes:
        object: the object in the world.
        pose: pose of its frame, X forward, in the frame of the robot.
        moves: whether it is on another component, which may move it.
    """

    object: Body
    pose: Transformation3d
    moves: bool


def describe(name: str, robot: Body, base: str, joints: list[Joint], components: Mapping[str, Carried]) -> str:
    """The text of a URDF.

    Args:
        name: of the robot.
        robot: its object in the world.
        base: its frame.
        joints: its joints, parents first.
        components: its components by frame.
    """
    model = ElementTree.Element("robot", name=name)
    owners = {id(joint.part.object): joint.frame for joint in joints}
    owners |= {id(one.object): frame for frame, one in components.items()}
    _add_link(model, base, robot, owners, Transformation3d(robot))
    for joint in joints:
        _add_link(model, joint.frame, joint.part.object, owners, joint.place())
        _add_joint(model, joint)
    for frame, one in components.items():
        _add_link(model, frame, one.object, owners, product(Transformation3d(robot), one.pose))
        add_fixed(model, f"{frame}_joint", base, frame, one.pose, moves=one.moves)
    ElementTree.indent(model)
    return ElementTree.tostring(model, encoding="unicode")


def add_fixed(model: Element, name: str, parent: str, frame: str, pose: Transformation3d, *, moves: bool) -> None:
    """Add a joint that is fixed, or that moves in any way."""
    joint = ElementTree.SubElement(model, "joint", name=name, type="floating" if moves else "fixed")
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=frame)
    joint.append(_origin(pose))


def _add_joint(model: Element, joint: Joint) -> None:
    part = joint.part
    element = ElementTree.SubElement(model, "joint", name=joint.name, type=part.type)
    ElementTree.SubElement(element, "parent", link=joint.parent)
    ElementTree.SubElement(element, "child", link=joint.frame)
    element.append(_origin(joint.origin() if part.type in _ONE_AXIS else joint.pose()))
    if part.type not in _ONE_AXIS:
        return
    ElementTree.SubElement(element, "axis", xyz=_numbers(part.axis))
    if part.mimic is not None:
        leader, factor, offset = part.mimic
        ElementTree.SubElement(element, "mimic", joint=leader, multiplier=f"{factor:.9g}", offset=f"{offset:.9g}")
    if part.type != "continuous":
        limits = {"lower": f"{part.low:.9g}", "upper": f"{part.high:.9g}", "effort": "0", "velocity": "0"}
        ElementTree.SubElement(element, "limit", limits)


def _add_link(model: Element, frame: str, obj: Body, owners: Mapping[int, str], place: Transformation3d) -> None:
    link = ElementTree.SubElement(model, "link", name=frame)
    for part in _own_parts(obj, frame, owners):
        pose = place.transformation3d_with(Transformation3d(part))
        for shape in _shapes(part):
            for what in ("visual", "collision"):
                if what == "collision" and not part.node.shapes:
                    continue
                element = ElementTree.SubElement(link, what)
                element.append(_origin(_placed(pose, shape)))
                element.append(_geometry(shape))
                if what == "visual":
                    material = ElementTree.SubElement(element, "material", name=f"{part.node.name}_material")
                    ElementTree.SubElement(material, "color", rgba=_numbers(_color(part.node)))


def _own_parts(obj: Body, frame: str, owners: Mapping[int, str]) -> Iterator[Body]:
    """The object and its descendants, except for those with their own link."""
    yield obj
    for child in obj.children:
        if owners.get(id(child), frame) == frame:
            yield from _own_parts(child, frame, owners)


def _shapes(part: Body) -> Iterable[CollisionShape]:
    if part.node.shapes:
        return list(part.node.shapes)
    mesh = part.node.mesh
    if mesh is None or not len(mesh.vertices) or not part.visible:
        return ()
    scale = np.abs(part.node.world_matrix().to_scale())
    return (_box(np.asarray(mesh.vertices, dtype=np.float64) * scale),)


def _box(points: NDArray[np.float64]) -> CollisionShape:
    """The box around points (N, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = ((low + high) / 2.0).tolist()
    return CollisionShape(ShapeKind.BOX, tuple(((high - low) / 2.0).tolist()), (x, y, z))


def _block(shape: CollisionShape) -> CollisionShape:
    """The box around a height field that is not turned against its node."""
    x, y, top, base = shape.size
    a, b, c = shape.position
    return CollisionShape(ShapeKind.BOX, (x, y, (top + base) / 2.0), (a, b, c + (top - base) / 2.0), shape.rotation)


def _placed(pose: Transformation3d, shape: CollisionShape) -> Transformation3d:
    if shape.kind is ShapeKind.CONVEX:
        shape = _box(np.asarray(shape.vertices))
    elif shape.kind is ShapeKind.HEIGHT_FIELD:
        shape = _block(shape)
    own = Transformation3d()
    own.set_pose(shape.position, shape.rotation)
    return product(pose, own)


def _geometry(shape: CollisionShape) -> Element:
    element = ElementTree.Element("geometry")
    if shape.kind is ShapeKind.CONVEX:
        shape = _box(np.asarray(shape.vertices))
    elif shape.kind is ShapeKind.HEIGHT_FIELD:
        shape = _block(shape)
    size = [max(2.0 * extent, _THIN) for extent in shape.size]
    if shape.kind is ShapeKind.BOX:
        ElementTree.SubElement(element, "box", size=_numbers(size))
    elif shape.kind in (ShapeKind.CYLINDER, ShapeKind.CAPSULE):
        radius, length = size[0] / 2.0, size[1]
        # URDF has no capsule
        length += 2.0 * radius if shape.kind is ShapeKind.CAPSULE else 0.0
        ElementTree.SubElement(element, "cylinder", radius=f"{radius:.9g}", length=f"{length:.9g}")
    else:
        ElementTree.SubElement(element, "sphere", radius=f"{max(size) / 2.0:.9g}")
    return element


def _color(node: Node) -> tuple[float, ...]:
    if node.color is not None:
        return tuple(node.color)
    for material in (*node.materials, *(node.mesh.materials if node.mesh is not None else ())):
        color = getattr(material, "color", None)
        if color is not None:
            # viewers of URDF expect sRGB
            return (*(float(c) ** (1.0 / 2.2) for c in color[:3]), 1.0)
    return _GREY


def _origin(pose: Transformation3d) -> Element:
    rpy = (pose.euler.x, pose.euler.y, pose.euler.z)
    return ElementTree.Element("origin", xyz=_numbers((pose.x, pose.y, pose.z)), rpy=_numbers(rpy))


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value if math.isfinite(value) and abs(value) > 1e-12 else 0.0:.9g}" for value in values)
