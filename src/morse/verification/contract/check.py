"""Checks components against all rules."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.datastream import DatastreamManager
from morse.core.declarations import fields_of_component, levels, says_nothing
from morse.core.mapping import maps
from morse.core.sensor import Sensor
from morse.middleware import registry
from morse.scene import StreamDeclaration
from morse.verification.contract.behaviour import DETERMINISTIC, FITS, JSON, RESET, SAVED, well_behaved
from morse.verification.contract.contract_world import ContractWorld, set_up
from morse.verification.contract.declared import DECLARED, DOCUMENTED, declared, documented
from morse.verification.contract.invalid_input import CALLS, COMMANDS, InvalidInput
from morse.verification.contract.log_capture import LogCapture
from morse.verification.contract.report import Fault, Report
from morse.verification.contract.subjects import Subject, SubjectError, subjects
from morse.wire.encoding import to_json

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Iterator

    from morse.core.context import Context
    from morse.core.values import Options
    from morse.verification.contract.contract_world import ContractWorld

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
        is_left_out = any(base.__name__ in middleware.not_carried for base in cls.__mro__)
        if middleware.stream_manager is None or usual is None or is_left_out:
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
        return [_check(subject, robot, journal) for subject in subjects(what)]


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
