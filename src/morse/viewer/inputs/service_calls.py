"""Calls of the driving page to components, by the same services that clients call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.declarations import properties
from morse.core.exceptions import MorseError
from morse.core.reports.faults import describe
from morse.core.request_manager import Outcome, RequestManager
from morse.viewer.feeds.states import cameras_of
from morse.viewer.view_messages import Answer, PropertyValue, Refused

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.interfaces import Offering
    from morse.viewer import page_messages as page
    from morse.viewer.inputs.commands import Commands
    from morse.viewer.requests import PageLeft
    from morse.viewer.server import ViewServer


class ServiceCalls(RequestManager):
    """Offers every service of every component to the live view."""

    title = "the live view"

    def __init__(self, context: Context, server: ViewServer, commands: Commands) -> None:
        super().__init__(context)
        self._server = server
        self._commands = commands
        self._pending: dict[uuid.UUID, int] = {}
        self._context = context
        self.register_all()

    def register_all(self) -> None:
        """Offer the services of the present components."""
        self._services.clear()
        context = self._context
        owners: list[tuple[str, Offering]] = [(obj.name(), obj) for obj in context.service_objects]
        owners += [*context.robots.items(), *context.components.items()]
        for name, obj in owners:
            for declaration in obj.services():
                method = getattr(obj, declaration.attribute)
                register = self.register_async_service if declaration.asynchronous else self.register_service
                register(declaration.component or name, method, declaration.name)

    def initialization(self) -> bool:
        """Nothing to do: the server of the view already runs."""
        return True

    def finalization(self) -> bool:
        """Nothing to do."""
        return True

    def main(self) -> None:
        """Nothing to do: requests are events of the view."""

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Send the outcome of a call to the page."""
        request = self._pending.pop(request_id, None)
        if request is not None:
            self._answer(request, result)

    def _answer(self, request: int, outcome: Outcome) -> None:
        state, value = outcome
        if state == status.SUCCESS:
            self._server.send(Answer(request, True, value))
        else:
            self._server.send(Answer(request, False, error=str(value or state)))

    def attempt(self, request: int, action: Callable[[], object]) -> bool:
        """Execute a request, and tell the page if it fails; returns whether it succeeded."""
        try:
            action()
        except Exception as error:
            text = str(error) if isinstance(error, (MorseError, ValueError)) else describe(error)
            self._server.send(Answer(request, False, error=text))
            return False
        return True

    def run(self, component: str, service: str, *arguments: object) -> Any:
        """The result of a synchronous service.

        Raises:
            MorseRPCInvokationError: there is no such service, or it refuses the call.
        """
        _, (_, value) = self.on_incoming_request(component, service, list(arguments))
        return value

    def call(self, event: page.CallService) -> None:
        """Call a service."""
        self.attempt(event.request, lambda: self._begin(event))

    def _begin(self, event: page.CallService) -> None:
        is_complete, value = self.on_incoming_request(event.component, event.service, event.arguments)
        if is_complete:
            self._answer(event.request, value)
        else:
            self._pending[value] = event.request

    def cancel(self, event: page.CancelService) -> None:
        """Interrupt a running service."""
        for request_id, request in list(self._pending.items()):
            if request == event.request:
                self.abort_request(request_id)

    def forget(self, event: PageLeft) -> None:
        """End the running services of a page that has disconnected, if they are only for that page."""
        for request_id, request in list(self._pending.items()):
            if request in event.requests:
                self.abandon(request_id)

    def set_property(self, event: page.SetProperty) -> None:
        """Change a property."""
        if self.attempt(event.request, lambda: self.run(event.component, "set_property", event.name, event.value)):
            value = self._property(event.component, event.name)
            # sent even if the value has not changed: the field of the page may show another value
            self._server.send(PropertyValue(event.component, event.name, value))
            self._server.send(Answer(event.request, True, value))

    def _property(self, component: str, name: str) -> object:
        owner: object = self._context.component(component)
        declarations = properties(type(owner)).items()
        return next((getattr(owner, python_name) for python_name, p in declarations if p.name == name), None)

    def command(self, event: page.Command) -> None:
        """Set data of an actuator."""
        if self.attempt(event.request, lambda: self._commands.set(event.component, event.fields)):
            self._server.send(Answer(event.request, True))

    def toggle_capturing(self, _event: page.ToggleCapturing) -> None:
        """Let all cameras capture images, or stop them if any of them does."""
        cameras = cameras_of(self._context)
        if not cameras:
            self._server.send(Refused("toggle_capturing", "No robot has a camera."))
            return
        active = not any(camera.capturing for camera in cameras)
        for camera in cameras:
            declaration = properties(type(camera)).get("capturing")
            if declaration is None:
                camera.capturing = active
            else:
                self.run(camera.name(), "set_property", declaration.name, active)

    def activate(self, event: page.Activate) -> None:
        """Activate or deactivate a component."""
        service = "activate" if event.active else "deactivate"
        if self.attempt(event.request, lambda: self.run("simulation", service, event.component)):
            self._server.send(Answer(event.request, True))
