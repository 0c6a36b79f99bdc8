"""Colours and lights of objects, which services change."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.context import Context
    from morse.core.values import Value
    from morse.core.world import Body
    from morse.scene import Image

#: largest energy of a lamp
_BRIGHTEST = 1e6


def set_color(context: Context, obj: Body, color: Sequence[float]) -> None:
    """Set the colour of the surfaces of an object and its parts; of its light, if it is a lamp.

    Raises:
        ValueError: the colour is not valid, or the object has neither surface nor lamp.
    """
    check(obj, "color", color)
    numbers = [float(number) for number in color]
    for part in _parts(obj, "color"):
        if part.node.mesh is None:
            part.node.light = replace(part.node.light, color=tuple(numbers[:3]))
        else:
            part.node.color = (*numbers[:3], numbers[3] if len(numbers) == 4 else 1.0)
        context.world.appearance_changed(part)


def set_texture(context: Context, obj: Body, image: Image) -> None:
    """Set the texture of the surfaces of an object and its parts.

    Raises:
        ValueError: the object has no surface.
    """
    check(obj, "texture", image)
    for part in _parts(obj, "texture"):
        part.node.image = image
        context.world.appearance_changed(part)


def set_light(context: Context, obj: Body, energy: float) -> None:
    """Set the energy of the lamps of an object and its parts.

    Raises:
        ValueError: the energy is not valid, or the object has no lamp.
    """
    check(obj, "light", energy)
    for part in _parts(obj, "light"):
        part.node.light = replace(part.node.light, energy=float(energy))
        context.world.appearance_changed(part)


def check(obj: Body, what: str, value: Value) -> None:
    """Raise the ValueError of `set_color` or `set_light`; ``what`` is ``color``, ``texture`` or ``light``."""
    if what == "color":
        if len(value) not in (3, 4) or not all(0.0 <= number <= 1.0 for number in value):
            raise ValueError(
                f"the colour of '{obj.name}' is {list(value)!r:.100}, expected red, green, blue from 0 to 1, and "
                "perhaps the opacity"
            )
    elif what == "light" and (not 0.0 <= value <= _BRIGHTEST or not math.isfinite(value)):
        raise ValueError(f"the energy of the lamp '{obj.name}' is {value!r:.100}, expected 0 to {_BRIGHTEST:g}")
    if not _parts(obj, what):
        expected = {"color": "neither a surface nor a lamp", "texture": "no surface"}.get(what, "no lamp")
        raise ValueError(f"'{obj.name}' has {expected}: it has no {what} to set")


def _parts(obj: Body, what: str) -> list[Any]:
    everything = [obj, *obj.childrenRecursive]
    lamps = [part for part in everything if part.node.light is not None]
    surfaces = [part for part in everything if part.node.mesh is not None]
    if what == "texture":
        return surfaces
    return (surfaces or lamps) if what == "color" else lamps
