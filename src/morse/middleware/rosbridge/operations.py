"""The operations of rosbridge clients: version 2 of the protocol."""

from __future__ import annotations

import msgspec

Raw = msgspec.Raw


class Operation(msgspec.Struct):
    """An operation; fields that it does not use are ignored.

    Attributes:
        op: name of the operation.
        id: chosen by the client; responses contain it, too.
    """

    op: str
    id: str | int | None = None
    topic: str | None = None
    type: str | None = None
    msg: Raw = Raw()
    throttle_rate: float = 0.0
    queue_length: float = 0.0
    service: str | None = None
    args: Raw = Raw()
    level: str | None = None
    compression: str | None = None
    action: str | None = None
    fragment_size: float | None = None
    data: str = ""
    num: int = 0
    total: int = 0


def parse(frame: str | bytes) -> Operation:
    """Parse the operation of a message.

    Raises:
        ValueError: it is not a valid operation.
    """
    try:
        return _decoder.decode(frame)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise ValueError(f"not an operation of rosbridge: {error}") from None


_decoder = msgspec.json.Decoder(Operation)
