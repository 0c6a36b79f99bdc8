"""What ``<gazebo reference="link">`` says of the links of a URDF file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.colors import color_of
from morse.assets.gazebo.friction import friction_of
from morse.assets.gazebo.values import text_of
from morse.mathutils.light import linear_color

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.assets.urdf.structure import Document, Link

#: settings of the physics without a counterpart
_LEFT_OUT = (
    *("dampingFactor", "initial_joint_position", "kd", "kp", "maxVel", "minDepth", "selfCollide", "self_collide"),
    *("springStiffness", "stopKd", "stopKp", "turnGravityOff"),
)
#: values that mean nothing
_PLAIN = ("", "0", "0.0", "false", "False")


def read_references(robot: Element, document: Document) -> None:
    """Set the friction and the colours of links, and name what is left out."""
    left_out: set[str] = set()
    for gazebo in robot.findall("gazebo"):
        left_out |= {tag for tag in _LEFT_OUT if text_of(gazebo, tag) not in _PLAIN}
        link = document.links.get(gazebo.get("reference", ""))
        if link is None:
            continue
        friction, across = friction_of(gazebo, ("mu1", "mu")), friction_of(gazebo, ("mu2",))
        link.friction = link.friction if friction is None else friction
        if across is not None and across != friction:
            left_out.add("mu2")
        _paint(link, text_of(gazebo, "material"))
    if left_out:
        words = ", ".join(sorted(left_out, key=str.lower))
        document.warnings.append(f"settings of Gazebo that MORSE does not have are left out: {words}")


def _paint(link: Link, material: str) -> None:
    """Give shapes without a colour that of a material of Gazebo; meshes have colours of their own."""
    color = color_of(material)
    for shape in link.visuals:
        if color is not None and shape.color is None and shape.kind != "mesh":
            shape.color = linear_color((*color, 1.0))
