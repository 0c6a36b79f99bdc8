"""Methods that components had in earlier versions, up to MORSE 1.4."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

from morse.builder.legacy.notices import notice

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


def _configure_mw(
    component: Any, datastream: str, method: Any = None, path: str | None = None, *_: object, **options: Any
) -> None:
    if isinstance(method, (list, tuple)):
        # the class of the manager, a method and its file
        method, path = [*method, None, None][1:3]
    component.add_stream(datastream, method, path, **options)


def _nothing(_component: object, *_args: object, **_kwargs: object) -> None:
    pass


#: old name, how to write it today, and what it does
OLD_METHODS: Mapping[str, tuple[str, Callable[..., object]]] = {
    "configure_mw": ("add_stream", _configure_mw),
    "configure_middleware": ("add_stream", _configure_mw),
    "configure_service": ("add_service", lambda component, *a, **k: component.add_service(*a, **k)),
    "configure_modifier": ("alter", lambda component, name, config=None: component.alter(name, **(config or {}))),
    "configure_overlay": ("add_overlay", lambda component, *a, **k: component.add_overlay(*a, **k)),
}

#: methods of the `Human` of earlier versions, which had a keyboard and a camera of its own
OLD_METHODS_OF_HUMAN = ("disable_keyboard_control", "use_world_camera")


def old_method(component: object, name: str) -> Callable[..., object] | None:
    """The method of that name, which logs its new name; None if there was none."""
    if name in OLD_METHODS_OF_HUMAN and hasattr(component, "skeleton"):
        notice(f"{name} has no effect: a Human has neither a keyboard nor a camera unless the script appends one")
        return functools.partial(_nothing, component)
    if name not in OLD_METHODS:
        return None
    replacement, function = OLD_METHODS[name]
    notice(f"{name} is an old name, write {replacement}", name, replacement)
    return functools.partial(function, component)
