"""Commands, ticks and data in one call; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.actuator import Actuator, PendingCommands
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest, short
from morse.core.rows.marks import present_data
from morse.core.services import concurrent_service
from morse.core.validation.spec import CommandError
from morse.services.lockstep_services import Steps  # noqa: TC001 (arguments are checked against it)

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import Fields


class Stepping(Protocol):
    """The part of a simulation that the service needs."""

    def request_steps(self, ticks: int, on_end: Callable[[tuple[str, object]], object]) -> Callable[[], None]:
        """Run some ticks, then pause and call ``on_end``; return a function that cancels the request."""


class ExchangeServices(AbstractObject):
    """Sends commands, runs ticks and reads data in one round trip, instead of messages on several connections."""

    def __init__(self, simulation: Stepping, context: Context) -> None:
        super().__init__()
        self._simulation = simulation
        self._context = context

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @concurrent_service(changes=False)  # commands are recorded in the journal when the actuators take them
    def exchange(
        self,
        ended: Callable[[tuple[str, object]], object],
        commands: dict[str, Fields],
        read: list[str],
        n: Steps = 1,
    ) -> object:
        """Pass commands to actuators, run ``n`` ticks, and return the data of sensors.

        The simulation is paused afterwards. Earlier step requests are processed first.

        Args:
            commands: fields of actuators, by the name of the component.
            read: names of the components whose data after the last tick are returned.
            n: number of ticks.
        """
        sensors = {name: self._component(name) for name in read}
        given = []
        for name, command in commands.items():
            inbox = self._inbox(name)
            try:
                given.append((inbox, inbox.fitting(command)))
            except CommandError as error:
                raise MorseRPCInvokationError(f"{short(name)}: {error}") from None
        for inbox, fields in given:  # all commands are valid
            inbox.put(fields)

        def answer(outcome: tuple[str, object]) -> None:
            if outcome[0] == status.SUCCESS:
                outcome = (status.SUCCESS, {name: present_data(component) for name, component in sensors.items()})
            ended(outcome)

        return self._simulation.request_steps(n, answer)

    def _component(self, name: str) -> Object:
        component = self._context.component(name) if isinstance(name, str) else None
        if component is None:
            names = [*self._context.components, *self._context.robots]
            raise MorseRPCInvokationError(f"no component {short(name)}{nearest(name, names)}")
        return component

    def _inbox(self, name: str) -> PendingCommands:
        component = self._component(name)
        if not isinstance(component, Actuator):
            raise MorseRPCInvokationError(f"{short(name)} takes no commands: it is not an actuator")
        inboxes = PendingCommands.all_of(component)
        return inboxes[0] if inboxes else PendingCommands(component)
