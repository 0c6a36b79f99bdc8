"""Rules for the behaviour of a component with invalid input from clients."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.declarations import properties
from morse.core.exceptions import MorseError
from morse.core.object import Object
from morse.core.reports.faults import describe
from morse.core.services import declared_services, signature_of
from morse.core.validation.errors import CommandError
from morse.verification.contract.examples import BAD_VALUES
from morse.verification.contract.report import Fault

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.verification.contract.contract_world import ContractWorld
    from morse.verification.contract.log_capture import LogCapture

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
