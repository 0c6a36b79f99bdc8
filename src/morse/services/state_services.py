"""Services that save and restore the state of the simulation; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest
from morse.core.services import service
from morse.core.validation.names import check_stored_name
from morse.services.recording_services import check_room, file_of

if TYPE_CHECKING:
    from pathlib import Path

_MOST = 32
_S = TypeVar("_S")
_SUFFIX = ".morse-state"


class Saveable(Protocol[_S]):
    """The part of a simulation that the services need."""

    def save(self, path: Path | None = None) -> _S:
        """Return the present state."""

    def restore(self, state: _S | Path) -> None:
        """Restore a state."""


class StateServices(AbstractObject, Generic[_S]):
    """Stores states by name, in memory or in files in the directory in which the simulation was started."""

    def __init__(self, simulation: Saveable[_S]) -> None:
        super().__init__()
        self._simulation = simulation
        self._states: dict[str, _S] = {}

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def save(self, name: str = "state", to_file: bool = False) -> str:
        """Save the present state under a name; an earlier state of that name is replaced.

        Args:
            name: letters, digits, ``_``, ``-`` and dots.
            to_file: write the file ``<name>.morse-state`` into the directory in which the simulation was started.

        Returns:
            The name, or the path of the file.
        """
        check_stored_name(name, "state")
        if to_file:
            path = file_of(name + _SUFFIX)
            check_room(path)
            try:
                self._simulation.save(path)
            except OSError as error:
                raise MorseRPCInvokationError(f"the state cannot be written: {error}") from None
            return str(path)
        if name not in self._states and len(self._states) >= _MOST:
            raise MorseRPCInvokationError(f"{_MOST} states are already stored: use one of their names")
        self._states[name] = self._simulation.save()
        return name

    @service(changes=False)  # the simulation records the call itself
    def restore(self, name: str = "state", from_file: bool = False) -> None:
        """Restore a saved state; running services end as preempted."""
        check_stored_name(name, "state")
        if from_file:
            path = file_of(name + _SUFFIX)
            if not path.is_file():
                raise MorseRPCInvokationError(f"there is no file {path}")
            self._simulation.restore(path)
        elif name in self._states:
            self._simulation.restore(self._states[name])
        else:
            raise MorseRPCInvokationError(f"there is no state '{name}'{nearest(name, list(self._states))}")
