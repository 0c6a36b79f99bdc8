"""Recognised objects as a list of Lisp, for planners that read s-expressions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.values import RosMessage

#: a symbol: none of the characters that the Lisp reader treats specially, and not a number
_SYMBOL = re.compile(r"(?![+-]?[.\d])[\w.+*/<>=!?&$%^~-]+")


def as_lisp(objects: Iterable[RosMessage]) -> str:
    """Return ``((name description x y z qx qy qz qw) ...)``.

    An empty description is ``-``. Texts that are no symbols are strings in quotation marks.

    Args:
        objects: the ``visible_objects`` of a `SemanticCamera`: positions in m, orientations as quaternions.
    """
    return f"({' '.join(map(_object, objects))})"


def _object(description: RosMessage) -> str:
    orientation = description["orientation"]
    numbers = (*description["position"], orientation.x, orientation.y, orientation.z, orientation.w)
    words = (_atom(description["name"]), _atom(description["description"] or "-"), *(repr(float(n)) for n in numbers))
    return f"({' '.join(words)})"


def _atom(text: str) -> str:
    if _SYMBOL.fullmatch(text):
        return text
    content = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{content}"'
