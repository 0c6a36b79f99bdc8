"""The log of the simulation as ``/rosout`` of ROS 1."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from morse.rosmsgs.parts import header_at
from morse.rosmsgs.qos import Qos
from morse.rosmsgs.topics.rosout import LogTopic, text_of

if TYPE_CHECKING:
    import logging

    from morse.core.values import RosMessage

#: levels of rosgraph_msgs/Log are powers of two, from DEBUG on
_LEVELS, _STEP = (1, 2, 4, 8, 16), 10


class LogTopicOfRos1(LogTopic):
    """Publishes log records of MORSE on the topic that the node of rospy has in any case."""

    type: ClassVar = "rosgraph_msgs/msg/Log"
    qos: ClassVar = Qos(1000)

    def message(self, record: logging.LogRecord, stamp: int) -> RosMessage:
        """See `LogTopic.message`."""
        return {
            "header": header_at(stamp, ""),
            "level": _LEVELS[min(max(record.levelno // _STEP - 1, 0), len(_LEVELS) - 1)],
            "name": record.name,
            "msg": text_of(record),
            "file": record.pathname,
            "function": record.funcName or "",
            "line": record.lineno,
        }
