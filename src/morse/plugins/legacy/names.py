"""Methods of components, attributes of objects and functions of ``bpymorse`` that only scripts of MORSE 1.4 use."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

from morse.builder import bpymorse as bpymorse_of_today
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.objects import SceneObject
from morse.builder.workspace import notice
from morse.plugins.legacy import bpymorse
from morse.plugins.legacy.blender import Ignored
from morse.plugins.legacy.object_data import NO_EFFECT_ON_OBJECTS, ObjectNames

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping


def _configure_mw(
    component: Any, datastream: str, method: object = None, path: str | None = None, *_: object, **options: object
) -> None:
    if isinstance(method, (list, tuple)):
        # the class of the manager, a method and its file
        method, path = [*method, None, None][1:3]
    component.add_stream(datastream, method, path, **options)


def _configure_modifier(component: Any, modifier: str, config: object = None, **options: object) -> None:
    # the class of the modifier, a method and its file in the first versions
    known = config if isinstance(config, dict) else {}
    component.alter(modifier, **{**known, **options})


def _nothing(_owner: object, *_args: object, **_kwargs: object) -> None:
    pass


#: old name of a method of components, how to write it today, and what it does
_OF_COMPONENTS: Mapping[str, tuple[str, Callable[..., object]]] = {
    "configure_mw": ("add_stream", _configure_mw),
    "configure_middleware": ("add_stream", _configure_mw),
    "configure_service": ("add_service", lambda component, *a, **k: component.add_service(*a, **k)),
    "configure_modifier": ("alter", _configure_modifier),
    "configure_overlay": ("add_overlay", lambda component, *a, **k: component.add_overlay(*a, **k)),
}

#: methods of the `Human` of earlier versions, which had a keyboard and a camera of its own
_OF_HUMANS = ("disable_keyboard_control", "use_world_camera")


def attributes(owner: object) -> Iterable[str]:
    """The names that an object, or a module, has for old scripts."""
    if owner is bpymorse_of_today:
        return bpymorse.PUBLIC
    return [name for name in vars(ObjectNames) if not name.startswith("_")] if isinstance(owner, SceneObject) else ()


def attribute(owner: object, name: str) -> Callable[[], object] | None:
    """A function that returns an attribute; None if it never existed."""
    match owner:
        case AbstractComponent():
            return _of_component(owner, name)
        case SceneObject() if name in vars(ObjectNames):
            return lambda: getattr(ObjectNames(owner.node), name)
        case SceneObject() if name in NO_EFFECT_ON_OBJECTS:
            return lambda: Ignored(f"object.{name}")
        case _ if owner is bpymorse_of_today and name in bpymorse.NAMES:
            return lambda: bpymorse.wrapper(name)
    return None


def _of_component(component: AbstractComponent, name: str) -> Callable[[], object] | None:
    if name in _OF_HUMANS and hasattr(component, "skeleton"):
        notice(f"{name} has no effect: a Human has neither a keyboard nor a camera unless the script appends one")
        return lambda: functools.partial(_nothing, component)
    if name not in _OF_COMPONENTS:
        return None
    replacement, function = _OF_COMPONENTS[name]
    notice(f"{name} is an old name, write {replacement}", name, replacement)
    return lambda: functools.partial(function, component)


def set_attribute(owner: object, name: str, value: object) -> bool:
    """Set an attribute of an object; False if it never existed."""
    if not isinstance(owner, SceneObject):
        return False
    if name in NO_EFFECT_ON_OBJECTS:
        notice(f"object.{name} has no effect")
        return True
    place = vars(ObjectNames).get(name)
    if not isinstance(place, property) or place.fset is None:
        return False
    place.fset(ObjectNames(owner.node), value)
    return True
