"""Physics settings of an object of a model file.

The settings come from several sources, in order of precedence:

1. custom properties of the object: ``physics_type`` (`RIGID_BODY`, `DYNAMIC`, `STATIC`, `NO_COLLISION`, `SENSOR`),
   ``collision`` (`box`, `sphere`, `cylinder`, `cone`, `capsule`, `convex`, `hull`, `decompose`,
   `mesh`, `none`), ``compound``,
   ``mass``, ``friction``, ``restitution``, ``linear_damping``, ``angular_damping``, ``radius``, ``ghost``,
   ``actor``, and ``visible``;
2. Blender's rigid body settings;
3. the settings for the game engine that Blender had until 2.79.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from morse.scene import BodySettings, Bounds, PhysicsType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.scene import CollisionShape

#: names of collision shapes
COLLISIONS = {
    "box": Bounds.BOX,
    "sphere": Bounds.SPHERE,
    "cylinder": Bounds.CYLINDER,
    "cone": Bounds.CONE,
    "capsule": Bounds.CAPSULE,
    "convex": Bounds.CONVEX_HULL,
    "hull": Bounds.CONVEX_HULL,
    "decompose": Bounds.DECOMPOSITION,
    "mesh": Bounds.TRIANGLE_MESH,
    "none": None,
}
_TYPES = [kind.value for kind in PhysicsType if kind is not PhysicsType.AUTO]
_FLAGS = ("compound", "ghost", "actor")
#: property to its smallest and largest valid value
_NUMBERS = {
    "mass": (1e-9, 1e9),
    "radius": (1e-6, 1e6),
    "friction": (0.0, 1e3),
    "restitution": (0.0, 1.0),
    "linear_damping": (0.0, 1.0),
    "angular_damping": (0.0, 1.0),
}
#: custom properties that are settings, and are therefore removed from the properties of a node
SETTINGS = frozenset({"physics_type", "collision", "visible", *_FLAGS, *_NUMBERS})


@dataclass(slots=True)
class Settled:
    """The resulting settings of one object.

    Attributes:
        body: settings of the body; the type is AUTO if the file does not specify it.
        shapes: empty for a body without its own shape; None if the shapes have to be computed.
        visible: False if a custom property hides it.
        properties: the custom properties that are not settings.
        warnings: warnings about invalid settings.
    """

    body: BodySettings = field(default_factory=lambda: BodySettings(type=PhysicsType.AUTO))
    shapes: list[CollisionShape] | None = None
    visible: bool = True
    properties: dict[str, object] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def settle(
    name: str,
    properties: Mapping[str, object],
    rigid_body: Mapping[str, Any] | None = None,
    game: Mapping[str, Any] | None = None,
) -> Settled:
    """Combine the settings of an object by precedence.

    Args:
        name: name of the object, for warnings.
        properties: its custom properties.
        rigid_body: fields of `BodySettings` from rigid body settings.
        game: fields of `BodySettings` from old game engine settings.
    """
    settings = Settled(properties={key: value for key, value in properties.items() if key not in SETTINGS})
    weaker = {**(game or {}), **(rigid_body or {})}
    own = _Settings(name, properties, settings.warnings)
    for key, (low, high) in _NUMBERS.items():
        weaker[key] = _clamped(weaker.get(key), low, high)
        weaker[key] = own.number(key, low, high, weaker[key])
    for key in _FLAGS:
        weaker[key] = own.flag(key, weaker.get(key))
    settings.visible = own.flag("visible", True) is not False
    kind = own.choice("physics_type", _TYPES)
    collision = own.choice("collision", list(COLLISIONS))
    if kind is not None:
        weaker["type"] = PhysicsType(kind)
    if collision is not None:
        weaker["bounds"] = COLLISIONS[collision]
    if collision == "none":
        settings.shapes = []
        weaker.setdefault("type", PhysicsType.NO_COLLISION)
    if "type" not in weaker and own.says("mass"):
        # an object with a mass is meant to move, with all objects below it
        weaker["type"] = PhysicsType.RIGID_BODY
        if weaker["compound"] is None:
            weaker["compound"] = True
    known_values = {key: value for key, value in weaker.items() if value is not None}
    settings.body = replace(settings.body, **known_values)
    return settings


class _Settings:
    """The custom properties of an object, read as settings."""

    def __init__(self, name: str, properties: Mapping[str, object], warnings: list[str]) -> None:
        self._name = name
        self._properties = properties
        self._warnings = warnings

    def says(self, key: str) -> bool:
        return key in self._properties

    def number(self, key: str, low: float, high: float, default: float | None) -> float | None:
        value = self._properties.get(key)
        if value is None:
            return default
        if isinstance(value, (bool, int, float)) and low <= value <= high:
            return float(value)
        self._warn(key, value, f"a number from {low:g} to {high:g}")
        return default

    def flag(self, key: str, default: bool | None) -> bool | None:
        value = self._properties.get(key)
        if value is None:
            return default
        if isinstance(value, (bool, int, float)) and value in (0, 1):
            return bool(value)
        self._warn(key, value, "0 or 1")
        return default

    def choice(self, key: str, choices: list[str]) -> str | None:
        value = self._properties.get(key)
        if value is None:
            return None
        for name in choices:
            if isinstance(value, str) and value.casefold() == name.casefold():
                return name
        close = difflib.get_close_matches(str(value).upper(), [name.upper() for name in choices], 1, 0.5)
        hint = next((f"; did you mean '{name}'?" for name in choices if close and name.upper() == close[0]), "")
        self._warn(key, value, f"one of {', '.join(choices)}{hint}")
        return None

    def _warn(self, key: str, value: object, expects: str) -> None:
        text = repr(value)
        text = text if len(text) <= 60 else text[:57] + "..."
        self._warnings.append(
            f"the object '{self._name}' has the custom property {key} = {text}, which is ignored: expected {expects}"
        )


def _clamped(value: float | None, low: float, high: float) -> float | None:
    return None if value is None else min(max(float(value), low), high)
