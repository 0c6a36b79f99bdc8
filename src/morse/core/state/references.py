"""Things that a state refers to by name: they are there before it is restored."""

from __future__ import annotations

from typing import Any, Protocol


class References(Protocol):
    """Knows the parts of a simulation, and what belongs to its project, by name."""

    def name_of(self, value: Any) -> str | None:
        """The name of a part of the simulation, such as ``component robot.pose``; None for anything else."""

    def find(self, name: str) -> Any:
        """The part of that name.

        Raises:
            StateError: there is none.
        """

    def find_class(self, path: str) -> type[Any] | None:
        """The class of that path (``module:name``), if it belongs to the simulation or the user's project."""

    def met_class(self, cls: type[Any]) -> None:
        """An object of that class is saved: this process may make such objects again."""

    def global_name(self, value: Any) -> str | None:
        """``module:NAME`` of an object or function that is a variable of the user's project; None for others."""

    def find_global(self, name: str) -> Any:
        """The object or function of that name.

        Raises:
            StateError: there is none.
        """
