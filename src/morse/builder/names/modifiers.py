"""Modifiers by the names that scene scripts use.

The body of a modifier class contains its names and the components for which it is suitable, as tuples of strings::

    class CoordinatesToNED(AbstractModifier):
        _names = ("NED",)
        _components = ("Pose", "GPS")
"""

from __future__ import annotations

from morse.builder.errors import checks
from morse.builder.names import catalog
from morse.core.exceptions import MorseBuilderError


def find_modifier(name: str, component: type | None) -> str:
    """The class path of the modifier of that name for a component.

    Raises:
        MorseBuilderError: there is no such modifier; the message lists the existing ones.
    """
    bases = {base.__name__ for base in component.__mro__} if component is not None else set()
    suitable: dict[str, str] = {}
    everywhere: set[str] = set()
    for entry in catalog.modifiers():
        names = entry.attributes["_names"]
        everywhere.update(names)
        if bases & set(entry.attributes.get("_components", ())):
            suitable.update(dict.fromkeys(names, entry.classpath))
    if name in suitable:
        return suitable[name]
    what = component.__name__ if component is not None else "an object without behaviour"
    choices = f"; there are {', '.join(sorted(suitable))}" if suitable else f"; there are none for {what}"
    hint = checks.suggestion(name, suitable) or choices
    if name in everywhere:
        raise MorseBuilderError(f"the modifier '{name}' is not for {what}{hint}")
    raise MorseBuilderError(f"there is no modifier '{name}' for {what}{hint}")


def modifier_classes() -> dict[str, dict[str, str]]:
    """The class paths of all modifiers, by name and by the name of the component class."""
    classes: dict[str, dict[str, str]] = {}
    for entry in catalog.modifiers():
        for name in entry.attributes["_names"]:
            classes.setdefault(name, {}).update(dict.fromkeys(entry.attributes.get("_components", ()), entry.classpath))
    return classes
