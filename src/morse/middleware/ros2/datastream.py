"""Publishes data streams as topics of ROS 2, and the state of all components as ``/diagnostics``."""

from __future__ import annotations

import logging
from time import monotonic
from typing import TYPE_CHECKING

from morse.middleware.ros2 import MANAGER_OPTIONS, NODE
from morse.middleware.ros2.domain import join
from morse.rosmsgs.names import ROS2_MANAGER, robot_of
from morse.rosmsgs.parts import header_at
from morse.rosmsgs.table import Qos
from morse.rosmsgs.topics.manager import TopicManager

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from morse.core.context import Context
    from morse.core.values import Options, RosMessage
    from morse.rosmsgs.topics.backend import Backend


TYPE = "diagnostic_msgs/msg/DiagnosticArray"
_PERIOD = 10**9
#: constants of diagnostic_msgs/DiagnosticStatus
_OK, _WARN, _ERROR = 0, 1, 2


class Diagnostics:
    """Publishes the topic.

    Args:
        manager: publishes it.
    """

    def __init__(self, manager: Ros2DatastreamManager) -> None:
        self._manager = manager
        self._publisher = manager.own("/diagnostics", TYPE, Qos(1), "the simulation")
        self._period, self._last = -1, (0, 0.0)

    def publish(self) -> None:
        """Send the state at the first tick of each simulated second."""
        stamp = self._manager.context.clock.stamp()
        if self._publisher is None or stamp // _PERIOD == self._period:
            return
        self._period = stamp // _PERIOD
        (before, start), self._last = self._last, (stamp, monotonic())
        if not self._publisher.wanted():
            return
        took = self._last[1] - start
        speed = (stamp - before) / _PERIOD / took if before and took > 0.0 else None
        states = [_of_simulation(self._manager.context, speed), *_of_components(self._manager.context)]
        self._manager.tell(self._publisher, TYPE, {"header": header_at(stamp, ""), "status": states})

    def close(self) -> None:
        """Close the topic."""
        if self._publisher is not None:
            self._publisher.close()


def _of_simulation(context: Context, speed: float | None) -> RosMessage:
    failures = sorted(context.failed)
    text = f"{', '.join(failures)} failed" if failures else "running"
    values = {"tick": context.clock.tick, "simulator frequency (Hz)": context.clock.frequency}
    if speed is not None:
        values["real-time factor"] = round(speed, 3)
    return _status("morse: simulation", _WARN if failures else _OK, text, "morse", values)


def _of_components(context: Context) -> Iterator[RosMessage]:
    for name, component in [*context.robots.items(), *context.components.items()]:
        if name in context.failed:
            level, text = _ERROR, "deactivated after an error: see /rosout"
        elif not component.active:
            level, text = _WARN, "deactivated"
        else:
            level, text = _OK, "active"
        values = {"class": type(component).__name__, "frequency (Hz)": component.frequency, "level": component.level}
        service = component.running_service
        if service:
            values["service"] = service
        yield _status(f"morse: {name}", level, text, robot_of(component).name(), values)


def _status(name: str, level: int, text: str, hardware: str, values: Mapping[str, object]) -> RosMessage:
    pairs = [{"key": key, "value": str(value)} for key, value in values.items()]
    return {"level": level, "name": name, "message": text, "hardware_id": hardware, "values": pairs}


logger = logging.getLogger(__name__)

#: number of ticks after which other simulations are looked for again
_LOOK = 30


class Ros2DatastreamManager(TopicManager):
    """Topics of ROS 2, with simulated time and the tree of frames.

    Options of ``env.configure_stream_manager('ros2', ...)`` are in `morse.middleware.ros2`.
    """

    classpath = ROS2_MANAGER
    manager_options = MANAGER_OPTIONS
    title = "ros2"

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._diagnostics = Diagnostics(self) if self.options["diagnostics"] else None
        self._ticks, self._is_alone = 0, True

    def _make_backend(self) -> Backend:
        return join(self.context, self.options)

    def flush(self) -> None:
        """See `TopicManager.flush`."""
        if self._diagnostics is not None:
            self._diagnostics.publish()
        self._ticks += 1
        if self._is_alone and self._ticks % _LOOK == 0 and self.backend.has_namesake():
            self._is_alone = False
            logger.warning(
                "ros2: another simulation of this domain has a node /%s as well (%s): both publish /clock, /tf and the "
                "topics of robots with the same name, and both obey their commands; set another ROS_DOMAIN_ID for one "
                "of them, or env.configure_stream_manager('ros2', domain_id=...)",
                NODE,
                self.backend.opens,
            )
        super().flush()

    def finalize(self) -> None:
        """See `TopicManager.finalize`."""
        if self._diagnostics is not None:
            self._diagnostics.close()
        super().finalize()
