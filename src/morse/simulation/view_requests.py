"""What the driving page asks of components: the same services that clients call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.declarations import properties
from morse.core.exceptions import MorseError
from morse.core.request_manager import Outcome, RequestManager
from morse.core.values import checked_property
from morse.simulation.faults import describe
from morse.viewer.view_messages import Activity, Answer, Capturing, PropertyValue, Refused

if TYPE_CHECKING:
    import uuid

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.viewer import page_messages as page
    from morse.viewer.server import ViewServer

#: the attribute of components that take pictures
_CAPTURING = "capturing"


class ViewRequests(RequestManager):
    """Offers every service of every component to the live view."""

    title = "the live view"

    def __init__(self, context: Context, server: ViewServer) -> None:
        super().__init__(context)
        self._server = server
        self._pending: dict[uuid.UUID, int] = {}
        self._context = context
        self.register_all()

    def register_all(self) -> None:
        """Offer the services of the components as they are now."""
        context = self._context
        for name, obj in [*context.service_objects.items(), *context.robots.items(), *context.components.items()]:
            for declaration in obj.services():
                method = getattr(obj, declaration.attribute)
                register = self.register_async_service if declaration.asynchronous else self.register_service
                register(name, method, declaration.name)

    def initialization(self) -> bool:
        """Nothing to take: the server of the view is there."""
        return True

    def finalization(self) -> bool:
        """Nothing to release."""
        return True

    def main(self) -> None:
        """Requests come as events of the view."""

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Tell the page how its call ended."""
        request = self._pending.pop(request_id, None)
        if request is not None:
            self._answer(request, result)

    def _answer(self, request: int, outcome: Outcome) -> None:
        state, value = outcome
        if state == status.SUCCESS:
            self._server.send(Answer(request, True, value))
        else:
            self._server.send(Answer(request, False, error=str(value or state)))

    def _fail(self, request: int, error: BaseException) -> None:
        text = str(error) if isinstance(error, (MorseError, ValueError)) else describe(error)
        self._server.send(Answer(request, False, error=text))

    def call(self, event: page.CallService) -> None:
        """Call a service."""
        try:
            done, value = self.on_incoming_request(event.component, event.service, event.arguments)
        except Exception as error:
            self._fail(event.request, error)
            return
        if done:
            self._answer(event.request, value)
        else:
            self._pending[value] = event.request

    def cancel(self, event: page.CancelService) -> None:
        """Interrupt a running service."""
        for request_id, request in list(self._pending.items()):
            if request == event.request:
                self.abort_request(request_id)

    def _component(self, name: str) -> Object:
        found = self._context.components.get(name) or self._context.robots.get(name)
        if found is None:
            raise ValueError(f"there is no component '{name}'")
        return found

    def set_property(self, event: page.SetProperty) -> None:
        """Change a property."""
        try:
            component = self._component(event.component)
            python_name, value = checked_property(component, event.name, event.value)
            setattr(component, python_name, value)
        except Exception as error:
            self._fail(event.request, error)
            return
        self._server.send(PropertyValue(event.component, event.name, value))
        if python_name == _CAPTURING:
            self.tell_capturing()
        self._server.send(Answer(event.request, True, value))

    def toggle_capturing(self, event: page.ToggleCapturing) -> None:
        """Let all cameras take pictures, or stop them if any of them does."""
        cameras = self._cameras()
        if not cameras:
            self._server.send(Refused("toggle_capturing", "No robot has a camera."))
            return
        active = not any(camera.capturing for camera in cameras)
        for camera in cameras:
            camera.capturing = active
            declared = properties(type(camera)).get(_CAPTURING)
            if declared is not None:
                self._server.send(PropertyValue(camera.name(), declared.name, active))
        self.tell_capturing()

    def tell_capturing(self) -> None:
        """Tell the pages whether the cameras take pictures."""
        cameras = self._cameras()
        if cameras:
            self._server.send(Capturing(any(camera.capturing for camera in cameras)))

    def _cameras(self) -> list[Any]:
        """The components that take pictures, or pause to."""
        return [component for component in self._context.components.values() if hasattr(component, _CAPTURING)]

    def activate(self, event: page.Activate) -> None:
        """Let a component act, or not."""
        try:
            component = self._component(event.component)
            component.active = event.active
        except Exception as error:
            self._fail(event.request, error)
            return
        self._server.send(Activity(event.component, component.active))
        self._server.send(Answer(event.request, True))

    def teleport(self, event: page.Teleport) -> None:
        """Put an object somewhere, at rest."""
        from morse.core.mathutils import Quaternion

        objects: dict[str, Any] = self._context.world.objects_by_name
        obj = objects.get(event.node)
        if obj is None:
            self._fail(event.request, ValueError(f"there is no object '{event.node}'"))
            return
        obj.worldOrientation = Quaternion(event.quaternion)
        obj.worldPosition = event.position
        obj.halt()
        self._server.send(Answer(event.request, True))
