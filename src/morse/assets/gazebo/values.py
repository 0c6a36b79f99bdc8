"""Numbers, words and poses in the elements of an SDF file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.xml_files import line_of
from morse.mathutils import Euler, Matrix, Quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence
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
    if not all(abs(value) <= FARTHEST for value in values):
        raise ValueMistakeError(f"<pose> is {text[:60]!r}, expected numbers up to {FARTHEST:g}{line_of(element)}")
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
