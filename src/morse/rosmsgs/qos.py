"""Quality of service of topics."""

from __future__ import annotations

from typing import NamedTuple


class Qos(NamedTuple):
    """Quality of service of a topic.

    Attributes:
        depth: number of messages that are kept.
        reliable: lost messages are sent again.
        latched: a subscriber that joins later gets the last messages, too (durability transient local).
    """

    depth: int = 10
    reliable: bool = True
    latched: bool = False
