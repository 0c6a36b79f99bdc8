"""Moves objects with the handles of the driving page, or pulls them with a virtual spring."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseError
from morse.viewer.view_messages import Answer, Refused

if TYPE_CHECKING:
    from morse.viewer import page_messages as page
    from morse.viewer.inputs.service_calls import ServiceCalls
    from morse.viewer.server import ViewServer


class Moving:
    """Applies pointer actions of the page to objects, by the services for clients."""

    def __init__(self, server: ViewServer, services: ServiceCalls) -> None:
        self._server = server
        self._services = services

    def teleport(self, event: page.Teleport) -> bool:
        """Move an object to a pose, at rest; returns whether that was possible."""
        place = (event.node, list(event.position), list(event.quaternion))
        if self._services.attempt(event.request, lambda: self._services.run("simulation", "set_object_pose", *place)):
            self._server.send(Answer(event.request, True))
            return True
        return False

    def drag(self, event: page.Drag) -> None:
        """Start pulling, or move the target."""
        try:
            self._services.run("simulation", "pull", event.node, list(event.anchor), list(event.target))
        except MorseError as error:
            self._server.send(Refused("drag", str(error)))

    def let_go(self, _event: page.DragEnd | None = None) -> None:
        """Stop pulling."""
        self._services.run("simulation", "let_go")
