"""Checks the packets of a MOOS database: the sizes in a packet decide how much memory it takes to read it.

A packet is its size, the number of its messages, a byte for compression, and the messages. A message is its size, an
id, two bytes for its type, four strings, three numbers, and one more string. All integers are little-endian.
"""

from __future__ import annotations

import struct

#: bytes of the header of a packet
HEADER = 9
_SIZE = struct.Struct("<i")
#: bytes of a message before the first string, and bytes before each string, in addition to its size
_LEAD, _BEFORE_STRINGS = 10, (0, 0, 0, 0, 24)


def check_packet(data: bytes, most: int) -> None:
    """Check that each message of a packet, and each string of a message, is inside of it.

    Otherwise the same bytes could be read again and again: a packet of 70 bytes announced two billion messages.

    Args:
        data: the packet.
        most: maximum number of messages.

    Raises:
        ValueError: it is not such a packet.
        struct.error: it ends too early.
    """
    (count,) = _SIZE.unpack_from(data, 4)
    if not 0 <= count <= most:
        raise ValueError(f"{count} messages in a packet, at most {most} are allowed")
    begin = HEADER
    for _ in range(count):
        end = begin + _SIZE.unpack_from(data, begin)[0]
        at = begin + _LEAD
        for numbers in _BEFORE_STRINGS:
            at += numbers
            (length,) = _SIZE.unpack_from(data, at)
            at += _SIZE.size + length
            if length < 0 or at > end:
                raise ValueError(f"a string of {length} bytes is not inside of its message")
        if end > len(data):
            raise ValueError("a message is longer than its packet")
        begin = end
