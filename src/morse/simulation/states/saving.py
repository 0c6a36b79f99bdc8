"""Collects the states of all parts of a simulation, and restores them."""

from __future__ import annotations

import inspect
import logging
import sys
from collections import Counter
from enum import Enum
from pathlib import Path
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any, Protocol, TypeGuard, TypeVar, cast
from weakref import WeakKeyDictionary

import msgspec
import numpy as np

from morse.core.actuator import Actuator, PendingCommands
from morse.core.context import Controls, acting
from morse.core.datastream import DatastreamManager
from morse.core.modifier import AbstractModifier
from morse.core.object import Object
from morse.core.overlay import MorseOverlay
from morse.core.reports.faults import ENDINGS, describe
from morse.core.rows.marks import is_overridden
from morse.core.state import NoReferences, Reader, StateError, Writer
from morse.core.state.attributes import declared, is_of_morse
from morse.core.validation.commands import Commands
from morse.core.validation.spec import CommandError
from morse.helpers.transformation import FollowingPose, Transformation3d
from morse.physics import GameObject
from morse.physics.model.motors import ARRAYS as MOTOR_ARRAYS
from morse.simulation.states.state import State

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from morse.core.values import StateData
    from morse.core.world import World
    from morse.simulation.population import PopulationState
    from morse.simulation.simulation import Simulation

_T = TypeVar("_T")


# Maps the parts of a simulation, and the variables of its project, to names in states and back.

_UNCHANGEABLE = (type(None), bool, int, float, complex, str, bytes)
_PLAIN = (*_UNCHANGEABLE, tuple, frozenset, ModuleType, Enum)


class StateParts:
    """See `morse.core.state.References`."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._classes: dict[str, type] = {}
        self._globals: dict[int, str] = {}
        self._by_name: StateData = {}

    def look_up(self) -> None:
        """Look up the present values of the variables of the project."""
        self._by_name = dict(self._variables())
        self._globals = {id(value): name for name, value in reversed(self._by_name.items())}

    # -- the simulation --------------------------------------------------------------------

    def _fixed(self) -> StateData:
        context = self._simulation.context
        return {
            "context": context,
            "clock": context.clock,
            "world": context.world,
            "scene": context.scene,
            "services": context.services,
        }

    def name_of(self, value: object) -> str | None:
        """Return the name of a part, or None."""
        if isinstance(value, GameObject):
            return f"object {value.name}"
        if isinstance(value, Object):
            return f"component {value.name()}"
        return next((name for name, part in self._fixed().items() if part is value), None)

    def find(self, name: str) -> object:
        """The part of that name."""
        kind, _, rest = name.partition(" ")
        context = self._simulation.context
        part: object = None
        if kind == "object":
            part = context.world.objects_by_name.get(rest)
        elif kind == "component":
            part = context.component(rest)
        else:
            part = self._fixed().get(name)
        if part is None:
            raise StateError(f"there is no {name!r:.80}")
        return part

    # -- the project -----------------------------------------------------------------------

    def met_class(self, cls: type) -> None:
        """Record a class whose objects are in the simulation."""
        self._classes[f"{cls.__module__}:{cls.__qualname__}"] = cls

    def global_name(self, value: object) -> str | None:
        """Return ``module:NAME``, or ``module:Class.NAME``, if the object is the value of a variable of the project."""
        return self._globals.get(id(value))

    def find_global(self, name: str) -> object:
        """Return the value of a variable of the project."""
        if name not in self._by_name:
            raise StateError(f"the project has no variable {name!r:.80}")
        return self._by_name[name]

    def find_class(self, path: str) -> type | None:
        """Return a class of MORSE, of the project, or of a module in the same directory as a component of the scene."""
        module_name, _, name = path.partition(":")
        cls: object = self._module(module_name)
        for word in name.split("."):
            cls = vars(cls).get(word) if isinstance(cls, (type, ModuleType)) else None
        # names that a module has imported from elsewhere are ignored
        if isinstance(cls, type) and (cls.__module__, cls.__qualname__) == (module_name, name):
            return cls
        return self._classes.get(path)

    def _module(self, name: str) -> ModuleType | None:
        own = getattr(self._simulation.scene.project, "module", lambda _name: None)(name)
        if isinstance(own, ModuleType):
            return own
        module = sys.modules.get(name)
        if name.startswith("morse.") or module is None:
            return module
        folder = _folder_of(module)
        return module if folder is not None and folder in {_folder_of(m) for m in self._component_modules()} else None

    def _component_modules(self) -> list[ModuleType]:
        """Return the modules of the components of the user."""
        context = self._simulation.context
        project = getattr(self._simulation.scene.project, "module", lambda _name: None)
        parts: list[object] = [*context.robots.values(), *context.components.values(), *context.overlays.values()]
        parts += self._simulation.loaded.modifier_objects
        names = {cls.__module__ for part in parts for cls in type(part).__mro__}
        users = sorted(name for name in names if not name.startswith("morse.") and name not in sys.stdlib_module_names)
        modules = [project(name) or sys.modules.get(name) for name in users]
        return [module for module in modules if module is not None]

    def _variables(self) -> Iterator[tuple[str, object]]:
        """Iterate over the objects and functions that are variables of modules and classes of the project."""
        own = list(getattr(self._simulation.scene.project, "own_modules", dict)().values())
        modules = {id(module): module for module in [*own, *self._component_modules()]}
        for module in modules.values():
            for name, value in list(vars(module).items()):
                if name.startswith("__") or isinstance(value, _PLAIN):
                    continue
                if isinstance(value, type):
                    if value.__module__ == module.__name__:
                        yield from _constants(value)
                elif isinstance(value, FunctionType):
                    if value.__module__ == module.__name__:
                        yield f"{module.__name__}:{name}", value
                elif not inspect.isroutine(value):
                    yield f"{module.__name__}:{name}", value


def _constants(cls: type) -> Iterator[tuple[str, object]]:
    for name, value in list(vars(cls).items()):
        if name.startswith("__") or isinstance(value, (*_PLAIN, type, property, staticmethod, classmethod)):
            continue
        if not inspect.isroutine(value) and not inspect.isdatadescriptor(value):
            yield f"{cls.__module__}:{cls.__qualname__}.{name}", value


def _folder_of(module: ModuleType) -> Path | None:
    file = getattr(module, "__file__", None)
    return Path(file).parent if isinstance(file, str) else None


# The state of the simulation itself: clock, controls, pending commands, spawned and deleted objects.

#: largest tick whose time is exact
_LAST_TICK = 2**53


class _Clock(msgspec.Struct, forbid_unknown_fields=True):
    tick: int
    seed: int
    origin: float = 0.0
    robots: dict[str, int] = {}


class _Controls(msgspec.Struct, forbid_unknown_fields=True):
    keys: list[str]
    axes: list[int | float]
    robot: str | None


class _Population(msgspec.Struct, forbid_unknown_fields=True):
    came: list[tuple[str, str, list[float], list[float]]]
    gone: list[str]


def _converted(name: str, state: object, kind: type[_T]) -> _T:
    try:
        return msgspec.convert(state, kind)
    except msgspec.ValidationError as error:
        raise StateError(f"{name}: the saved state is damaged: {error}") from None


def check_population(state: object) -> PopulationState:
    """Return the validated state of a population; raise `StateError` if it is not valid."""
    population = _converted("population", state, _Population)
    if any(len(place) != 3 or len(turn) != 3 for _, _, place, turn in population.came):
        raise StateError("population: the saved state is damaged: a position and a rotation have 3 numbers")
    return cast("PopulationState", state)


class ClockState:
    """Tick, seeds, and the time of tick 0."""

    def __init__(self, simulation: Simulation) -> None:
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
        values = _converted("clock", state, _Clock)
        if not 0 <= values.tick <= _LAST_TICK:
            raise StateError("clock: the saved state is damaged: it has no tick, or no seed")
        if not 0.0 <= values.origin <= _LAST_TICK:
            raise StateError("clock: the saved state is damaged: the time of its start is not a time")

    def set_state(self, state: object) -> None:
        """Restore a state that `get_state` returned."""
        values = _converted("clock", state, _Clock)
        self._simulation.clock.go_to(values.tick, values.origin)
        self._simulation.context.seed = values.seed
        self._simulation.context.robot_seeds = values.robots


class ControlsState:
    """Keyboard and gamepad input at the live view."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def get_state(self) -> StateData:
        """Keys, axes and the selected robot."""
        keys, axes, robot = self._simulation.context.controls
        return {"keys": sorted(keys), "axes": list(axes), "robot": robot}

    def check(self, state: object) -> None:
        """Raise `StateError` if the state is not a state of controls."""
        _converted("controls", state, _Controls)

    def set_state(self, state: object) -> None:
        """Restore a state that `get_state` returned."""
        values = _converted("controls", state, _Controls)
        self._simulation.context.controls = Controls(frozenset(values.keys), tuple(values.axes), values.robot)


class InputsState:
    """Commands that the actuators have not applied yet."""

    def __init__(self, simulation: Simulation) -> None:
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


logger = logging.getLogger(__name__)

#: the parts of a state that do not refer to components, in their order
_ARRANGEMENT = ("clock", "controls", "population", "physics")


class Saving:
    """Saves and restores one simulation."""

    def __init__(self, simulation: Simulation) -> None:
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

    def _read_population(self, state: State) -> PopulationState:
        """Return the state of the population, after a first check that the state belongs to this scene."""
        check = Reader(self._parts, fresh=True)
        if "population" not in state.parts:
            raise StateError("the saved state is damaged: it does not contain the population")
        there = check_population(check.part("population", state.parts["population"], {}))
        population = self._simulation.population
        everybody, launch = population.names_at_launch([]), population.names_at_launch(there["gone"])
        fits = set(there["gone"]) <= {*population.roots_at_launch(), *population.components_at_launch()}
        # an object that was spawned after the deletion of another one may have its name, and names of its parts
        came, stayed = {name for name, *_ in there["came"]}, set(launch)
        of_launch = [name for name in everybody if name in stayed or came.isdisjoint((name, name.partition(".")[0]))]
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


class LaunchStates:
    """The states of components just after they were created, with which a restart need not create them again.

    That holds for components of MORSE that have neither streams nor modifiers, and no random numbers, unless their
    class has a method `Object.begin_anew`.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._members: list[_AtLaunch] = []
        #: the world before the components were created; and whether components of this scene may be renewed at all
        self._world: StateData = {}
        self._is_possible = simulation.context.network is None

    def begin(self) -> None:
        """Take note of the world before components are created."""
        self._members = []
        if self._is_possible:
            self._world = _apart_from_components(self._simulation.world.get_state())

    def take(self) -> None:
        """Take the states of the components that were just created."""
        simulation, context = self._simulation, self._simulation.context
        there = self._everybody()
        self._is_possible &= all(map(_is_renewable, there)) and self._seeds_are_known()
        if (
            self._is_possible
            and not (context.external_robots or context.stream_managers or context.overlays)
            and _equal(self._world, _apart_from_components(simulation.world.get_state()))
        ):
            properties = self._declared()
            writer = Writer(StateParts(simulation))
            members = [_AtLaunch(one, dict(properties[one.name()]), writer) for one in there]
            writer.release()
            if not writer.unsaved and all(map(_is_plain, [v for one in members for v in one.written.values()])):
                self._members = members
                simulation.world.keep_motors()
        self._world = {}

    def may_renew(self) -> bool:
        """Whether `renew` is possible: nobody has changed the components but their states."""
        properties, there = self._declared(), self._everybody()
        return (
            bool(self._members)
            and self._seeds_are_known()
            and len(there) == len(self._members)
            and all(
                one is known.component and properties[one.name()] == known.properties and _is_renewable(one)
                for one, known in zip(there, self._members, strict=True)
            )
        )

    def renew(self) -> None:
        """Let the components be as they were created."""
        reader = Reader(StateParts(self._simulation), trusted=True)
        for member in self._members:
            member.renew(reader)

    def _seeds_are_known(self) -> bool:
        """Whether all random numbers are of components that begin anew with another seed."""
        able = [one for one in self._everybody() if type(one).begin_anew is not Object.begin_anew]
        prefixes = tuple(f"{one.name()}/" for one in able)
        return all(name.startswith(prefixes) for name in self._simulation.context.drawn)

    def _declared(self) -> dict[str, StateData]:
        """The properties of the objects of components, by name."""
        components = self._simulation.context.scene.components
        return {declaration.name: declaration.node.properties for declaration in components}

    def _everybody(self) -> list[Object]:
        context = self._simulation.context
        return [*cast("dict[str, Object]", context.robots).values(), *context.components.values()]


class _AtLaunch:
    """The state of a component as it was created.

    Args:
        properties: of the object that it was created from.
    """

    def __init__(self, component: Object, properties: StateData, writer: Writer) -> None:
        self.component, self.properties = component, properties
        state = component.get_state()
        #: what its class has written into the object of the scene
        body = component.bge_object
        self.written: StateData = {
            name: body[name]
            for name in cast("Iterable[str]", body)
            if name not in properties or body[name] != properties[name]
        }
        #: values that nobody can change; dictionaries and lists of these; poses; everything else, as saved
        self._plain = {name: value for name, value in state.items() if _is_plain(value)}
        uses = Counter(map(id, state.values()))
        self._tables = {name: dict(value) for name, value in state.items() if _is_table(value) and uses[id(value)] == 1}
        self._lists = {name: list(value) for name, value in state.items() if _is_list(value) and uses[id(value)] == 1}
        self._poses = {name: (value, *value.get_pose()) for name, value in state.items() if _is_pose(value)}
        simple = {*self._plain, *self._tables, *self._lists, *self._poses}
        rest = {name: state[name] for name in state if name not in simple}
        self._rest = writer.part(component.name(), rest) if rest else None
        cls: type = type(component)
        self._absent = (declared(cls) or frozenset()) - state.keys()

    def renew(self, reader: Reader) -> None:
        """Let the component have this state."""
        component = self.component
        for pending in PendingCommands.all_of(component):
            pending.forget()
        if component._in_rows is not None:
            component._in_rows.release()
        for name, value in self.written.items():
            component.bge_object[name] = value
        own = vars(component)
        rest = {} if self._rest is None else reader.part(component.name(), self._rest, own, component)
        for name in self._absent:
            own.pop(name, None)
        own.update(self._plain)
        own.update(rest)
        for name, table in self._tables.items():
            own[name] = dict(table)
        for name, values in self._lists.items():
            own[name] = list(values)
        for name, (pose, position, rotation) in self._poses.items():
            own[name] = pose if isinstance(pose, FollowingPose) else Transformation3d()
            own[name].set_pose(position, rotation)
        component.on_completion = None
        component.begin_anew()


def _apart_from_components(world: dict[str, Any]) -> StateData:
    """The state of a world without what components write when they are created: properties of objects, motors."""
    objects: dict[str, StateData] = {
        name: {key: value for key, value in entry.items() if key != "properties"}
        for name, entry in world["objects"].items()
    }
    model = {name: array for name, array in world["engine"]["model"].items() if name not in MOTOR_ARRAYS}
    return {
        **world,
        "objects": {name: entry for name, entry in objects.items() if entry},
        "engine": {**world["engine"], "model": model},
    }


def _equal(one: Any, other: Any) -> bool:
    """Whether two states are equal, which may contain arrays."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_equal(one[name], other[name]) for name in one)
    return bool(np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other)


def _is_plain(value: object) -> bool:
    if type(value) is tuple:
        return all(map(_is_plain, value))
    return type(value) in _UNCHANGEABLE or isinstance(value, Enum)


def _is_table(value: object) -> TypeGuard[dict[Any, Any]]:
    return type(value) is dict and all(map(_is_plain, value.values()))


def _is_pose(value: object) -> TypeGuard[Transformation3d]:
    return isinstance(value, Transformation3d)


def _is_list(value: object) -> TypeGuard[list[Any]]:
    return type(value) is list and all(map(_is_plain, value))


def _is_renewable(component: Object) -> bool:
    """Whether nothing of a component changes but its attributes that are its state."""
    cls = type(component)
    return (
        is_of_morse(cls)
        and not component.is_camera
        and cls.get_state is Object.get_state
        and cls.set_state is Object.set_state
        and not (component.output_functions or component.input_modifiers or component.output_modifiers)
        and len(PendingCommands.all_of(component)) == len(component.input_functions)
        and getattr(component, "realism", None) is None
        and not is_overridden(component)
    )


class Holder(Protocol):
    """An object with a state."""

    def get_state(self) -> object:
        """Return the state as plain data."""

    def set_state(self, state: Any) -> None:
        """Restore a state that `get_state` returned."""


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
