"""Functions on the objects of the scene, under the name that scripts know: objects are `SceneObject`.

They do not use Blender.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from morse.assets.search import worlds_with
from morse.builder import compatibility, workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.errors import checks
from morse.builder.objects import NamedList, SceneObject, checked_property
from morse.core.exceptions import MorseBuilderNoComponentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.values import Properties

#: also of the functions that plug-ins add for old scripts: see `__getattr__`
_NAMES = ("delete", "get_context_object", "get_object", "get_objects", "get_properties", "properties", "select_only")


def __getattr__(name: str) -> Any:
    module = sys.modules[__name__]
    if name == "__all__":
        return [*_NAMES, *(word for entry in compatibility.installed() for word in entry.attributes(module))]
    return checks.missing_attribute(module, name)


def get_object(name: str) -> SceneObject:
    """The object of that name.

    Raises:
        MorseBuilderNoComponentError: there is no such object.
    """
    node = workspace.current().find(checks.text(name, "bpymorse.get_object(name)"))
    if node is None:
        names = workspace.current().names()
        hint = checks.suggestion(name, names) + worlds_with(name)
        raise MorseBuilderNoComponentError(f"there is no object '{name}'{hint}")
    return SceneObject(node)


def get_objects() -> NamedList[SceneObject]:
    """Every object, by name or in order: parents before their children."""
    return NamedList([SceneObject(node) for node in workspace.current().nodes()], "object")


def properties(obj: SceneObject, **kwargs: object) -> None:
    """Set properties of an object."""
    node = _object(obj, "bpymorse.properties(obj, ...)").node
    for key, value in kwargs.items():
        node.properties[key] = checked_property(key, value)


def get_properties(obj: SceneObject) -> Properties:
    """The properties of an object by name."""
    return dict(_object(obj, "bpymorse.get_properties(obj)").node.properties)


def select_only(obj: SceneObject) -> None:
    """Select an object."""
    workspace.current().selected = _object(obj, "bpymorse.select_only(obj)").node


def get_context_object() -> SceneObject | None:
    """The selected object, or None."""
    selected = workspace.current().selected
    return None if selected is None else SceneObject(selected)


def delete(objects: SceneObject | str | Iterable[SceneObject | str]) -> None:
    """Remove objects, given as objects or by name, from the scene; their children are kept.

    A robot, a component or an object of the script goes with everything on it.

    Raises:
        MorseBuilderNoComponentError: there is no object of such a name.
    """
    scene = workspace.current()
    items = [objects] if isinstance(objects, (SceneObject, str)) else list(objects)
    bodies = {c.scene_node: c for c in scene.components}
    nodes = [
        (get_object(item) if isinstance(item, str) else _object(item, "bpymorse.delete(objects)")).node
        for item in items
    ]
    for node in nodes:
        if scene.find(node.name) is not node:
            continue  # gone with a robot
        part = bodies.get(node)
        if part is None:
            scene.delete(node)
            continue
        if isinstance(part, AbstractComponent) and part.parent is not None:
            part.parent.children.remove(part)
        below = list(node.walk())
        scene.components[:] = [one for one in scene.components if one.scene_node not in below]
        for one in reversed(below):
            scene.delete(one)


def _object(obj: object, what: str) -> SceneObject:
    if not isinstance(obj, SceneObject):
        raise TypeError(f"{what} takes an object of the scene such as robot._bpy_object, got {checks.shown(obj)}")
    return obj
