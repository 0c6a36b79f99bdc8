"""The description of a robot from a URDF file: the file of the user, with the frames of its components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from morse.rosmsgs.urdf import add_fixed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.rosmsgs.moving import Joint
    from morse.rosmsgs.urdf import Carried


def describe_file(
    text: str, base: str, rename: Callable[[str], str], joints: list[Joint], components: Mapping[str, Carried]
) -> str:
    """The text of a URDF file with the names of frames as links.

    Args:
        text: of the file.
        base: frame of the robot.
        rename: the frame of a link.
        joints: joints of the robot, parents first.
        components: its components by frame.
    """
    model = ElementTree.fromstring(text)
    for element, attribute in _links(model):
        element.set(attribute, rename(element.get(attribute, "")))
    links = {element.get("name", "") for element in model.findall("link")}
    if base not in links:
        ElementTree.SubElement(model, "link", name=base)
    names = links | {base}
    for joint in joints:
        if joint.frame not in names or (joint.parent == base and base not in links):
            if joint.frame not in names:
                ElementTree.SubElement(model, "link", name=joint.frame)
            add_fixed(model, joint.name, joint.parent, joint.frame, joint.pose(), moves=not joint.is_fixed)
            names.add(joint.frame)
    for frame, one in components.items():
        if frame not in names:
            ElementTree.SubElement(model, "link", name=frame)
            add_fixed(model, f"{frame}_joint", base, frame, one.pose, moves=one.moves)
    return ElementTree.tostring(model, encoding="unicode")


def _links(model: Any) -> list[tuple[Any, str]]:
    """The elements that name links, and the attributes with the names."""
    elements = [(one, "name") for one in model.findall("link")]
    for joint in model.findall("joint"):
        elements += [(end, "link") for end in (joint.find("parent"), joint.find("child")) if end is not None]
    elements += [(one, "reference") for one in model.findall("gazebo") if one.get("reference")]
    return elements + [(one, "link") for one in model.findall("sensor/parent")]
