"""MJCF files of earlier versions of MuJoCo, in the form of the present version.

Removed: global coordinates (2.3.4), and attributes that the engine does not need or names in another way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

#: element to removed attributes that change no motion, and to those that have other names
_REMOVED = {
    "option": ("apirate",),
    "compiler": ("coordinate", "convexhull", "exactmeshinertia"),
    "flag": ("sensornoise",),
}
_RENAMED = {"option": {"mpr_iterations": "ccd_iterations", "mpr_tolerance": "ccd_tolerance"}}
_ROTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
#: elements of bodies that have a position
_PLACED = ("geom", "joint", "site", "camera", "light", "inertial")


def modernize(root: Element, path: Path) -> None:
    """Change the elements of a model that the present version of the engine does not read.

    Raises:
        AssetError: the model has global coordinates and rotated bodies.
    """
    is_global = any(element.get("coordinate") == "global" for element in root.iter("compiler"))
    for element in root.iter():
        for name in _REMOVED.get(element.tag, ()):
            element.attrib.pop(name, None)
        for old, new in _RENAMED.get(element.tag, {}).items():
            if old in element.attrib:
                element.attrib[new] = element.attrib.pop(old)
        if element.tag == "flag" and (passive := element.attrib.pop("passive", None)):
            element.attrib |= {"spring": passive, "damper": passive}
    for option in root.iter("option"):
        _choose_contacts(root, option.attrib.pop("collision", "all"))
    if is_global:
        for world in root.iter("worldbody"):
            for body in world.findall("body"):
                _make_local(body, (0.0, 0.0, 0.0), path)


def _choose_contacts(root: Element, kinds: str) -> None:
    """Keep the contacts of pairs only (``predefined``), or all but these (``dynamic``)."""
    if kinds == "predefined":
        for geom in root.iter("geom"):
            geom.attrib |= {"contype": "0", "conaffinity": "0"}
    elif kinds == "dynamic":
        for contact in root.iter("contact"):
            for pair in contact.findall("pair"):
                contact.remove(pair)


def _make_local(body: Element, outer: Sequence[float], path: Path) -> None:
    """Replace global positions by those in the frame of the body, which has the axes of the world.

    Args:
        outer: position of the frame of the parent.
    """
    if any(body.get(name) for name in _ROTATIONS):
        name = (body.get("name") or "")[:60]
        raise AssetError(path, f"it has global coordinates, and the body '{name}' is rotated: use local coordinates")
    # a body without a position may have any frame
    place = _numbers(body, "pos") or outer
    for child in body:
        if child.tag in _PLACED:
            _shift(child, place)
        elif child.tag in ("body", "frame"):
            _make_local(child, place, path)
    _write(body, "pos", (a - b for a, b in zip(place, outer, strict=True)))


def _shift(element: Element, origin: Sequence[float]) -> None:
    ends = _numbers(element, "fromto")
    if len(ends) == 6:
        _write(element, "fromto", (value - origin[number % 3] for number, value in enumerate(ends)))
    elif element.tag != "joint" or element.get("type") != "free":
        position = _numbers(element, "pos") or (0.0, 0.0, 0.0)
        _write(element, "pos", (a - b for a, b in zip(position, origin, strict=False)))


def _numbers(element: Element, name: str) -> tuple[float, ...]:
    """The numbers of an attribute; none if it is missing, or invalid, which the engine reports."""
    try:
        return tuple(map(float, element.get(name, "").split()))
    except ValueError:
        return ()


def _write(element: Element, name: str, numbers: Iterator[float]) -> None:
    element.set(name, " ".join(map(repr, numbers)))
