"""Numbers, words, poses, friction and colours in files of Gazebo, and its folders of models."""

from __future__ import annotations

import math
import os
import re
from pathlib import PurePath
from typing import TYPE_CHECKING

from morse.assets.xml_files import line_of, read_xml
from morse.mathutils import Euler, Matrix, Quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element


#: largest number; larger ones, and infinity, stand for "no limit"
FARTHEST = 1e6
_TRUE, _FALSE = ("true", "1"), ("false", "0")


class ValueMistakeError(ValueError):
    """The text of an element is not what its kind demands; the message contains both."""


def text_of(element: Element | None, path: str, default: str = "") -> str:
    """The text of an element below another one, without surrounding spaces."""
    text = None if element is None else element.findtext(path)
    return default if text is None or not text.strip() else text.strip()


def boolean(element: Element | None, path: str, default: bool = False) -> bool:
    """A truth value; the default for any other text."""
    word = text_of(element, path).lower()
    return True if word in _TRUE else False if word in _FALSE else default


def number(element: Element | None, path: str, default: float) -> float:
    """A finite number; the default if the element is missing.

    Raises:
        ValueMistakeError: the text is not a number.
    """
    value = unlimited(element, path, default)
    return min(max(value, -FARTHEST), FARTHEST)


def unlimited(element: Element | None, path: str, default: float) -> float:
    """A number that may be infinite.

    Raises:
        ValueMistakeError: the text is not a number.
    """
    text = text_of(element, path)
    if not text:
        return default
    (value,) = _floats(text.split()[:1], path, None if element is None else element.find(path))
    return value


def vector(element: Element | None, path: str, default: Sequence[float]) -> tuple[float, ...]:
    """As many numbers as the default has; the default if the element is missing.

    Raises:
        ValueMistakeError: there are fewer numbers, or one is too large.
    """
    text = text_of(element, path)
    if not text:
        return tuple(default)
    words = text.replace(",", " ").split()
    place = None if element is None else element.find(path)
    values = _floats(words, path, place)
    if len(values) < len(default) or not all(abs(value) <= FARTHEST for value in values):
        raise ValueMistakeError(f"<{path}> is {text[:60]!r}, expected {len(default)} numbers{line_of(place)}")
    return tuple(values[: len(default)])


def pose_of(element: Element | None) -> Matrix:
    """The 4x4 pose in the text of an element ``pose``: x, y, z and roll, pitch, yaw or a quaternion.

    Raises:
        ValueMistakeError: it has too few numbers, or one is too large.
    """
    text = "" if element is None else (element.text or "").strip()
    if element is None or not text:
        return Matrix.Identity(4)
    values = _floats(text.replace(",", " ").split(), "pose", element)
    if not all(abs(value) <= FARTHEST for value in values):
        raise ValueMistakeError(f"<pose> is {text[:60]!r}, expected numbers up to {FARTHEST:g}{line_of(element)}")
    if element.get("rotation_format") == "quat_xyzw":
        if len(values) != 7 or not any(values[3:]):
            raise ValueMistakeError(f"<pose> is {text[:60]!r}, expected 3 numbers and a quaternion{line_of(element)}")
        x, y, z, w = values[3:]
        pose: Matrix = Quaternion((w, x, y, z)).normalized().to_matrix().to_4x4()
    else:
        if len(values) != 6:
            raise ValueMistakeError(f"<pose> is {text[:60]!r}, expected 6 numbers{line_of(element)}")
        factor = math.pi / 180.0 if (element.get("degrees") or "").lower() in _TRUE else 1.0
        pose = Euler([factor * angle for angle in values[3:]]).to_matrix().to_4x4()
    pose.translation = values[:3]
    return pose


def _floats(words: Sequence[str], what: str, element: Element | None) -> list[float]:
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = [math.nan]
    if any(math.isnan(value) for value in values):
        raise ValueMistakeError(f"<{what}> is {' '.join(words)[:60]!r}, expected numbers{line_of(element)}")
    return values


#: The smaller friction coefficient of two surfaces applies in Gazebo. Its default, and larger ones, mean that the other
#: surface decides, as the default of MORSE does.
_ROUGH = 1.0


def friction_of(element: Element, paths: Sequence[str]) -> float | None:
    """The first Coulomb coefficient of some elements that is a number; None for the default."""
    for path in paths:
        try:
            coefficient = number(element, path, _ROUGH)
        except ValueMistakeError:
            continue
        if 0.0 <= coefficient < _ROUGH:
            return coefficient
    return None


Color = tuple[float, float, float]

#: name after ``Gazebo/`` to the diffuse colour, sRGB; pictures are represented by their mean colour
_COLORS: dict[str, Color] = {
    "Black": (0.0, 0.0, 0.0),
    "Blue": (0.0, 0.0, 1.0),
    "BlueLaser": (0.0, 0.0, 1.0),
    "Bricks": (0.55, 0.35, 0.28),
    "CeilingTiled": (0.8, 0.8, 0.78),
    "Chrome": (0.75, 0.75, 0.75),
    "DarkGray": (0.175, 0.175, 0.175),
    "DarkGrey": (0.175, 0.175, 0.175),
    "DarkMagentaTransparent": (0.7, 0.0, 0.7),
    "DarkOrangeTransparent": (1.0, 0.55, 0.0),
    "DarkYellow": (0.7, 0.7, 0.0),
    "FlatBlack": (0.1, 0.1, 0.1),
    "FloorTiled": (0.7, 0.7, 0.68),
    "Gold": (0.8, 0.65, 0.12),
    "Grass": (0.33, 0.45, 0.2),
    "Gray": (0.7, 0.7, 0.7),
    "Green": (0.0, 1.0, 0.0),
    "Grey": (0.7, 0.7, 0.7),
    "Indigo": (0.33, 0.0, 0.5),
    "LightWood": (0.75, 0.6, 0.42),
    "Motorway": (0.3, 0.3, 0.3),
    "Orange": (1.0, 0.51, 0.05),
    "PaintedWall": (0.85, 0.83, 0.77),
    "PioneerBody": (0.8, 0.1, 0.1),
    "Purple": (1.0, 0.0, 1.0),
    "Red": (1.0, 0.0, 0.0),
    "RedBright": (0.87, 0.26, 0.07),
    "Residential": (0.35, 0.35, 0.35),
    "Road": (0.35, 0.35, 0.35),
    "Rocky": (0.45, 0.42, 0.38),
    "SkyBlue": (0.13, 0.44, 0.7),
    "Steel": (0.6, 0.6, 0.62),
    "Turquoise": (0.0, 1.0, 1.0),
    "White": (1.0, 1.0, 1.0),
    "WhiteGlow": (1.0, 1.0, 1.0),
    "Wood": (0.6, 0.42, 0.25),
    "WoodFloor": (0.55, 0.38, 0.22),
    "WoodPallet": (0.65, 0.5, 0.33),
    "WoodTile": (0.55, 0.38, 0.22),
    "Yellow": (1.0, 1.0, 0.0),
    "ZincYellow": (0.97, 0.95, 0.21),
}


def color_of(name: str) -> Color | None:
    """The colour of a material of Gazebo; variants that glow or are transparent have that of the plain one."""
    prefix, _, own = name.partition("/")
    if prefix != "Gazebo":
        return None
    for suffix in ("", "Glow", "TransparentOverlay", "Transparent", "GlowOutline"):
        if own.endswith(suffix) and (color := _COLORS.get(own.removesuffix(suffix))):
            return color
    return None


CONFIG = "model.config"


def model_file(folder: Path) -> Path | None:
    """The SDF file of a model: the newest one that its ``model.config`` names, or ``model.sdf``; None without any.

    A name that leads out of the folder is left out.
    """
    config = folder / CONFIG
    elements = read_xml(config).iter("sdf") if config.is_file() else ()
    names = [(version_of(element), (element.text or "").strip()) for element in elements]
    for _, name in sorted(names, reverse=True):
        if name and "\0" not in name and _is_below(name) and (folder / name).is_file():
            return folder / name
    usual = folder / "model.sdf"
    return usual if usual.is_file() else None


def _is_below(name: str) -> bool:
    path = PurePath(os.path.normpath(name.replace("\\", "/")))
    return not path.is_absolute() and ".." not in path.parts


def version_of(element: Element) -> tuple[int, ...]:
    """The version of SDF in an element: (1, 6)."""
    words = re.findall(r"\d{1,6}", element.get("version") or "")
    return tuple(int(word) for word in words[:2]) or (1, 4)
