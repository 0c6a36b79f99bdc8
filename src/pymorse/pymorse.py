"""The connection to a simulation."""

from __future__ import annotations

import atexit
import contextlib
import functools
import logging
import os
import secrets
import threading
import time as _time
import weakref
from typing import TYPE_CHECKING, Any, Self, TypeVar

from pymorse.aio import AsyncMorse
from pymorse.binary import BinaryConnection, BinaryStream
from pymorse.discovery import discover
from pymorse.errors import MorseServiceFailed, MorseTimeoutError
from pymorse.future import MorseFuture
from pymorse.interruption import end_quietly
from pymorse.names import checked_port, normalize_name, series, suggestion
from pymorse.poller import Poller
from pymorse.reconnection import Reconnection
from pymorse.requests import ServiceConnection
from pymorse.stream import TIMEOUT, StreamJSON, connect, connect_locally

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Set
    from types import TracebackType

    from pymorse.component import Component, Robot

_C = TypeVar("_C", "str", "Component", "str | Component")

logger = logging.getLogger("pymorse")

PORTS = range(4000, 4010)
"""Ports for the services of simulations; a simulation uses the first free one."""
_PORT_VARIABLE = "MORSE_SOCKET_PORT"
_PARTING_TIMEOUT = 1.0
#: request to mark the messages that belong together; servers that do not know it ignore it
_TOGETHER = "together"


class Morse:
    """A simulation, its robots and its services.

    Robots are attributes; robots that a loop of the scene created (``m``, ``m_001``, ...) are also in a list ``ms``.
    Use it as a context manager, so that published messages are sent and connections are closed::

        with Morse() as simu:
            simu.robot.motion.publish({"v": 1.0, "w": 0.0})
            print(simu.robot.pose.get())

    In a program with asyncio, ``async with Morse() as simu`` has the same names: see `pymorse.aio.AsyncMorse`.

    Args:
        host: name or address of the host of the simulation.
        port: TCP port of its services, which the simulation prints. The default is the environment variable
            ``MORSE_SOCKET_PORT``, which the simulation also uses, otherwise 4000.
        binary: whether to receive the data of sensors as binary frames on one connection, which takes much less time on
            both sides. Arrays, such as scans and images, are then numpy arrays, or memoryviews if numpy is not
            installed.
        path: path of the Unix socket of the simulation (its environment variable ``MORSE_SOCKET_PATH``), which carries
            its services instead of the port.
        reconnect: whether to connect again when the simulation has ended and another one is started at the same
            address. Components and subscriptions stay; what is called or read in the meantime raises
            ``ConnectionError``. The log of ``pymorse`` tells it.

    Attributes:
        robots: names of the robots.

    Raises:
        ConnectionError: there is no simulation, or it has no binary streams.
    """

    def __init__(
        self,
        host: str = "localhost",
        port: int | None = None,
        *,
        binary: bool = False,
        path: str | None = None,
        reconnect: bool = False,
    ) -> None:
        self.host, self._path = host, path
        self.port = port = _default_port() if port is None else port
        self.robots: list[str] = []
        self._robots: dict[str, Robot] = {}
        self._closed = False
        # separate threads: a callback of a stream may call a service and wait for it
        self._service_poller = Poller("pymorse-services")
        self._stream_poller: Poller | None = None
        self._opening = threading.Lock()
        self._latest_poller: Poller | None = None
        self._streams: list[StreamJSON | BinaryConnection] = []
        self._token = secrets.token_hex(8)
        self._binary_port: int | None = None
        self._is_binary = binary
        self._reconnection: Reconnection | None = None
        self._async: AsyncMorse | None = None
        self._every: BinaryConnection | None = None
        self._latest: BinaryConnection | None = None
        self._service_poller.start()
        try:
            self._connect()
            self._learn()
        except BaseException:
            self._closed = True
            self._service_poller.syncstop(_PARTING_TIMEOUT)
            raise
        if reconnect:
            self._reconnection = Reconnection(self)
        _open.add(self)

    def _connect(self) -> None:
        """Open the connection for services."""
        self._services = _greet(self.host, self.port, self._service_poller, self._path)
        if self._is_binary:
            self._binary_port = self._find_binary_port()

    def _find_binary_port(self) -> int:
        try:
            return checked_port(self.rpc_t(TIMEOUT, "simulation", "get_binary_port"))
        except (MorseServiceFailed, MorseTimeoutError, TypeError, ValueError) as error:
            raise ConnectionError(
                f"the simulation on {self.host}:{self.port} has no binary streams ({error}): "
                "use Morse() without binary=True, or a newer MORSE"
            ) from None

    def _learn(self) -> None:
        for robot in discover(self):
            self._add_robot(normalize_name(robot.name), robot)
        for plural, members in series(self.robots).items():
            self._expose(plural, [self._robots[member] for member in members])

    def _add_robot(self, attribute: str, robot: Robot) -> None:
        self.robots.append(attribute)
        self._robots[attribute] = robot
        self._expose(attribute, robot)

    def _expose(self, attribute: str, value: object) -> None:
        if hasattr(type(self), attribute) or attribute in vars(self):
            logger.warning(
                "the attribute '%s' already exists in pymorse: access the robot as simu[%r]", attribute, attribute
            )
        else:
            setattr(self, attribute, value)

    def __getitem__(self, name: str) -> Robot:
        """The robot of that name.

        Raises:
            KeyError: there is no such robot.
        """
        if name not in self._robots:
            raise KeyError(f"no robot '{name}' in the simulation{suggestion(name, self._robots)}")
        return self._robots[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        # with a name, but without an object, Python adds no suggestion of its own
        raise AttributeError(f"no robot '{name}' in the simulation{suggestion(name, self._robots)}", name=name)

    # services -------------------------------------------------------------------------------

    def call(self, component: str, service: str, *args: object) -> MorseFuture:
        """Call a service without waiting; the future contains the result.

        Raises:
            ConnectionError: the simulation has ended.
        """
        self._check_services()
        return self._services.request(component, service, args)

    def _check_services(self) -> None:
        if self._closed and not self._services.is_up():
            raise ConnectionError("this connection to the simulation has been closed: create a new Morse()")

    def rpc(self, component: str, service: str, *args: object) -> Any:
        """Call a service and wait for its result without a timeout.

        Raises:
            MorseServiceFailed: the service failed; the message contains the reason.
            MorseServicePreempted: the service was cancelled or interrupted.
            TypeError: the number of arguments is wrong.
        """
        self._check_services()
        return self._services.ask(component, service, args)

    def rpc_t(self, timeout: float | None, component: str, service: str, *args: object) -> Any:
        """Call a service and wait at most ``timeout`` seconds for its result.

        Raises:
            MorseTimeoutError: there was no answer within the timeout; the service continues to run.
        """
        future = self.call(component, service, *args)
        try:
            return future.result(timeout)
        except TimeoutError:
            future.abandoned = True
            raise MorseTimeoutError(
                f"timeout exceeded while waiting for response of {component}.{service} ({timeout} s)"
            ) from None

    def cancel(self, service_id: int | str | MorseFuture) -> None:
        """Abort a running service, given its future or its number, which may be a text.

        Raises:
            TypeError: it is neither a future nor a number.
        """
        number = service_id.request if isinstance(service_id, MorseFuture) else service_id
        if isinstance(number, str) and number.isdecimal():
            number = int(number)
        if not isinstance(number, int):
            raise TypeError(f"cancel() takes the future of a service, or its number, not {service_id!r}")
        self._services.abort(number)

    def quit(self) -> None:
        """End the simulation, and this connection."""
        # the simulation may end before its answer is sent
        with contextlib.suppress(ConnectionError):
            self.rpc("simulation", "quit")
        self.close(cancel_async_services=True)

    def reset(self, seed: int | None = None) -> Any:
        """Move every object to its initial pose; with a seed, restart the whole simulation.

        Args:
            seed: seed of the random numbers. Time, components and noise are also reset: the same seed and the same
                commands give the same data.
        """
        if seed is None:
            return self.rpc("simulation", "reset_objects")
        return self.rpc("simulation", "reset", seed)

    def pause(self) -> None:
        """Pause the simulation; services are still answered."""
        self.rpc("simulation", "pause")

    def resume(self) -> None:
        """Resume the simulation."""
        self.rpc("simulation", "resume")

    def step(self, n: int = 1) -> None:
        """Run ``n`` ticks, and wait for their end; the simulation is paused afterwards.

        Commands that were published before take effect in the first tick. ``last()`` of a sensor that has been used
        before returns the data of the last tick.
        """
        if self._stream_poller is None:
            self.rpc("simulation", "step", n)
            return
        sent = self.rpc("simulation", "step", n, True)
        self._stream_poller.catch_up()
        self._wait_for_messages(sent or {})

    def exchange(
        self,
        commands: Mapping[_C, Mapping[str, object]] | None = None,
        read: Iterable[_C] = (),
        n: int = 1,
    ) -> dict[_C, Any]:
        """Send commands, run ``n`` ticks and return data, in one round trip; the simulation is paused afterwards.

        The method has the effect of `publish`, `step` and ``last()`` in half the time, and does not use streams::

            pose = simu.exchange({"robot.motion": {"v": 1.0}}, ["robot.pose"])["robot.pose"]

        Args:
            commands: fields of actuators, by the component or its full name.
            read: components, or their full names, whose data are returned.
            n: number of ticks.

        Returns:
            The data by the elements of ``read``; arrays are lists.

        Raises:
            MorseServiceFailed: there is no such component, or a command is not valid; then no time has passed.
        """
        wanted = {part: _full_name(part) for part in read}
        given = {_full_name(part): command for part, command in (commands or {}).items()}
        found = self.rpc("simulation", "exchange", given, list(wanted.values()), n) or {}
        return {part: found[name] for part, name in wanted.items()}

    def _wait_for_messages(self, sent: dict[str, int]) -> None:
        """Wait until the streams have received all messages that were sent to them.

        The order between connections is not defined: a reply may arrive before data that were sent earlier.
        """
        expected = [(stream, sent[stream.connection]) for stream in self._streams if stream.connection in sent]
        limit = _time.monotonic() + TIMEOUT
        for stream, count in expected:
            if stream.poller.is_serving():
                continue  # a callback of the stream itself cannot wait for the stream
            # callbacks that only need the latest message may take long: they never run in this thread
            is_apart = stream.poller is self._latest_poller
            while not stream.has_received(count) and stream.is_up() and _time.monotonic() < limit:
                if is_apart or not stream.poller.serve_until(functools.partial(stream.has_received, count), 0.05):
                    stream.wait_for_message(0.005)

    def streams(self) -> list[str]:
        """Names of the components that have a stream."""
        return self.rpc("simulation", "list_streams") or []

    def get_stream_port(self, stream: str) -> int:
        """TCP port of the stream of a component, given its full name."""
        return int(self.rpc("simulation", "get_stream_port", stream))

    def activate(self, component: str | Component) -> None:
        """Activate a component, given its full name."""
        self.rpc("simulation", "activate", getattr(component, "fqn", component))

    def deactivate(self, component: str | Component) -> None:
        """Deactivate a component, given its full name."""
        self.rpc("simulation", "deactivate", getattr(component, "fqn", component))

    def sleep(self, time: float) -> None:
        """Wait for ``time`` simulated seconds; messages that were sent before its end have then been received."""
        self.rpc("time", "sleep", time)
        if self._stream_poller is not None:
            self._stream_poller.catch_up()

    def time(self) -> float:
        """Simulated time, s."""
        return self.rpc("time", "now") or 0.0

    # life -----------------------------------------------------------------------------------

    def _check_open(self) -> None:
        if self._closed:
            raise ConnectionError("this connection to the simulation has been closed: create a new Morse()")

    def _open_stream(self, name: str, port: int, directions: Set[str]) -> StreamJSON | BinaryStream:
        """Open the stream of a component.

        Args:
            name: full name of the component.
            port: port of the stream.
            directions: ``OUT`` if the component sends data, ``IN`` if it receives data.
        """
        self._check_open()
        with self._opening:
            if self._stream_poller is None:
                self._stream_poller = Poller("pymorse-streams")
                self._stream_poller.start()
            if "OUT" in directions and self._binary_port is not None:
                if self._every is None or not self._every.is_up():
                    self._every = self._open_binary(self._stream_poller, latest=False)
                binary = self._every.open(name)
                binary.latest = functools.partial(self._open_latest, name)
                return binary
        stream = StreamJSON(self.host, port, poller=self._stream_poller)
        stream.peer = f"{name} ({stream.peer})"
        if directions == {"OUT"}:
            stream.is_marked = True
            with contextlib.suppress(ConnectionError):  # who reads it is told
                stream.send(f"{_TOGETHER} {self._token}\n".encode())
        self._streams.append(stream)
        return stream

    def _open_latest(self, name: str) -> BinaryStream:
        """Open the stream of a sensor for callbacks that only need the latest message."""
        self._check_open()
        with self._opening:
            if self._latest_poller is None:
                self._latest_poller = Poller("pymorse-latest")
                self._latest_poller.start()
            if self._latest is None or not self._latest.is_up():
                self._latest = self._open_binary(self._latest_poller, latest=True)
            return self._latest.open(name)

    def _open_binary(self, poller: Poller, *, latest: bool) -> BinaryConnection:
        assert self._binary_port is not None
        connection = BinaryConnection(self.host, self._binary_port, poller, latest=latest)
        self._streams.append(connection)
        return connection

    def is_up(self) -> bool:
        """Whether the simulation is connected."""
        return not self._closed and self._services.is_up()

    def spin(self) -> None:
        """Wait until the simulation ends, or for Ctrl+C; callbacks continue to run."""
        with contextlib.suppress(KeyboardInterrupt):
            while self.is_up():
                _time.sleep(0.1)

    def close(self, cancel_async_services: bool = False, wait_publishers: bool = True) -> None:
        """Close all connections and end all threads.

        Args:
            cancel_async_services: whether to abort running services, instead of waiting for them.
            wait_publishers: whether to send pending messages first, for at most `TIMEOUT` seconds.
        """
        if self._closed:
            return
        if self._reconnection is not None:
            self._reconnection.close()
        try:
            if cancel_async_services:
                self._abort_pending()
            else:
                self._services.wait_pending()
            if wait_publishers:
                self._drain()
        finally:
            self._closed = True
            _open.discard(self)
            for poller in (self._stream_poller, self._latest_poller, self._service_poller):
                if poller is not None:
                    poller.syncstop(_PARTING_TIMEOUT)
            self._services.executor.close()

    def _abort_pending(self) -> None:
        for future in self._services.pending():
            with contextlib.suppress(ConnectionError, BufferError):
                future.cancel()
        self._services.wait_pending(_PARTING_TIMEOUT)

    def _drain(self) -> None:
        deadline = _time.monotonic() + TIMEOUT
        for stream in [part._stream for robot in self._robots.values() for part in robot._tree()]:
            if stream is not None and not stream.drain(max(0.0, deadline - _time.monotonic())):
                logger.error("%s did not receive all published messages, because it does not read", stream.peer)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, KeyboardInterrupt):
            end_quietly(error)
        self.close(cancel_async_services=kind is not None)

    async def __aenter__(self) -> AsyncMorse:
        self._async = AsyncMorse(self)
        return self._async

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._async is not None
        await self._async.close(cancel_async_services=kind is not None)


def _full_name(part: str | Component) -> str:
    return part if isinstance(part, str) else part.fqn


def _default_port() -> int:
    text = os.environ.get(_PORT_VARIABLE, "")
    if not text.isdecimal():
        return PORTS[0]
    return int(text) or PORTS[0]


def _greet(host: str, port: int, poller: Poller, path: str | None) -> ServiceConnection:
    if path is not None:
        return ServiceConnection(host, port, poller, connect_locally(path))
    try:
        return ServiceConnection(host, port, poller)
    except ConnectionRefusedError:
        raise ConnectionRefusedError(
            f"no simulation listens on {host}:{port}{_elsewhere(host, port)}. Start one with 'morse run <scene>'; "
            "its log contains the port."
        ) from None


def _elsewhere(host: str, port: int) -> str:
    for other in PORTS:
        if other != port:
            with contextlib.suppress(OSError), connect(host, other, timeout=0.5):
                return f", but a server listens on port {other}: try Morse({host!r}, {other})"
    return ""


_open: weakref.WeakSet[Morse] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """Send the last messages of a script that ends without `Morse.close`."""
    for morse in list(_open):
        morse.close(cancel_async_services=True)
