"""From what model files say of physics to bodies; from several loose objects to one component.

The settings of an object come from several places; the stronger one decides each of them:

1. custom properties of the object: ``physics_type`` (`RIGID_BODY`, `DYNAMIC`, `STATIC`, `NO_COLLISION`, `SENSOR`),
   ``collision`` (`box`, `sphere`, `cylinder`, `cone`, `capsule`, `convex`, `mesh`, `none`), ``compound``,
   ``mass``, ``friction``, ``restitution``, ``linear_damping``, ``angular_damping``, ``radius``, ``ghost``,
   ``actor``, and ``visible``;
2. Blender's rigid body settings;
3. the settings for the game engine that Blender had until 2.79;
4. what the role of the object makes likely (`resolve_auto`).
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from morse.assets.errors import AssetError
from morse.assets.poses import attach_in_place, set_free
from morse.scene import BodySettings, Bounds, Node, NodeKind, PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.scene import CollisionShape, Library

_COLLISIONS = {
    "box": Bounds.BOX,
    "sphere": Bounds.SPHERE,
    "cylinder": Bounds.CYLINDER,
    "cone": Bounds.CONE,
    "capsule": Bounds.CAPSULE,
    "convex": Bounds.CONVEX_HULL,
    "mesh": Bounds.TRIANGLE_MESH,
    "none": None,
}
_TYPES = [kind.value for kind in PhysicsType if kind is not PhysicsType.AUTO]
_FLAGS = ("compound", "ghost", "actor")
#: property to the smallest and the largest value that means something
_NUMBERS = {
    "mass": (1e-9, 1e9),
    "radius": (1e-6, 1e6),
    "friction": (0.0, 1e3),
    "restitution": (0.0, 1.0),
    "linear_damping": (0.0, 1.0),
    "angular_damping": (0.0, 1.0),
}
#: custom properties that are settings, so that they do not show up among the properties of a node
SETTINGS = frozenset({"physics_type", "collision", "visible", *_FLAGS, *_NUMBERS})


@dataclass(slots=True)
class Settled:
    """What the settings of one object come to.

    Attributes:
        body: type AUTO if the file says nothing of it.
        shapes: none at all for a body without a shape of its own, or None: to be worked out.
        visible: False if a custom property hides it.
        properties: the custom properties that are no settings.
        warnings: settings that make no sense.
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
    """Weigh the settings of an object against each other.

    Args:
        name: of the object, for warnings.
        properties: its custom properties.
        rigid_body: fields of `BodySettings` from rigid body settings.
        game: fields of `BodySettings` from old game engine settings.
    """
    settled = Settled(properties={key: value for key, value in properties.items() if key not in SETTINGS})
    weaker = {**(game or {}), **(rigid_body or {})}
    own = _Settings(name, properties, settled.warnings)
    for key, (low, high) in _NUMBERS.items():
        weaker[key] = _clamped(weaker.get(key), low, high)
        weaker[key] = own.number(key, low, high, weaker[key])
    for key in _FLAGS:
        weaker[key] = own.flag(key, weaker.get(key))
    settled.visible = own.flag("visible", True) is not False
    kind = own.choice("physics_type", _TYPES)
    collision = own.choice("collision", list(_COLLISIONS))
    if kind is not None:
        weaker["type"] = PhysicsType(kind)
    if collision is not None:
        weaker["bounds"] = _COLLISIONS[collision]
    if collision == "none":
        settled.shapes = []
        weaker.setdefault("type", PhysicsType.NO_COLLISION)
    if "type" not in weaker and own.says("mass"):
        # what weighs something is meant to move, with all that hangs on it
        weaker["type"] = PhysicsType.RIGID_BODY
        if weaker["compound"] is None:
            weaker["compound"] = True
    known = {key: value for key, value in weaker.items() if value is not None}
    settled.body = replace(settled.body, **known)
    return settled


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
        for known in choices:
            if isinstance(value, str) and value.casefold() == known.casefold():
                return known
        close = difflib.get_close_matches(str(value).upper(), [known.upper() for known in choices], 1, 0.5)
        hint = next((f"; did you mean '{known}'?" for known in choices if close and known.upper() == close[0]), "")
        self._warn(key, value, f"one of {', '.join(choices)}{hint}")
        return None

    def _warn(self, key: str, value: object, expected: str) -> None:
        given = repr(value)
        given = given if len(given) <= 60 else given[:57] + "..."
        self._warnings.append(
            f"the object '{self._name}' has the custom property {key} = {given}, which is ignored: expected {expected}"
        )


def _clamped(value: float | None, low: float, high: float) -> float | None:
    return None if value is None else min(max(float(value), low), high)


def resolve_auto(roots: Iterable[Node], *, role: Literal["environment", "component", "prop"]) -> None:
    """Give a physics type to the nodes of one file for which the file names none.

    Below a body that moves, they are its shapes if nothing else there is, otherwise decoration. Elsewhere, those of an
    environment stand still; a component or prop without any settings becomes one rigid body of all its meshes, one
    with some settings gets no more than these say.
    """
    roots = list(roots)
    nodes = [node for root in roots for node in root.walk()]
    settled = any(node.body.type is not PhysicsType.AUTO for node in nodes)
    if role != "environment" and not settled:
        for root in roots:
            root.body.type, root.body.compound = PhysicsType.RIGID_BODY, True
    for node in nodes:
        if node.body.moves:
            _complete(node)
    for node in nodes:
        if node.body.type is PhysicsType.AUTO:
            shaped = node.mesh is not None and (role == "environment" or node.body.bounds is not None)
            node.body.type = PhysicsType.STATIC if shaped else PhysicsType.NO_COLLISION


def _complete(body: Node) -> None:
    """Settle the undecided nodes below a moving one."""
    parts = list(_parts(body))
    undecided = [node for node in parts if node.mesh is not None and node.body.type is PhysicsType.AUTO]
    outlined = [node for node in undecided if node.body.bounds is not None]
    own = body.mesh is not None and body.shapes is None
    decided = any(node.body.collides and node.mesh is not None for node in parts)
    chosen = outlined if outlined or decided or (own and not body.body.compound) else undecided
    for node in parts:
        if node.body.type is PhysicsType.AUTO:
            node.body.type = PhysicsType.RIGID_BODY if node in chosen else PhysicsType.NO_COLLISION


def _parts(body: Node) -> Iterator[Node]:
    """The nodes below a body."""
    walk = body.walk()
    next(walk)
    return walk


def gather_under_root(library: Library) -> Node:
    """The one node that stands for a robot, sensor or actuator whose file may hold several loose objects.

    The root is the object named like the file, else the first one that has children, physics or no mesh, else the
    first mesh. All other objects become part of it where they are: eyes need no parent in the file to turn with the
    head. Lights, cameras and objects whose names begin with ``_`` are dropped.

    Raises:
        AssetError: the file holds no object that could be a component.
    """
    placed = [root for root in library.roots if root.name not in library.outside_scene]
    loose = [part for root in placed or library.roots for part in _without_lights(root)]
    if not loose:
        raise AssetError(library.path, "it holds no object that can be a component: add a mesh or an empty")
    root = _choose(loose, Path(library.path).stem)
    for part in loose:
        if part is not root:
            attach_in_place(root, part)
    library.roots = [root]
    return root


def _without_lights(root: Node) -> list[Node]:
    """A tree without lights, cameras and private objects, as the trees it falls into."""
    if _is_private(root):
        return []
    for node in list(root.walk()):
        if node is root or node.parent is None:
            continue
        if _is_private(node):
            node.detach()
        elif _is_light(node):
            for child in list(node.children):
                attach_in_place(node.parent, child)
            node.detach()
    if not _is_light(root):
        return [root]
    freed = list(root.children)
    for child in freed:
        set_free(child)
    return [tree for child in freed for tree in _without_lights(child)]


def _is_private(node: Node) -> bool:
    return (node.source_name or node.name).startswith("_")


def _is_light(node: Node) -> bool:
    return node.kind in (NodeKind.LIGHT, NodeKind.CAMERA)


def _choose(loose: list[Node], stem: str) -> Node:
    for node in loose:
        if (node.source_name or node.name).casefold() == stem.casefold():
            return node
    for node in loose:
        settled = node.body.type not in (PhysicsType.AUTO, PhysicsType.NO_COLLISION)
        if node.children or settled or node.kind is NodeKind.EMPTY:
            return node
    return next((node for node in loose if node.mesh is not None), loose[0])
