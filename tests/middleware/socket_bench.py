"""A minimal simulation for the socket: the test runs its ticks."""

from __future__ import annotations

import socket
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from morse.middleware.socket_datastream import SocketDatastreamManager
from morse.middleware.socket_request_manager import SocketRequestManager

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.actuator import Actuator
from morse.core.clients.network import Network
from morse.core.clock import Clock
from morse.core.context import Context, acting
from morse.core.declarations import add_data
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.request_manager import MorseServices
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, noninterruptible, service
from morse.mathutils import Quaternion, Vector
from morse.scene import StreamDeclaration, TimeStrategies
from tests.kit.waiting import wait_until

PUBLISHER = "morse.middleware.socket_datastream.SocketPublisher"
READER = "morse.middleware.socket_datastream.SocketReader"


class Body(dict):
    """A static object of the world."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.worldPosition = Vector((0.0, 0.0, 0.0))
        self.worldOrientation = Quaternion((1.0, 0.0, 0.0, 0.0)).to_matrix()


class Thermometer(Sensor):
    add_data("temperature", 20.5, "float", "of the air")


class Motion(Actuator):
    add_data("v", 0.0, "float", "m/s")
    add_data("w", 0.0, "float", "rad/s")
    add_data("gear", 1, "int", "of the box")
    add_data("lights", False, "bool", "on")
    add_data("mode", "slow", "string", "of driving")
    add_data("target", [0.0, 0.0, 0.0], "vec3<float>", "m")
    add_data("path", [], "list", "of points")
    add_data("options", {}, "dict", "of all kinds")
    add_data("anything", None, "", "of any kind")


class Arm(AbstractObject):
    """Services of every kind."""

    def __init__(self) -> None:
        super().__init__()
        self.interrupted = 0

    def name(self) -> str:
        return "robot1.motion"

    @service
    def echo(self, value: Any) -> Any:
        return value

    @service
    def add(self, a: float, b: float = 2) -> float:
        return a + b

    @service
    def nothing(self) -> None:
        return None

    @service
    def refuse(self) -> None:
        raise MorseRPCInvokationError("not today")

    @service
    def break_down(self) -> None:
        raise KeyError("a mistake of the user")

    @service
    def unsendable(self) -> object:
        return object()

    @interruptible
    @async_service
    def goto(self, x: float, y: float, z: float) -> None:
        """Active until the test completes it."""

    @noninterruptible
    @async_service
    def press(self) -> None:
        """Cannot be interrupted."""

    def interrupt(self) -> None:
        self.interrupted += 1
        super().interrupt()


class Bench:
    """Request manager, stream manager and components on free ports; `tick` is one tick."""

    def __init__(self, options: dict[str, Any] | None = None, robots: tuple[str, ...] = ("robot1",)) -> None:
        self.woken = 0
        scene = SimpleNamespace(components=[], environment="indoors-1/indoor-1", zones=[], manager_options={})
        self.context = Context(
            scene=scene,  # type: ignore[arg-type]
            clock=Clock(60.0, TimeStrategies.BestEffort),
            world=None,
            services=MorseServices(),
            network=Network(),
            stopping=lambda: self.stopping,
        )
        self.context.wake = self._wake  # type: ignore[method-assign]
        self.stopping = False
        self._acting = acting(self.context)
        self._acting.__enter__()
        self.requests = SocketRequestManager(self.context)
        self.context.services.add_request_manager(self.requests)
        for name in ("simulation", "robot1.motion"):
            self.context.services.register_request_manager_mapping(name, self.requests.classpath)
        self.arm = Arm()
        self.context.services.register_object("robot1.motion", self.arm)
        self.streams = SocketDatastreamManager(options or {}, self.context)
        self.context.stream_managers[self.streams.classpath] = self.streams
        self.components: list[Any] = []

    def _wake(self) -> None:
        self.woken += 1
        self.context.network.wake()

    def add(self, component: Any, direction: str, stream: str | None = None, **options: object) -> Any:
        classpath = stream or (READER if direction == "IN" else PUBLISHER)
        declaration = StreamDeclaration(self.streams.classpath, classpath, direction, dict(options))
        self.streams.connect(component, declaration)
        if component not in self.components:
            self.components.append(component)
        return component

    def sensor(self, name: str = "robot1.pose", **options: object) -> Thermometer:
        return self.add(Thermometer(Body(name)), "OUT", **options)

    def actuator(self, name: str = "robot1.motion", **options: object) -> Motion:
        return self.add(Motion(Body(name)), "IN", **options)

    def tick(self) -> None:
        self.streams.action()
        self.context.services.process()
        for component in self.components:
            component.action()
        self.context.clock.advance()
        self.streams.flush()
        # as the loop of a simulation does: a tick that has waited for a client has borrowed the network's event loop
        self.context.network.tend()

    def tick_until(self, condition: Callable[[], Any], timeout: float = 60.0) -> Any:
        def ticked() -> Any:
            self.tick()
            return condition()

        return wait_until(ticked, limit=timeout)

    def port_of(self, name: str) -> int:
        (done, (outcome, port)) = self.requests.on_incoming_request("simulation", "get_stream_port", [name])
        assert done
        assert outcome == status.SUCCESS
        return int(port)

    def connect(self, name: str | None = None) -> Peer:
        """A client of the stream of a component, or of the services; the server knows it already."""
        server = self.requests._server if name is None else self.streams._servers[name]
        assert server is not None
        peer = Peer(self.requests.port if name is None else self.port_of(name))
        host, port = peer.socket.getsockname()
        wait_until(lambda: f"{host}:{port}" in [client.peer for client in list(server.clients)])
        return peer

    def call(self, peer: Peer, request: bytes, replies: int = 1) -> bytes:
        """Send a request and tick until that many lines have arrived."""
        peer.send(request)
        before = len(peer.lines())
        self.tick_until(lambda: len(peer.lines()) >= before + replies)
        return b"".join(line + b"\n" for line in peer.lines()[before:])

    def close(self) -> None:
        self.requests.finalization()
        self.streams.finalize()
        self.context.network.stop()
        self._acting.__exit__(None, None, None)


class Peer:
    """A raw client."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        self.received = bytearray()
        self.ended = False
        self._lines: list[bytes] = []
        self._parsed = 0

    def send(self, data: bytes) -> None:
        self.socket.setblocking(True)
        self.socket.sendall(data)

    def lines(self) -> list[bytes]:
        """The complete lines received so far."""
        self.socket.setblocking(False)
        try:
            while data := self.socket.recv(1 << 20):
                self.received += data
            self.ended = True
        except BlockingIOError:
            pass
        except OSError:
            self.ended = True
        *lines, rest = self.received[self._parsed :].split(b"\n")
        self._lines += map(bytes, lines)
        self._parsed = len(self.received) - len(rest)
        return self._lines.copy()

    def has_ended(self) -> bool:
        self.lines()
        return self.ended

    def close(self) -> None:
        self.socket.close()
