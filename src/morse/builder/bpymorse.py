"""Functions on the objects of the scene, under the names of MORSE 1.4.

They do not use Blender: objects are `morse.builder.objects.SceneObject`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.assets.search import worlds_with
from morse.builder import workspace
from morse.builder.blender.game import checked_property
from morse.builder.blender.materials import ObjectMaterial, material_slots
from morse.builder.blender.named import NamedList
from morse.builder.blender.objects import SceneObject
from morse.builder.errors import checks
from morse.builder.legacy.notices import notice
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.values import Properties

__all__ = [
    "delete",
    "fullscreen",
    "get_context_object",
    "get_material",
    "get_object",
    "get_objects",
    "get_properties",
    "properties",
    "select_only",
    "set_speed",
    "set_viewport",
]


def __getattr__(name: str) -> Any:
    """Functions of 1.4 that only pass a call on to Blender."""
    if not name.startswith("_"):
        from morse.builder.legacy.bpy import wrappers

        if name in wrappers.NAMES:
            return wrappers.wrapper(name)
    near = checks.closest(name, __all__)
    hint = f"; did you mean '{near}'?" if near else ""
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'{hint}", name=name)


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


def get_material(name: str) -> ObjectMaterial:
    """Return the material of that name from the first object that uses it.

    Raises:
        MorseBuilderNoComponentError: there is no such material.
    """
    names = set()
    for node in workspace.current().nodes():
        for index, material in enumerate(material_slots(node)):
            if material is not None:
                if material.name == name:
                    return ObjectMaterial(node, index)
                names.add(material.name)
    raise MorseBuilderNoComponentError(f"there is no material '{name}'{checks.suggestion(name, names)}")


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

    A robot or an object of the script goes with everything on it.

    Raises:
        MorseBuilderNoComponentError: there is no object of such a name.
        MorseBuilderError: it is the body of a component on a robot.
    """
    scene = workspace.current()
    items = [objects] if isinstance(objects, (SceneObject, str)) else list(objects)
    bodies = {c.scene_node: c for c in scene.components}
    nodes = [
        (get_object(item) if isinstance(item, str) else _object(item, "bpymorse.delete(objects)")).node
        for item in items
    ]
    for node in nodes:
        part = bodies.get(node)
        if part is not None and node.parent is not None and not any(above in nodes for above in node.ancestors()):
            raise MorseBuilderError(f"'{node.name}' is the body of a {type(part).__name__}: it cannot be deleted")
    for node in nodes:
        if scene.find(node.name) is not node:
            continue  # gone with a robot
        part = bodies.get(node)
        if part is None:
            scene.delete(node)
            continue
        below = list(node.walk())
        scene.components[:] = [one for one in scene.components if one.scene_node not in below]
        for one in reversed(below):
            scene.delete(one)


def set_speed(fps: int = 0, logic_step_max: int = 0, physics_step_max: int = 0) -> None:
    """Set the frequency of the simulation: old name of ``env.simulator_frequency``, also valid before it exists."""
    notice("bpymorse.set_speed is an old name, write env.simulator_frequency")
    set_frequency(fps or 60, logic_step_max or 20, physics_step_max or 20)


def set_frequency(frequency: float, logic_step_max: int = 20, physics_step_max: int = 20) -> None:
    """Set the frequency of the simulation, Hz, whether the environment exists already or not."""
    scene = workspace.current()
    if scene.environment is None:
        scene.speed = (frequency, logic_step_max, physics_step_max)
    else:
        _environment("set_speed").simulator_frequency(frequency, logic_step_max, physics_step_max)


def fullscreen(fullscreen: bool = True) -> None:
    """Use the full screen for the view (``env.fullscreen``)."""
    _environment("fullscreen").fullscreen(fullscreen)


def set_viewport(viewport_shade: str = "WIREFRAME", clip_end: float = 1000.0) -> None:
    """Set the rendering mode (``env.set_viewport``)."""
    _environment("set_viewport").set_viewport(viewport_shade, clip_end)


def _environment(function: str) -> Any:
    environment = workspace.current().environment
    if environment is None:
        raise MorseBuilderError(
            f"bpymorse.{function} has to be called after the Environment is created: write env.{function}(...)"
        )
    return environment


def _object(obj: object, what: str) -> SceneObject:
    if not isinstance(obj, SceneObject):
        raise TypeError(f"{what} takes an object of the scene such as robot._bpy_object, got {checks.shown(obj)}")
    return obj
