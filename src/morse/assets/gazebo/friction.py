"""The friction of shapes in the files of Gazebo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

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
