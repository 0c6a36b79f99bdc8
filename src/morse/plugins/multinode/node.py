"""A simulation that is one of several nodes."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import socket
import time
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMultinodeError
from morse.core.journal import SERVICE
from morse.core.reports.quoting import nearest
from morse.plugins.multinode import MANAGER_OPTIONS
from morse.plugins.multinode.messages import MAX_LINE, read_answer, read_pose, written_state
from morse.system.variables import node_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from msgspec import Raw

    from morse.core.context import Context
    from morse.core.values import Options
    from morse.plugins.multinode.messages import Pose, Poses


#: wall-clock seconds between two attempts to connect, and without an answer until the connection is given up
_PAUSE, _PATIENCE = 1.0, 10.0
#: bytes that one tick reads
_MOST_BYTES = 256 << 10
#: the service that places a robot
_PLACE = "set_object_position"
_UNDER_WAY = (errno.EINPROGRESS, errno.EALREADY, errno.EWOULDBLOCK, errno.EAGAIN, errno.EINTR, errno.ENOTCONN)


class ServerConnection:
    """Connects, and connects again; sends a line, and waits for its answer before the next one.

    Args:
        host: of the server.
        port: of the server.
        now: wall-clock time, s.

    Attributes:
        is_up: whether the server has answered since the connection was made.
        problem: why there is no connection; empty if there is one.

    Raises:
        MorseMultinodeError: the name of the host is unknown.
    """

    def __init__(self, host: str, port: int, now: Callable[[], float] = time.monotonic) -> None:
        try:
            address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        except (OSError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise MorseMultinodeError(f"the multi-node server {host}:{port} cannot be found: {reason}") from None
        self._family, self._address = address[0], address[4]
        self._now = now
        self._socket: socket.socket | None = None
        self._unsent = b""
        self._buffer = bytearray()
        self._next_attempt = 0.0
        self._request_time: float | None = None
        self.is_up = False
        self.problem = ""

    def exchange(self, make: Callable[[], bytes]) -> bytes | None:
        """Return the newest answer that has arrived, or None; send the next line if the last one was answered.

        Args:
            make: returns the line to send; called only when it is sent.
        """
        if self._socket is None and not self._connect():
            return None
        try:
            answer = self._read()
            if self._request_time is None and self._socket is not None:
                self._unsent, self._request_time = make(), self._now()
            self._send()
        except OSError as error:
            self._end(error.strerror or type(error).__name__)
            return None
        if self._request_time is not None and self._now() - self._request_time > _PATIENCE:
            self._end("it does not answer")
        return answer

    def _connect(self) -> bool:
        if self._now() < self._next_attempt:
            return False
        self._next_attempt = self._now() + _PAUSE
        sock = socket.socket(self._family, socket.SOCK_STREAM)
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        result = sock.connect_ex(self._address)
        if result not in (0, *_UNDER_WAY):
            sock.close()
            self.problem = os.strerror(result)
            return False
        self._socket = sock
        return True

    def _read(self) -> bytes | None:
        assert self._socket is not None
        failure = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if failure:
            raise OSError(failure, os.strerror(failure))
        try:
            data = self._socket.recv(_MOST_BYTES)
        except OSError as error:
            if error.errno in _UNDER_WAY:
                return None
            raise
        if not data:
            raise ConnectionError(errno.ECONNRESET, "it has closed the connection")
        self._buffer += data
        end = self._buffer.rfind(b"\n")
        if end < 0:
            if len(self._buffer) > MAX_LINE:
                raise ConnectionError(errno.EMSGSIZE, f"its answer is longer than {MAX_LINE} bytes")
            return None
        begin = self._buffer.rfind(b"\n", 0, end) + 1
        line = bytes(self._buffer[begin:end])
        del self._buffer[: end + 1]
        self._request_time = None
        self.is_up, self.problem = True, ""
        return line

    def _send(self) -> None:
        if self._unsent and self._socket is not None:
            try:
                self._unsent = self._unsent[self._socket.send(self._unsent) :]
            except OSError as error:
                if error.errno not in _UNDER_WAY:
                    raise

    def _end(self, problem: str) -> None:
        self.close()
        self.problem = problem

    def close(self) -> None:
        """Disconnect."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None
        self._buffer.clear()
        self._unsent, self._request_time, self.is_up = b"", None, False


logger = logging.getLogger(__name__)


class NodeManager(DatastreamManager):
    """Sends the poses of the own robots, and moves the robots of other nodes to the poses that the server sends.

    The robots of other nodes stay where they are while there is no server, and while their node does not send.

    Raises:
        MorseMultinodeError: the server's host is unknown.
    """

    manager_options = MANAGER_OPTIONS

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._name = node_name()
        host, port = self.options["server_address"], self.options["server_port"]
        self._place = f"{host}:{port}"
        self._connection = ServerConnection(host, port)
        self._complaints = Complaints(logger)
        self._sender = context.arrivals.sender()
        self._was_up = False
        self._states: dict[str, bytes] = {}
        logger.info(
            "node '%s': the multi-node server is expected at %s; nodes do not wait for each other, so that a run gives "
            "the same data again only from its recording",
            self._name,
            self._place,
        )

    def action(self) -> None:
        """Exchange poses with the server."""
        if self._sender.rests:
            return
        answer = self._connection.exchange(self._state)
        self._report()
        if answer is None:
            return
        with self._sender.measured():
            self._take(answer)
        if self.context.paced():
            self._sender.rest_if_due()

    def _take(self, answer: bytes) -> None:
        try:
            poses = read_answer(answer)
        except ValueError as error:
            self._complaints.warn("answer", f"the multi-node server {self._place} sends a wrong message: {error}")
            return
        self._apply(poses)

    def _state(self) -> bytes:
        poses: Poses = {}
        for name, robot in self.context.robots.items():
            pose = robot.position_3d
            poses[name] = (pose.x, pose.y, pose.z), (pose.roll, pose.pitch, pose.yaw)
        clock = self.context.clock
        return written_state(self._name, poses, (clock.time, 1.0 / clock.frequency, time.time()))

    def _apply(self, poses: Mapping[str, Raw]) -> None:
        others = self.context.external_robots
        for name in others:
            text = poses.get(name)
            if text is None or self._states.get(name) == bytes(text):
                continue
            self._states[name] = bytes(text)
            try:
                self._move(name, read_pose(name, text))
            except Exception as error:
                self._complaints.warn("pose", f"the multi-node server sends a wrong pose: {error}")
        # a node may send robots that only its own scene contains
        unknown = next((name for name in poses if name not in others and name not in self.context.robots), None)
        if unknown is not None:
            hint = nearest(unknown, list(others))
            self._complaints.warn("unknown", f"another node has a robot {unknown!r:.60}, this scene has not{hint}")

    def _move(self, name: str, pose: Pose) -> None:
        """Place a robot as a service does: services are inputs that recordings contain."""
        position, angles = map(list, pose)
        simulation: Any = next(one for one in self.context.service_objects if hasattr(one, _PLACE))
        with self.context.journal.input(SERVICE, simulation.name(), (_PLACE, [name, position, angles])):
            getattr(simulation, _PLACE)(name, position, angles)

    def _report(self) -> None:
        is_up = self._connection.is_up
        if is_up and not self._was_up:
            # a server may break every connection
            self._complaints.log(logging.INFO, "connected", f"connected to the multi-node server {self._place}")
        elif not is_up and self._connection.problem:
            self._complaints.warn(
                "absent",
                f"there is no multi-node server at {self._place} ({self._connection.problem}): the robots of other "
                "nodes do not move; to start one: multinode_server",
            )
        self._was_up = is_up

    def restarted(self) -> None:
        """Apply the poses again, because the robots are at their places in the scene."""
        self._states.clear()

    def rearranged(self) -> None:
        """Apply the poses again, because another state may have been restored."""
        self._states.clear()

    def finalize(self) -> None:
        """Disconnect."""
        super().finalize()
        self._connection.close()
