"""The participant of a ROS domain, and its services: shared by the streams and the services of a simulation."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from morse.core.exceptions import MorseMiddlewareError
from morse.core.validation.fields import checked_options, with_defaults
from morse.middleware.ros2 import BACKENDS, LAST_DOMAIN, MANAGER_OPTIONS, MIDDLEWARE
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.context import Context
    from morse.core.values import Options, RosMessage
    from morse.rosmsgs.topics.backend import Backend, ServiceServer

    Reply = Callable[[RosMessage], object]
    Handler = Callable[[RosMessage, Reply], object]


_CLASSES = {
    "rclpy": "morse.middleware.ros2.backends.ros_client.RclpyBackend",
    "cyclonedds": "morse.middleware.ros2.backends.cyclone.CycloneBackend",
}


def available() -> list[str]:
    """The backends whose packages are installed, in order of preference; none is imported."""
    return [name for name in BACKENDS if find_spec(name) is not None]


def make_backend(options: Options) -> Backend:
    """Join the domain.

    Args:
        options: ``backend`` (None for the first usable one), ``domain_id``, ``interface``.

    Raises:
        MorseMiddlewareError: no backend is installed, or it cannot join.
    """
    option = options["backend"]
    names = [option] if option is not None else available()
    failures = []
    for name in names:
        module, _, cls = _CLASSES[name].rpartition(".")
        try:
            backend: Backend = getattr(import_module(module), cls)(options)
        except ImportError as error:
            failures.append(f"{name} cannot be imported: {error}")
        else:
            return backend
    reasons = "; ".join(failures) or "neither rclpy nor cyclonedds is installed"
    raise MorseMiddlewareError(
        f"ros2: {reasons}. Source the set-up file of a ROS 2 installation (source /opt/ros/jazzy/setup.bash), or "
        f"install the backend without ROS: {install('ros2')}"
    )


_joined: WeakKeyDictionary[Context, Backend] = WeakKeyDictionary()


def options_of(context: Context) -> RosMessage:
    """The options of ``env.configure_stream_manager('ros2', ...)`` with defaults.

    Raises:
        OptionError: an option does not exist, or has an invalid value.
    """
    options = context.scene.manager_options.get(MIDDLEWARE.stream_manager or "", {})
    return with_defaults(MANAGER_OPTIONS, checked_options("ros2", MANAGER_OPTIONS, dict(options)))


def join(context: Context, options: Options) -> Backend:
    """Return the participant of a simulation; the caller has to call `Backend.release` at the end.

    Raises:
        MorseMiddlewareError: no backend is installed, or it cannot join.
    """
    membership = _joined.get(context)
    if membership is not None and membership.users:
        membership.users += 1
        return membership
    backend = make_backend({**options, "domain_id": _domain(options)})
    backend.users = 1
    _joined[context] = backend
    return backend


def _domain(options: Options) -> int:
    if options["domain_id"] is not None:
        return int(options["domain_id"])
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        raise MorseMiddlewareError(f"ros2: ROS_DOMAIN_ID is {text!r}, expected a number from 0 to {LAST_DOMAIN}")
    return int(text)


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
