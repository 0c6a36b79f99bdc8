"""The base class of modifiers."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.core.object import Object

logger = logging.getLogger("morse." + __name__)


class AbstractModifier(ABC):
    """Changes the data of a component: after a measurement, or when a command arrives.

    Attributes:
        component_instance: the component.
        kwargs: the options that the scene script gave to ``alter``.
    """

    def __init__(self, component_instance: Object, kwargs: dict[str, Any]) -> None:
        self.component_instance = component_instance
        self.kwargs = kwargs
        self._complaints: set[str] = set()

    @property
    def data(self) -> dict[str, Any]:
        """The data of the component."""
        return self.component_instance.local_data

    def parameter(self, arg: str, prop: str | None = None, default: Any = None) -> Any:
        """An option of the script, else a property of the environment, else the default."""
        if arg in self.kwargs:
            return self.kwargs[arg]
        environment = self.component_instance.context.scene.properties
        if prop is not None and prop in environment:
            return environment[prop]
        return default

    def key_error(self, detail: object) -> None:
        """Say, once, that the component has no field that this modifier changes."""
        complaint = str(detail)
        if complaint not in self._complaints:
            self._complaints.add(complaint)
            fields = ", ".join(self.data)
            logger.warning(
                "%s has no field %s for %s to change; it has %s",
                self.component_instance.name(),
                complaint,
                type(self).__name__,
                fields,
            )

    def initialize(self) -> None:
        """Called once before the first tick."""

    def finalize(self) -> None:
        """Called once after the last tick."""

    @abstractmethod
    def modify(self) -> None:
        """Change ``self.data`` in place."""
