"""The log of the simulation as ``/rosout``."""

from __future__ import annotations

import logging
from collections import deque
from typing import TYPE_CHECKING, ClassVar

from morse.rosmsgs.parts import time
from morse.rosmsgs.table import Qos

if TYPE_CHECKING:
    from morse.core.values import RosMessage
    from morse.rosmsgs.topics.backend import Publisher
    from morse.rosmsgs.topics.manager import TopicManager

#: levels of rcl_interfaces/Log are those of logging
_STEP, _LEAST, _MOST = 10, 10, 50
#: maximum number of lines that wait for the end of a tick, and that one tick sends
_WAITING, _EACH_TICK = 1000, 64


logger = logging.getLogger(__name__)


class LogTopic(logging.Handler):
    """Collects log records of MORSE in any thread, and publishes them between two ticks.

    Args:
        manager: publishes the topic.

    Attributes:
        type: of the messages.
        qos: of the topic.
        lines: unsent lines.
    """

    type: ClassVar = "rcl_interfaces/msg/Log"
    #: later subscribers receive the last lines, as from every ROS node
    qos: ClassVar = Qos(_WAITING, latched=True)

    def __init__(self, manager: TopicManager) -> None:
        super().__init__()
        self._manager = manager
        self._losses = 0
        self.lines: deque[logging.LogRecord] = deque(maxlen=_WAITING)
        self._publisher: Publisher | None = manager.own("/rosout", self.type, self.qos, "the simulation")
        if self._publisher is not None:
            logging.getLogger("morse").addHandler(self)

    @property
    def waiting(self) -> bool:
        """Whether there are unsent lines."""
        return bool(self.lines)

    def emit(self, record: logging.LogRecord) -> None:
        """See `logging.Handler.emit`."""
        self._losses += len(self.lines) == self.lines.maxlen
        self.lines.append(record)

    def publish(self, stamp: int) -> None:
        """Send the logged lines.

        Args:
            stamp: simulated time, ns.
        """
        if self._losses:
            losses, self._losses = self._losses, 0
            logger.warning("%s lines of the log are not on /rosout: too many were logged in a tick", losses)
        for _ in range(min(len(self.lines), _EACH_TICK)):
            self._manager.tell(self._publisher, self.type, self.message(self.lines.popleft(), stamp))

    def message(self, record: logging.LogRecord, stamp: int) -> RosMessage:
        """A log record as a message, at a simulated time, ns."""
        return {
            "stamp": time(stamp),
            "level": min(max(record.levelno // _STEP * _STEP, _LEAST), _MOST),
            "name": record.name,
            "msg": text_of(record),
            "file": record.pathname,
            "function": record.funcName or "",
            "line": record.lineno,
        }

    def close(self) -> None:
        """Stop collecting."""
        logging.getLogger("morse").removeHandler(self)
        if self._publisher is not None:
            self._publisher.close()
        super().close()


def text_of(record: logging.LogRecord) -> str:
    """The text of a log record."""
    try:
        return record.getMessage()
    except Exception:  # arguments that do not fit the format: logging reports it elsewhere
        return str(record.msg)
