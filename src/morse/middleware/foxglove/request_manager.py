"""Offers services and parameters to Foxglove."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec

from morse.middleware.foxglove.hub import FoxgloveHub
from morse.middleware.foxglove.parameters import GET, SET, Parameters
from morse.middleware.web.requests import WebRequestManager, encoded

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.middleware.web.hub import HubClient

#: ticks between two looks at the parameters that clients watch
_PERIOD = 15


class FoxgloveRequestManager(WebRequestManager):
    """Services with arguments and results in JSON; the properties of components as parameters."""

    classpath = "morse.middleware.foxglove.request_manager.FoxgloveRequestManager"
    hub_class = FoxgloveHub

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._parameters = Parameters(context, self._settable, self._set)
        self._ticks = 0

    def _settable(self) -> list[str]:
        return [component for component, name in self._services if name == "set_property"]

    def _set(self, component: str, arguments: list[object]) -> None:
        self.on_incoming_request(component, "set_property", arguments)

    def _handle(self, client: HubClient, call: object, path: str, arguments: bytes) -> None:
        if path not in (GET, SET):
            super()._handle(client, call, path, arguments)
            return
        fields = msgspec.json.decode(arguments)
        try:
            names, refusals = (fields, []) if path == GET else self._parameters.write(fields)
            values = self._parameters.read(names) if names or path == GET else []
            self._outbox.append((client, call, None, encoded({"parameters": values, "refusals": refusals})))
        except Exception as error:  # a property may be code of the user
            text = self._complaints.service_failed("a parameter", error)
            self._outbox.append((client, call, text, b""))

    def main(self) -> None:
        """See `RequestManager.main`; also tell which watched parameters have changed."""
        super().main()
        self._ticks += 1
        if self._ticks % _PERIOD == 0:
            for client in list(self._hub.server.clients):
                names = client.watched  # type: ignore[attr-defined] # it is a FoxgloveClient
                if names:
                    self._tell(client, names)

    def _tell(self, client: Any, names: frozenset[str]) -> None:
        try:
            values = encoded([one for one in self._parameters.read(()) if one["name"] in names])
        except Exception as error:  # a property may be code of the user
            self._complaints.service_failed("a parameter", error)
        else:
            self._context.network.post(client.watch, values)
