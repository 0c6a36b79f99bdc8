"""Poses of the links of an SDF file, computed from its elements alone, for comparison."""

from xml.etree import ElementTree

import numpy as np

Pose = np.ndarray


def pose(element: ElementTree.Element | None) -> Pose:
    """4x4 of an element ``pose``: x, y, z, roll, pitch, yaw about fixed axes."""
    result = np.eye(4)
    if element is None or not (element.text or "").strip():
        return result
    x, y, z, *angles = map(float, element.text.split())
    if element.get("degrees") == "true":
        angles = [np.radians(angle) for angle in angles]
    a, b, c = angles
    rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    ry = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    rz = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    result[:3, :3] = rz @ ry @ rx
    result[:3, 3] = x, y, z
    return result


def link_poses(model: ElementTree.Element) -> dict[str, Pose]:
    """4x4 of all links of a model and its nested models, in the frame of the model."""
    result = {}
    for link in model.findall("link"):
        result[link.get("name")] = frame(model, link.get("name"))
    for nested in model.findall("model"):
        outer = frame(model, nested.get("name"))
        for name, inner in link_poses(nested).items():
            result[f"{nested.get('name')}::{name}"] = outer @ inner
    return result


def frame(model: ElementTree.Element, name: str) -> Pose:
    """4x4 of a link, joint, frame or nested model in the frame of a model."""
    if name in ("", "__model__", "world"):
        return np.eye(4)
    head, _, rest = name.partition("::")
    for child in model:
        if child.tag not in ("link", "joint", "frame", "model") or child.get("name") != head:
            continue
        element = child.find("pose")
        base = None if element is None else element.get("relative_to")
        if base is None:
            base = {"joint": child.findtext("child"), "frame": child.get("attached_to", "")}.get(child.tag, "")
        place = frame(model, base.strip()) @ pose(element)
        if child.get("placement_frame"):
            place = place @ np.linalg.inv(frame(child, child.get("placement_frame")))
        return place @ frame(child, rest) if rest else place
    raise KeyError(name)
