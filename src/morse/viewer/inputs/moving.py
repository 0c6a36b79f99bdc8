"""Puts objects somewhere by the handles of the driving page, or pulls at them as if by a spring."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseError
from morse.viewer.view_messages import Answer, Refused

if TYPE_CHECKING:
    from morse.viewer import page_messages as page
    from morse.viewer.inputs.service_calls import ServiceCalls
    from morse.viewer.server import ViewServer


class Moving:
    """Carries out what the pointer of the page does to objects, by the services that clients call for it."""

    def __init__(self, server: ViewServer, services: ServiceCalls) -> None:
        self._server = server
        self._services = services

    def teleport(self, event: page.Teleport) -> None:
        """Put an object somewhere, at rest."""
        place = (event.node, list(event.position), list(event.quaternion))
        if self._services.attempt(event.request, lambda: self._services.run("simulation", "set_object_pose", *place)):
            self._server.send(Answer(event.request, True))

    def drag(self, event: page.Drag) -> None:
        """Pull from now on, or to another place."""
        try:
            self._services.run("simulation", "pull", event.node, list(event.anchor), list(event.target))
        except MorseError as error:
            self._server.send(Refused("drag", str(error)))

    def let_go(self, _event: page.DragEnd | None = None) -> None:
        """Pull no longer."""
        self._services.run("simulation", "let_go")
