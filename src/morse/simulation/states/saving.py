"""Collects the states of all parts of a simulation, and restores them."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from morse.core.context import acting
from morse.core.datastream import DatastreamManager
from morse.core.modifier import AbstractModifier
from morse.core.object import Object
from morse.core.overlay import MorseOverlay
from morse.core.reports.faults import ENDINGS, describe
from morse.core.state import NoReferences, Reader, StateError, Writer
from morse.core.state.kinds import is_of_morse
from morse.simulation.states.own_state import ClockState, ControlsState, InputsState, check_population
from morse.simulation.states.state import State
from morse.simulation.states.state_parts import StateParts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.values import StateData
    from morse.core.world import World
    from morse.simulation.running import Holder, Running

logger = logging.getLogger(__name__)

#: the parts of a state that do not refer to components, in their order
_ARRANGEMENT = ("clock", "controls", "population", "physics")


class Saving:
    """Saves and restores one simulation."""

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation
        self._parts = StateParts(simulation)
        self._warnings: set[str] = set()
        #: states of this simulation that need no check, while the world has the arrangement of that number
        self._valid: WeakKeyDictionary[State, int] = WeakKeyDictionary()
        #: their physics, as the world has validated it, and the objects in it
        self._physics: WeakKeyDictionary[State, tuple[object, list[object]]] = WeakKeyDictionary()

    def save(self, *, tell: bool = True) -> State:
        """Return the present state.

        Args:
            tell: whether to log values that cannot be saved.

        Raises:
            StateError: ``get_state`` of a component of the user failed.
        """
        self._parts.look_up()
        writer = Writer(self._parts)
        parts = {name: writer.part(name, _state_of(name, holder)) for name, holder in self._holders()}
        writer.release()
        for path in writer.unsaved:
            if tell and path not in self._warnings:
                self._warnings.add(path)
                logger.warning("%s cannot be saved: it does not change when a state is restored", path)
        states = {name: one.get_state() for name, one in self._managers()}
        middlewares = {name: state for name, state in states.items() if state is not None}
        state = State(parts, tuple(writer.unsaved), self._simulation.population.makers(), middlewares)
        self._valid[state] = self._simulation.world.arrangement
        return state

    def restore(self, state: State, begin: Callable[[], object]) -> None:
        """Restore a state.

        Args:
            begin: callback, called after the state was validated; only the population may have changed before.

        Raises:
            StateError: the state is damaged, or belongs to another scene; the simulation is then unchanged.
        """
        # the attributes of users' classes may have changed their kinds since this simulation wrote the state
        is_own = self._valid.get(state) == self._simulation.world.arrangement
        if is_own and self._is_of_morse():
            begin()
            self._apply(state, trusted=True, valid=True)
            return
        population = self._simulation.population
        before, were = self.save(), population.get_state()
        there = self._read_population(state)
        try:
            if there != were:
                population.set_state(there, state.makers)
            self._check(state, trusted=is_own)
            begin()
            self._apply(state, trusted=is_own)
            self._valid[state] = self._simulation.world.arrangement
        except Exception as error:
            population.set_state(were, before.makers)
            self._apply(before, trusted=True)
            raise _refusal(error) from error

    def _is_of_morse(self) -> bool:
        """Whether no class of a user has a state, which may refuse what it has returned itself."""
        holders = (_with_attributes(holder) for _, holder in self._holders())
        return all(is_of_morse(type(holder)) for holder in holders if holder is not None)

    def arrange(self, state: State, *, described: bool) -> None:
        """Restore who is there and where, to show a recorded run; the components keep their states.

        Args:
            described: whether only the functions of the state create objects: a kind in a file may name any model.

        Raises:
            StateError: the state is damaged, or an object cannot be created again.
        """
        reader = Reader(NoReferences(), fresh=True)
        parts = {name: reader.part(name, state.parts.get(name), None) for name in _ARRANGEMENT}
        there = check_population(parts["population"])
        if described:
            there["came"] = [[name, "", *pose] for name, _, *pose in there["came"] if name in state.makers]
        self._simulation.population.set_state(there, state.makers)
        world = self._simulation.world
        _check_physics(world, parts["physics"])
        world.set_state(parts["physics"])
        clock = ClockState(self._simulation)
        clock.check(parts["clock"])
        clock.set_state(parts["clock"])

    def _read_population(self, state: State) -> StateData:
        """Return the state of the population, after a first check that the state belongs to this scene."""
        check = Reader(self._parts, fresh=True)
        if "population" not in state.parts:
            raise StateError("the saved state is damaged: it does not contain the population")
        there = check_population(check.part("population", state.parts["population"], {}))
        population = self._simulation.population
        everybody, launch = population.names_at_launch([]), population.names_at_launch(there["gone"])
        fits = set(there["gone"]) <= set(population.roots_at_launch())
        # an object that was spawned after the deletion of another one may have its name, and names of its parts
        came, stayed = {name for name, *_ in there["came"]}, set(launch)
        of_launch = [name for name in everybody if name in stayed or name.partition(".")[0] not in came]
        if not fits or [name for name in of_launch if name in state.parts] != launch:
            self._compare(state, dict.fromkeys([*launch, *(name for name, _ in self._own_holders())]))
            raise StateError(
                "the state belongs to another scene: it contains deleted objects that this scene never had"
            )
        return there

    def _check(self, state: State, *, trusted: bool) -> None:
        """Raise `StateError` if the state does not match the simulation."""
        holders = dict(self._holders())
        self._parts.look_up()
        self._compare(state, holders)
        check = Reader(self._parts, fresh=True, trusted=trusted)
        for name, holder in holders.items():
            read = check.part(name, state.parts[name], _state_of(name, holder), _with_attributes(holder))
            if isinstance(holder, (ClockState, ControlsState, InputsState)):
                holder.check(read)
            elif holder is self._simulation.world:
                _check_physics(holder, read)

    def _compare(self, state: State, holders: StateData) -> None:
        lacking = [name for name in holders if name not in state.parts]
        alien = [name for name in state.parts if name not in holders]
        if lacking or alien:
            text = "".join(
                f"; {what}: {', '.join(f'{name:.80}' for name in names[:5])}{', ...' if len(names) > 5 else ''}"
                for what, names in (("it lacks", lacking), ("it has", alien))
                if names
            )
            raise StateError(f"the state belongs to another scene{text}")

    def _managers(self) -> Iterator[tuple[str, DatastreamManager]]:
        """Iterate over the stream managers that may have a state, by name."""
        for name, manager in self._simulation.context.stream_managers.items():
            if isinstance(manager, DatastreamManager):
                yield name, manager

    def _apply(self, state: State, *, trusted: bool = False, valid: bool = False) -> None:
        # a state of a run without the middleware leaves it as it is
        for name, manager in self._managers():
            if name in state.middlewares:
                manager.set_state(state.middlewares[name])
        holders = dict(self._holders())
        self._parts.look_up()
        reader = Reader(self._parts, trusted=trusted)
        with acting(self._simulation.context):
            for name, holder in holders.items():
                is_kept = valid and holder is self._simulation.world
                if is_kept and state in self._physics:
                    read, objects = self._physics[state]
                    reader.leave_out(objects)
                else:
                    first = len(reader.objects())
                    read = reader.part(name, state.parts[name], _state_of(name, holder), _with_attributes(holder))
                    if is_kept:
                        read = holder.validated(read)
                        self._physics[state] = read, reader.objects(first)
                try:
                    holder.set_state(read)
                except StateError as error:
                    raise StateError(f"{name}: {error}") from None
                except ENDINGS:
                    raise
                except BaseException as error:
                    raise StateError(f"{name}: {describe(error)}") from error

    def _own_holders(self) -> Iterator[tuple[str, Any]]:
        simulation = self._simulation
        yield "clock", ClockState(simulation)
        yield "controls", ControlsState(simulation)
        yield "population", simulation.population
        yield "physics", simulation.world
        for obj in simulation.context.service_objects:
            if obj.get_state() is not None:
                yield f"{type(obj).__name__} of {obj.name()}", obj

    def _holders(self) -> Iterator[tuple[str, Any]]:
        """Iterate over all objects with a state by name; physics comes first, because components refer to it."""
        simulation = self._simulation
        context = simulation.context
        yield from self._own_holders()
        for name in [declaration.name for declaration in simulation.scene.components]:
            component = context.component(name)
            if component is None:
                continue
            yield name, component
            for number, modifier in enumerate([*component.input_modifiers, *component.output_modifiers]):
                yield f"{name}, modifier {number}", modifier
        for name, overlay in context.overlays.items():
            yield f"overlay {name}", overlay
        yield "inputs", InputsState(simulation)


def _state_of(name: str, holder: Holder) -> object:
    try:
        return holder.get_state()
    except ENDINGS:
        raise
    except BaseException as error:  # of a component of the user
        raise StateError(f"{name} cannot be saved: {describe(error)}") from error


def _with_attributes(holder: object) -> object:
    """The holder, if its state consists of its attributes; None if MORSE itself writes it as data."""
    return holder if isinstance(holder, (Object, AbstractModifier, MorseOverlay)) else None


def _check_physics(world: World, state: object) -> None:
    try:
        world.check_state(state)
    except ValueError as error:
        raise StateError(f"physics: {error}") from None


def _refusal(error: Exception) -> StateError:
    if isinstance(error, StateError):
        return error
    return StateError(f"the state cannot be restored: {describe(error)}")
