"""The state of the simulation itself: clock, controls, pending commands, spawned and deleted objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec

from morse.core.actuator import Actuator
from morse.core.context import Controls
from morse.core.state import StateError
from morse.core.streams.pending_commands import PendingCommands
from morse.core.validation.commands import Commands
from morse.core.validation.errors import CommandError

if TYPE_CHECKING:
    from morse.core.values import StateData
    from morse.simulation.running import Running

#: largest tick whose time is exact
_LAST_TICK = 2**53


class _Clock(msgspec.Struct, forbid_unknown_fields=True):
    tick: int
    seed: Any
    origin: float = 0.0
    robots: dict[str, int] = {}


class _Controls(msgspec.Struct, forbid_unknown_fields=True):
    keys: list[str]
    axes: list[float]
    robot: str | None


class _Population(msgspec.Struct, forbid_unknown_fields=True):
    came: list[tuple[str, str, list[float], list[float]]]
    gone: list[str]


def _converted(name: str, state: object, kind: type) -> Any:
    try:
        return msgspec.convert(state, kind)
    except msgspec.ValidationError as error:
        raise StateError(f"{name}: the saved state is damaged: {error}") from None


def check_population(state: Any) -> StateData:
    """Return the validated state of a population; raise `StateError` if it is not valid."""
    _converted("population", state, _Population)
    population: StateData = state
    if any(len(place) != 3 or len(turn) != 3 for _, _, place, turn in population["came"]):
        raise StateError("population: the saved state is damaged: a position and a rotation have 3 numbers")
    return population


class ClockState:
    """Tick, seeds, and the time of tick 0."""

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation

    def get_state(self) -> StateData:
        """Number of ticks, the seed of all random numbers, and what is not usual: time of tick 0, seeds of robots."""
        clock, context = self._simulation.clock, self._simulation.context
        state: StateData = {"tick": clock.tick, "seed": context.seed}
        if clock.origin:
            state["origin"] = clock.origin
        if context.robot_seeds:
            state["robots"] = dict(context.robot_seeds)
        return state

    def check(self, state: object) -> None:
        """Raise `StateError` if the state is not the state of a clock."""
        values: _Clock = _converted("clock", state, _Clock)
        if not 0 <= values.tick <= _LAST_TICK or type(values.seed) is not int:
            raise StateError("clock: the saved state is damaged: it has no tick, or no seed")
        if not 0.0 <= values.origin <= _LAST_TICK:
            raise StateError("clock: the saved state is damaged: the time of its start is not a time")

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        self._simulation.clock.go_to(state["tick"], state.get("origin", 0.0))
        self._simulation.context.seed = state["seed"]
        self._simulation.context.robot_seeds = dict(state.get("robots", {}))


class ControlsState:
    """Keyboard and gamepad input at the live view."""

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation

    def get_state(self) -> StateData:
        """Keys, axes and the selected robot."""
        keys, axes, robot = self._simulation.context.controls
        return {"keys": sorted(keys), "axes": list(axes), "robot": robot}

    def check(self, state: object) -> None:
        """Raise `StateError` if the state is not a state of controls."""
        _converted("controls", state, _Controls)

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        controls = Controls(frozenset(state["keys"]), tuple(state["axes"]), state["robot"])
        self._simulation.context.controls = controls


class InputsState:
    """Commands that the actuators have not applied yet."""

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation

    def get_state(self) -> dict[str, StateData]:
        """Return the pending fields by name of the actuator."""
        values = {}
        for actuator in self._simulation.loaded.actuators:
            fields: StateData = {}
            for pending in PendingCommands.all_of(actuator):
                fields |= pending.waiting
            if fields:
                values[actuator.name()] = fields
        return values

    def check(self, state: object) -> None:
        """Raise `StateError` if the state does not contain commands."""
        values = _converted("inputs", state, dict[str, dict[str, Any]])
        actuators = {actuator.name(): actuator for actuator in self._simulation.loaded.actuators}
        for name, fields in values.items():
            if name not in actuators:
                raise StateError(f"inputs: there is no actuator {name!r:.80}")
            try:
                Commands(actuators[name]).fitting(fields)
            except CommandError as error:
                raise StateError(f"inputs: {name}: {error}") from None

    def set_state(self, state: dict[str, StateData]) -> None:
        """Restore a state that `get_state` returned."""
        for actuator in self._simulation.loaded.actuators:
            pending = PendingCommands.all_of(actuator)
            for each in pending:
                each.forget()
            if actuator.name() in state and isinstance(actuator, Actuator):
                (pending[0] if pending else PendingCommands(actuator)).give(state[actuator.name()])
