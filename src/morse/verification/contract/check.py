"""Checks components against all rules."""

from __future__ import annotations

import inspect
import json
import math
import sys
from itertools import chain
from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.datastream import DatastreamManager
from morse.core.declarations import data_fields, fields_of_component, levels, properties, says_nothing
from morse.core.declarations.refused import numbers_in, shape_of
from morse.core.exceptions import MorseError
from morse.core.mapping import maps
from morse.core.object import Object
from morse.core.reports.faults import describe
from morse.core.sensor import Sensor, misfits
from morse.core.services import declared_services, signature_of
from morse.core.state import StateError
from morse.core.units import unit
from morse.core.validation.spec import CommandError
from morse.middleware import registry
from morse.scene import StreamDeclaration
from morse.verification.contract.contract_world import BAD_VALUES, ContractWorld, LogCapture, set_up
from morse.verification.contract.subjects import Fault, Report, Subject, SubjectError, subjects
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Iterator

    from morse.core.context import Context
    from morse.core.declarations import DataField
    from morse.core.values import Options
    from morse.verification.contract.contract_world import Places


# Rules for the declarations of a class, checked without a simulation.

DOCUMENTED, DECLARED = "documented", "data are declared"

#: base units of quantities with a direction, which need a frame
_DIRECTED = {"m", "rad", "A"}
#: names of numbers that are parts of a vector
_AXES = ("x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "wx", "wy", "wz")
#: words for numbers that are counted, not measured
_COUNTED = ("int", "integer", "uint8", "buffer")


def documented(cls: type, places: Places) -> Iterator[Fault]:
    """The class, its data, properties, levels and services have descriptions."""
    where = places.of_class(cls)
    if not (inspect.cleandoc(cls.__doc__ or "") or vars(cls).get("_short_desc")):
        yield Fault(DOCUMENTED, "the class has neither a docstring nor _short_desc: say in one what it does", where)
    for name, field in data_fields(cls).items():
        if not field.doc.strip():
            yield Fault(DOCUMENTED, f"the data field '{name}' has no description", places.of(cls, "add_data", name))
    for python_name, prop in properties(cls).items():
        if not prop.doc.strip():
            place = places.of(cls, "add_property", python_name)
            yield Fault(DOCUMENTED, f"the property '{prop.name}' has no description", place)
    for name, level in levels(cls).items():
        if not level.doc.strip():
            yield Fault(DOCUMENTED, f"the level '{name}' has no description", places.of(cls, "add_level", name))
    for declaration in declared_services(cls):
        if not inspect.getdoc(getattr(cls, declaration.attribute)):
            place = places.of(cls, "def", declaration.attribute)
            yield Fault(DOCUMENTED, f"the service '{declaration.name}' has no docstring", place)


def declared(cls: type, places: Places) -> Iterator[Fault]:
    """Numbers have a unit, directions a frame, lists of numbers a shape."""
    for name, field in data_fields(cls).items():
        for text in _missing(name, field):
            yield Fault(DECLARED, text, places.of(cls, "add_data", name))


def _missing(name: str, field: DataField) -> Iterator[str]:
    if not _is_measured(field):
        return
    is_sequence = hasattr(field.default, "__len__") and not isinstance(field.default, str)
    if is_sequence and field.shape is None:
        shape = shape_of(field.default) or (None,)
        yield f"the data field '{name}' is a list of numbers without a shape: add shape={shape} (None for any length)"
    if not field.unit and (field.low is None or field.high is None):
        yield (
            f"the data field '{name}' has no unit: add unit='m', unit='rad', ...; of a number without a unit, say its "
            "range by low= and high=, which may be math.inf"
        )
    is_directed = (
        name in _AXES or field.quaternion or (is_sequence and field.shape is not None and field.shape[-1] == 3)
    )
    if field.unit and is_directed and not field.frame and _DIRECTED & {base for base, _ in unit(field.unit).dimension}:
        yield f"the data field '{name}' has a direction and no frame: add frame='own', frame='world', ..."


def _is_measured(field: DataField) -> bool:
    """Whether it contains quantities: neither words, nor flags, nor counts."""
    default: object = field.default
    if isinstance(default, (bool, dict)) or field.type in _COUNTED or field.dtype in ("uint8", "bool"):
        return False
    if isinstance(default, str):
        # a default may be a word that describes the initial number
        return field.type in ("float", "double")
    if isinstance(default, int) or "int" in field.type or "string" in field.type or "objects" in field.type:
        return False
    return field.shape is not None or next(numbers_in(default), None) is not None


# Rules for the undisturbed behaviour of a component.

FITS, JSON, DETERMINISTIC = "data fit their declarations", "data are JSON", "deterministic under a seed"
SAVED, RESET = "saved and restored", "a reset makes it new"

#: ticks of a run: long enough for components that act once per second
TICKS = 70
_BEFORE_SAVING = 25


def well_behaved(stand: ContractWorld, other: Callable[[], ContractWorld], journal: LogCapture) -> Iterator[Fault]:
    """All rules of this file.

    Args:
        stand: a simulation after the launch.
        other: creates another one.
    """
    cls = type(stand.component)
    place = stand.places.of_class(cls)
    try:
        first = stand.run(TICKS)
    except (TypeError, ValueError) as error:
        yield Fault(JSON, f"{error}: keep numbers, words, lists and dictionaries in local_data", place)
        return
    if stand.failed:
        yield Fault(FITS, f"it fails when it acts: {journal.last('no reason is given')}", place)
        return
    yield from _fits(stand)
    yield from _is_json(stand, first)
    with other() as again:
        yield from _same(
            DETERMINISTIC, first, again.run(TICKS), place, "take random numbers from self.context.random()"
        )
    try:
        yield from _saved(stand, other, place)
    except StateError as error:
        yield Fault(SAVED, str(error), place)
    stand.simulation.restart(seed=1)
    hint = "keep what changes in the component, not in its class or module"
    yield from _same(RESET, first, stand.run(TICKS), place, hint)


def _fits(stand: ContractWorld) -> Iterator[Fault]:
    """Check that the data match the declarations."""
    places, cls = stand.places, type(stand.component)
    for field, declaration, text in misfits(stand.component):
        yield Fault(FITS, text, places.of(cls, "add_data", field) if declaration else places.of_class(cls))


def _is_json(stand: ContractWorld, lines: list[bytes]) -> Iterator[Fault]:
    cls = type(stand.component)
    fields = fields_of_component(stand.component)
    values: dict[str, float] = {}
    for line in lines:
        if b"NaN" not in line and b"Infinity" not in line:
            continue  # most lines are of finite numbers, and those of lidars are long
        for name, value in json.loads(line).items():
            allow = fields[name].allow if name in fields else ()
            for number in _numbers(value):
                if not math.isfinite(number) and str(number) not in allow:
                    values.setdefault(name, number)
    for name, number in values.items():
        text = f"the data field '{name}' was {number}, which is not JSON: declare it by allow=('{number}',) or avoid it"
        yield Fault(JSON, text, stand.places.of(cls, "add_data", name))


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, (list, dict)):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _numbers(item)


def _same(rule: str, one: list[bytes], other: list[bytes], place: str, hint: str) -> Iterator[Fault]:
    for tick, (a, b) in enumerate(zip(one, other, strict=True), 1):
        if a != b:
            names = [name for name, value in json.loads(a).items() if repr(value) != repr(json.loads(b).get(name))]
            what = ", ".join(f"'{name}'" for name in names) or "the order of its data"
            yield Fault(rule, f"two runs differ first in tick {tick}, in {what}: {hint}", place)
            return


def _saved(stand: ContractWorld, other: Callable[[], ContractWorld], place: str) -> Iterator[Fault]:
    simulation = stand.simulation
    simulation.restart(seed=1)
    stand.run(_BEFORE_SAVING)
    state = simulation.save()
    for text in state.unsaved:
        yield Fault(SAVED, f"{text} cannot be saved: keep plain data, or write get_state() and set_state()", place)
    with other() as fresh:
        fresh.simulation.restore(type(state).from_bytes(state.to_bytes()))
        ahead = stand.run(TICKS - _BEFORE_SAVING), simulation.save().fingerprints()
        again = fresh.run(TICKS - _BEFORE_SAVING), fresh.simulation.save().fingerprints()
    yield from _same(SAVED, ahead[0], again[0], place, "a part of its state is not in its attributes")
    if ahead[0] == again[0]:
        parts = [name for name, value in ahead[1].items() if value != again[1].get(name)]
        if parts:
            yield Fault(SAVED, f"after the same ticks the states differ in {', '.join(parts)}", place)


# Rules for the behaviour of a component with invalid input from clients.

COMMANDS, CALLS = "survives bad commands", "survives bad calls"

_COMMON = {declaration.name for declaration in declared_services(Object)}
_MOST_ARGUMENTS = 4
_NO_COMMANDS: tuple[object, ...] = (None, [], "text", {}, {"no_such_field": 1.0}, {1: 2})


class InvalidInput:
    """Sends invalid input to a component.

    Args:
        stand: a simulation; it may be in any state afterwards.
    """

    def __init__(self, stand: ContractWorld, journal: LogCapture) -> None:
        self._stand = stand
        self._said = journal
        #: number of ticks within which it acts
        self._period = math.ceil(stand.simulation.clock.frequency / stand.component.frequency)

    def faults(self) -> Iterator[Fault]:
        """All rules of this file."""
        self._said.take()
        if isinstance(self._stand.component, Actuator):
            yield from self._commands()
        yield from self._properties()
        yield from self._calls()

    def _commands(self) -> Iterator[Fault]:
        places, cls = self._stand.places, type(self._stand.component)
        for name in list(self._stand.component.local_data):
            place = places.of(cls, "add_data", name)
            for value in BAD_VALUES:
                what = f"the command {name}={value!r:.40}"
                yield from self._tried(COMMANDS, what, place, self._publish, {name: value})
        for message in _NO_COMMANDS:
            yield from self._tried(COMMANDS, f"the command {message!r}", places.of_class(cls), self._publish, message)

    def _publish(self, message: object) -> bool:
        try:
            self._stand.publish(message)
        except CommandError:
            return False
        return True

    def _properties(self) -> Iterator[Fault]:
        places, cls = self._stand.places, type(self._stand.component)
        for python_name, prop in properties(cls).items():
            place = places.of(cls, "add_property", python_name)
            before = getattr(self._stand.component, python_name)
            for value in BAD_VALUES:
                what = f"set_property({prop.name!r}, {value!r:.40})"
                for fault in self._tried(CALLS, what, place, self._call, "set_property", prop.name, value):
                    bounded = prop.low is not None and prop.high is not None
                    hint = "" if bounded or prop.choices else "\ndeclare the range of the property by low= and high="
                    yield fault._replace(text=fault.text + hint)
            setattr(self._stand.component, python_name, before)

    def _calls(self) -> Iterator[Fault]:
        places, cls = self._stand.places, type(self._stand.component)
        for declaration in list(self._stand.component.services()):
            if declaration.name in _COMMON:
                continue
            place = places.of(cls, "def", declaration.attribute)
            method = getattr(self._stand.component, declaration.attribute)
            most = len(signature_of(method).parameters)
            yield from self._tried(CALLS, f"{declaration.name}()", place, self._call, declaration.name)
            for value in BAD_VALUES if most else ():
                for count in range(1, min(most, _MOST_ARGUMENTS) + 1):
                    what = f"{declaration.name}({', '.join([f'{value!r:.40}'] * count)})"
                    yield from self._tried(CALLS, what, place, self._call, declaration.name, *([value] * count))

    def _call(self, service: str, *arguments: object) -> bool:
        try:
            self._stand.simulation.call(self._stand.name, service, *arguments)
        except TypeError:
            return False
        except Exception as error:
            cause = error.__cause__
            if cause is not None and not isinstance(cause, (MorseError, ValueError, TypeError, LookupError)):
                raise cause from None
            return False
        return True

    def _tried(
        self, rule: str, what: str, place: str, function: Callable[..., bool], *arguments: object
    ) -> Iterator[Fault]:
        """Apply an input, let the component act if the input was accepted, and check that the simulation continues."""
        stand = self._stand
        try:
            if function(*arguments):
                stand.simulation.step(self._period)
            _ = stand.component.local_data
        except Exception as error:
            yield Fault(rule, f"after {what}: {describe(error)}", place)
            stand.simulation.restart(seed=1)
            self._said.take()
            return
        if stand.failed:
            yield Fault(rule, f"after {what} it is deactivated: {self._said.last('')}", place)
            stand.simulation.restart(seed=1)
            self._said.take()


CARRIED = "carried by every middleware"
_KIND_STREAM = "morse.core.streams.kind_stream.KindStream"
_TICKS = 70


class Listener(DatastreamManager):
    """A middleware that writes every message as JSON, whatever its kind, and discards the result.

    Attributes:
        heard: number of messages.
    """

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self.heard = 0

    @maps("general")
    def general(self, stream: Any, message: Any) -> None:
        """Take a message.

        Raises:
            TypeError: a slot cannot be written.
        """
        to_json(dict(message.fields))
        for kind in stream.kinds:
            to_json(dict(kind.gather().slots))
            self.heard += 1


def carried(stand: ContractWorld) -> Iterator[Fault]:
    """Every installed middleware has a stream for it, and its data fit its message kinds."""
    component = stand.component
    cls = type(component)
    if not isinstance(component, (Sensor, Actuator)) or not fields_of_component(component) or says_nothing(cls):
        return
    direction = "IN" if isinstance(component, Actuator) else "OUT"
    place = stand.places.of_class(cls)
    for name, middleware in registry.installed().items():
        # text files have no commands, and omit images
        usual = middleware.default_reader if direction == "IN" else middleware.default_publisher
        if middleware.stream_manager is None or usual is None or middleware.leaves_out(cls):
            continue
        if middleware.stream_of(cls, direction) is None:
            yield Fault(CARRIED, f"'{name}' has no stream for it", place)
    listener = Listener({}, stand.simulation.context)
    try:
        listener.connect(component, StreamDeclaration("check", _KIND_STREAM, direction, {}))
        stand.run(_TICKS)
    except Exception as error:
        yield Fault(CARRIED, f"its message cannot be made: {type(error).__name__}: {error}", place)
    if stand.failed or not listener.streams.get(component.name()):
        yield Fault(CARRIED, "its message cannot be made: the stream is closed when a client connects", place)
    listener.finalize()


LOADS = "can be put on a robot"

#: description of each rule
RULES: dict[str, str] = {
    LOADS: "a simulation with the component on a robot of MORSE, or on the given robot, can be loaded",
    DOCUMENTED: "the class, its data, properties, levels and services have descriptions",
    DECLARED: "numbers have a unit, directions a frame, lists of numbers a shape",
    FITS: "after a second of acting, the data are declared, and have the type, shape and range declared",
    JSON: "the data can be encoded as JSON, without NaN and infinity unless they are allowed",
    DETERMINISTIC: "two simulations with the same seed publish the same, tick by tick",
    SAVED: "a state that is restored in another simulation has the same future, and is complete",
    RESET: "its behaviour after a reset is the same as after the launch",
    CARRIED: "every installed middleware has a stream for it, and its messages can be created",
    COMMANDS: "no value of a client deactivates it, or ends the simulation",
    CALLS: "no argument of a service and no value of a property does",
}


def check_component(what: str | os.PathLike[str], robot: str | None = None) -> list[Report]:
    """Check the contract that every component follows.

    Each component runs in several simulations of some seconds, without sockets, in this process.

    Args:
        what: the name of a class of `morse.builder`, or the path of a file with classes of components: each is checked.
        robot: the class of its robot: one of `morse.builder`, or ``package.module.Class`` in the
            project of the file. None to try those of MORSE.

    Returns:
        A report for each component.

    Raises:
        SubjectError: there is nothing to check.
    """
    with LogCapture() as journal:
        reports = []
        for subject in subjects(what):
            # streams are created after the scene was loaded: the message kinds of the project are found until then
            folders = [folder for folder in subject.source_paths if folder not in sys.path]
            sys.path += folders
            try:
                reports.append(_check(subject, robot, journal))
            finally:
                sys.path[:] = [entry for entry in sys.path if entry not in folders]
        return reports


def _check(subject: Subject, robot: str | None, journal: LogCapture) -> Report:
    report = Report(subject.name, checked=[LOADS])
    try:
        stand = set_up(subject, journal, robot)
    except SubjectError as error:
        report.faults.append(Fault(LOADS, str(error)))
        return report
    with stand:
        cls = type(stand.component)
        report.where, report.robot = stand.places.of_class(cls), stand.robot
        report.checked += [DOCUMENTED, DECLARED]
        report.take(DECLARED, chain(documented(cls, stand.places), declared(cls, stand.places)))
        names = [None, *(name for name, level in levels(cls).items() if not level.default)]
        report.checked += [FITS, JSON, DETERMINISTIC, SAVED, RESET]
        for name in names:
            _run(subject, stand, name, journal, report)
        if not stand.failed and not report.of(JSON):
            report.checked += [CARRIED, COMMANDS, CALLS]
            report.take(CARRIED, _anew(stand, carried))
            report.take(CALLS, _anew(stand, lambda stand: InvalidInput(stand, journal).faults()))
    return report


def _run(subject: Subject, stand: ContractWorld, level: str | None, journal: LogCapture, report: Report) -> None:
    """Run a component at one of its levels."""
    carrier = stand.carrier

    def other() -> ContractWorld:
        return set_up(subject, journal, carrier, level)

    if level is None:
        report.take(FITS, well_behaved(stand, other, journal))
        return

    def at_level() -> Iterator[Fault]:
        with other() as own:
            for fault in well_behaved(own, other, journal):
                yield fault._replace(text=f"at the level '{level}': {fault.text}")

    report.take(FITS, at_level())


def _anew(stand: ContractWorld, rule: Callable[[ContractWorld], Iterable[Fault]]) -> Iterator[Fault]:
    stand.simulation.restart(seed=1)
    yield from rule(stand)
