"""Objects that a state refers to by name: they exist before the state is restored."""

from __future__ import annotations

from typing import Protocol

from morse.core.state.errors import StateError


class References(Protocol):
    """Maps the parts of a simulation, and the classes and variables of its project, to names and back."""

    def name_of(self, value: object) -> str | None:
        """The name of a part of the simulation, such as ``component robot.pose``; None for other objects."""

    def find(self, name: str) -> object:
        """The part of that name.

        Raises:
            StateError: there is no such part.
        """

    def find_class(self, path: str) -> type | None:
        """The class of that path (``module:name``), if it belongs to the simulation or the user's project."""

    def met_class(self, cls: type) -> None:
        """Record that an object of that class was saved, so that this process may recreate such objects."""

    def global_name(self, value: object) -> str | None:
        """``module:NAME`` of an object or function that is a variable of the user's project; None for others."""

    def find_global(self, name: str) -> object:
        """The object or function of that name.

        Raises:
            StateError: there is no such object or function.
        """


class NoReferences:
    """References for data from outside, which do not refer to parts of the simulation, to classes or functions."""

    def name_of(self, value: object) -> str | None:
        """Nothing has a name."""
        return None

    def find(self, name: str) -> object:
        """Refuse the name."""
        raise StateError(f"data from outside cannot contain {name!r:.60}")

    def find_class(self, path: str) -> type | None:
        """There are no classes."""
        return None

    def met_class(self, cls: type) -> None:
        """Do nothing, because such data do not contain objects of classes."""

    def global_name(self, value: object) -> str | None:
        """Nothing has a name."""
        return None

    def find_global(self, name: str) -> object:
        """Refuse the name."""
        raise StateError(f"data from outside cannot contain {name!r:.60}")
