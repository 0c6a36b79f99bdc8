"""Offers services on ports of YARP."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from morse.core.calls import AnsweredRequests
from morse.core.clients.budgets import TimeShare
from morse.core.reports.quoting import shown
from morse.core.status import FAILED
from morse.plugins.yarp.bottle import encode
from morse.plugins.yarp.ports import Ports, WaitingBottles, ports_of
from morse.wire.encoding import written

if TYPE_CHECKING:
    from collections.abc import Callable, Set

    from morse.core.context import Context
    from morse.core.request_manager import Outcome
    from morse.plugins.yarp.port import Port

#: limits: requests in one tick, requests that wait, letters of the arguments
_EACH_TICK, _MOST_WAITING, _LONGEST = 64, 1024, 1 << 16


class YarpRequestManager(AnsweredRequests):
    """Requests on ``/morse/services/component/request``, outcomes on ``/morse/services/component/reply``.

    A request is a bottle of an id, a component, a service, and the arguments as the text of a Python list. Its outcome
    is a bottle with one text: the id, the status and the result.
    """

    classpath = "morse.middleware.yarp_request_manager.YarpRequestManager"
    title = "YARP service manager"

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._ports: Ports | None = None
        self._requests: dict[str, Port] = {}
        self._replies: dict[str, Port] = {}
        self._inbox: WaitingBottles[tuple[str, list[object]]] = WaitingBottles(
            _MOST_WAITING, self._complaints, "yarp: service calls"
        )
        self._share = TimeShare(context.time_shares)

    def initialization(self) -> bool:
        """Share the ports of the simulation."""
        self._ports = ports_of(self._context)
        return True

    def finalization(self) -> bool:
        """Close the ports."""
        for component in list(self._requests):
            self._close(component)
        if self._ports is not None:
            self._ports.release()
            self._ports = None
        return True

    def post_registration(self, component_name: str, service: str, is_async: bool) -> bool:
        """Open the ports of a component with its first service."""
        if self._ports is None:
            return False
        if component_name not in self._requests:
            path = self._ports.name(f"services/{component_name}")
            owner = f"the services of {component_name}"
            self._replies[component_name] = self._ports.open(f"{path}/reply", owner)
            self._requests[component_name] = self._ports.open(f"{path}/request", owner, self._taker(component_name))
        return True

    def _taker(self, component: str) -> Callable[[list[object], int], object]:
        def take(values: list[object], count: int) -> None:
            self._inbox.append((component, values), count)
            self._context.wake()

        return take

    def withdrawn(self, component_name: str, services: Set[str]) -> None:
        """See `RequestManager.withdrawn`: close the ports after the last service."""
        if component_name not in self.services():
            self._close(component_name)

    def _close(self, component: str) -> None:
        for table in (self._requests, self._replies):
            port = table.pop(component, None)
            if port is not None and self._ports is not None:
                self._ports.close(port)

    # -- the tick ----------------------------------------------------------------------------

    def main(self) -> None:
        """See `RequestManager.main`."""
        share = self._share
        if not self._inbox or not share.begin():
            return
        for _ in range(min(len(self._inbox), _EACH_TICK)):
            component, values = self._inbox.popleft()
            self._handle(component, values)
            if share.end_request():
                return
        if self._inbox:
            self._context.wake()

    def _handle(self, place: str, values: list[object]) -> None:
        number = str(values[0]) if values else ""
        try:
            component, service, arguments = _request(values)
        except ValueError as error:
            self._answer(place, number, (FAILED, str(error)))
            return
        self.call(component, service, arguments, lambda outcome: self._answer(place, number, outcome))

    def _answer(self, place: str, number: str, outcome: Outcome) -> None:
        port = self._replies.get(place)
        if port is None:
            return
        state, result = outcome
        text = "" if result is None else f" {result}" if isinstance(result, str) else f" {written(result)}"
        self._context.network.post(port.send, encode([f"{number} {state}{text}"]))


def _request(values: list[object]) -> tuple[str, str, list[object]]:
    """Component, service and arguments of a request.

    Raises:
        ValueError: it is none.
    """
    if not 3 <= len(values) <= 4:
        raise ValueError(f"a request is (id, component, service, arguments), got {shown(values)}")
    arguments = values[3] if len(values) == 4 else []
    if isinstance(arguments, str):
        arguments = _literal(arguments)
    return str(values[1]), str(values[2]), list(arguments) if isinstance(arguments, (list, tuple)) else [arguments]


def _literal(text: str) -> object:
    if not text.strip():
        return []
    if len(text) > _LONGEST:
        raise ValueError(f"the arguments have {len(text)} letters, expected at most {_LONGEST}")
    try:
        return ast.literal_eval(text)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        raise ValueError(f"the arguments are not a Python list such as '[1.0, 2.0]': {shown(text)}") from None
