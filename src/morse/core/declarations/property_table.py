"""The properties of the components of a simulation by name: ``robot.motion.ControlType``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from morse.core.declarations.merged import properties

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.declarations.fields import Property


class PropertyOf(NamedTuple):
    """A property of one component.

    Attributes:
        attribute: name of the attribute of the component that holds the value.
    """

    component: object
    attribute: str
    declaration: Property


class PropertyTable:
    """Finds the properties of components.

    Args:
        component: returns the component of a name; None if there is none.
        components: returns the names of the components whose properties are in the table.
    """

    def __init__(self, component: Callable[[str], object | None], components: Callable[[], Iterable[str]]) -> None:
        self._component, self._components = component, components

    def names(self) -> list[str]:
        """The names of all properties, component by component."""
        names: list[str] = []
        for name in self._components():
            component = self._component(name)
            if component is not None:
                names += [f"{name}.{one.name}" for one in properties(type(component)).values()]
        return names

    def find(self, name: str) -> PropertyOf | None:
        """The property of a name; None if there is none."""
        owner, _, attribute = name.rpartition(".")
        component = self._component(owner)
        if component is None or owner not in self._components():
            return None
        pairs = properties(type(component)).items()
        return next((PropertyOf(component, own, one) for own, one in pairs if one.name == attribute), None)
