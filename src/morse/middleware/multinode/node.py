"""A simulation that is one of several nodes."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

from morse.core.clients.complaints import Complaints
from morse.core.observer import Observer
from morse.core.reports.hints import nearest
from morse.middleware.multinode.connection import ServerConnection
from morse.middleware.multinode.messages import read_answer, read_pose, written_state

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from msgspec import Raw

    from morse.core.context import Context
    from morse.core.values import Options
    from morse.middleware.multinode.messages import Pose, Poses

logger = logging.getLogger(__name__)


class Node(Observer):
    """Sends the poses of the own robots, and moves the robots of other nodes to the poses that the server sends.

    The robots of other nodes stay where they are while there is no server, and while their node does not send.

    Args:
        context: of the simulation.
        options: of ``env.configure_multinode``: ``protocol``, ``server_address``, ``server_port``.
        name: of this node.
        move: moves a robot to x, y, z (world, m) and roll, pitch, yaw (rad); raises an exception for a wrong pose.

    Raises:
        MorseMultinodeError: the protocol is not available, or the server's host is unknown.
    """

    def __init__(self, context: Context, options: Options, name: str, move: Callable[[str, Pose], object]) -> None:
        self._context, self._name, self._move = context, name, move
        self._place = f"{options['server_address']}:{options['server_port']}"
        self._connection = ServerConnection(options["server_address"], int(options["server_port"]))
        self._complaints = Complaints(logger)
        self._sender = context.arrivals.sender()
        self._was_up = False
        self._states: dict[str, bytes] = {}
        logger.info(
            "node '%s': the multi-node server is expected at %s; nodes do not wait for each other, so that a run gives "
            "the same data again only from its recording",
            name,
            self._place,
        )

    def before_tick(self) -> None:
        """Exchange poses with the server."""
        if self._sender.rests:
            return
        answer = self._connection.exchange(self._state)
        self._report()
        if answer is None:
            return
        with self._sender.measured():
            self._take(answer)
        if self._context.paced():
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
        for name, robot in self._context.robots.items():
            pose = robot.position_3d
            poses[name] = (pose.x, pose.y, pose.z), (pose.roll, pose.pitch, pose.yaw)
        clock = self._context.clock
        return written_state(self._name, poses, (clock.time, 1.0 / clock.frequency, time.time()))

    def _apply(self, poses: Mapping[str, Raw]) -> None:
        others = self._context.external_robots
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
        unknown = next((name for name in poses if name not in others and name not in self._context.robots), None)
        if unknown is not None:
            hint = nearest(unknown, list(others))
            self._complaints.warn("unknown", f"another node has a robot {unknown!r:.60}, this scene has not{hint}")

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

    def close(self) -> None:
        """Disconnect."""
        self._connection.close()
