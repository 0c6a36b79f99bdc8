"""Quality of service of topics."""

from __future__ import annotations

from typing import NamedTuple


class Qos(NamedTuple):
    """Quality of service of a topic.

    Attributes:
        depth: number of messages that are kept.
        reliable: lost messages are sent again.
        latched: a subscriber that joins later gets the last messages, too (durability transient local).
        history: number of large messages that a writer of DDS keeps for readers that are behind; 0 for its usual one.
    """

    depth: int = 10
    reliable: bool = True
    latched: bool = False
    history: int = 0
