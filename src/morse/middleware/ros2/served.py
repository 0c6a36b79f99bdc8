"""Services of the node itself, which are no services of a component."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import RosMessage
    from morse.rosmsgs.topics.backend import Backend, ServiceServer

    Reply = Callable[[RosMessage], object]
    Handler = Callable[[RosMessage, Reply], object]

_EACH_TICK = 16


class Served:
    """Answers the calls of some services.

    Args:
        backend: a backend with services.
        handlers: name to type and function, which is called with the request and with what sends the response.
            Services whose type the backend does not have are not offered.
    """

    def __init__(self, backend: Backend, handlers: Mapping[str, tuple[str, Handler]]) -> None:
        self._servers: list[tuple[ServiceServer, Handler]] = []
        #: of the services that are offered
        self.names: list[str] = []
        for name, (kind, handler) in handlers.items():
            server = backend.service(name, kind)
            if server is not None:
                self._servers.append((server, handler))
                self.names.append(name)

    def serve(self, is_used: Callable[[], bool] = lambda: False) -> bool:
        """Answer the received calls.

        Args:
            is_used: called after each call; returns whether the time for calls is used.

        Returns:
            Whether the time for calls is used.
        """
        for server, handler in self._servers:
            for _ in range(_EACH_TICK):
                requests = server.take(1)
                if not requests:
                    break
                caller, request = requests[0]
                handler(request, lambda answer, server=server, caller=caller: server.answer(caller, answer))  # type: ignore[misc]
                if is_used():
                    return True
        return False

    def close(self) -> None:
        """Remove all services."""
        for server, _ in self._servers:
            server.close()
        self._servers.clear()
