"""One message of a topic in the forms that clients ask for; each form is made once, for all of them."""

from __future__ import annotations

import base64
import io
import math
from functools import cached_property
from typing import TYPE_CHECKING

import msgspec
from PIL import Image

from morse.middleware.rosbridge import cbor, json_form
from morse.rosmsgs import cdr

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.values import RosMessage
    from morse.middleware.web.topics import WebTopic

_CHANNELS = 3


def as_png(frame: str) -> str:
    """A message whose characters are the colours of an image.

    Source: pngcompression.py of rosbridge_suite: RGB, about as high as wide; blanks at the end.
    """
    data = frame.encode()
    width = math.isqrt(max(1, math.ceil(len(data) / _CHANNELS)))
    height = math.ceil(len(data) / (width * _CHANNELS))
    image = Image.frombytes("RGB", (width, height), data.ljust(width * height * _CHANNELS))
    file = io.BytesIO()
    image.save(file, "PNG", compress_level=1)  # in the network thread
    return msgspec.json.encode({"op": "png", "data": base64.b64encode(file.getvalue()).decode()}).decode()


_SECOND = 10**9
#: the compressions that clients may ask for; of several subscriptions to a topic, the last of these counts
COMPRESSIONS = ("none", "png", "cbor", "cbor-raw")


class Forms:
    """The operation ``publish`` of a message.

    Args:
        topic: of the message.
        stamp: simulated time, ns.
        data: the message in CDR.
    """

    def __init__(self, topic: WebTopic, stamp: int, data: bytes) -> None:
        self._topic, self._stamp, self._data = topic, stamp, data

    def frame(self, compression: str) -> str | bytes:
        """The message in one of `COMPRESSIONS`."""
        frames: Mapping[str, str] = {"none": "_text", "png": "_png", "cbor": "_cbor", "cbor-raw": "_raw"}
        frame: str | bytes = getattr(self, frames[compression])
        return frame

    @cached_property
    def _message(self) -> RosMessage:
        return cdr.decode(self._topic.type, self._data)

    @cached_property
    def _text(self) -> str:
        name = msgspec.json.encode(self._topic.topic).decode()
        message = json_form.encode(self._topic.type, self._message).decode()
        return f'{{"op":"publish","topic":{name},"msg":{message}}}'

    @cached_property
    def _png(self) -> str:
        return as_png(self._text)

    def _packed(self, message: object) -> bytes:
        return cbor.encode({"op": "publish", "topic": self._topic.topic, "msg": message})

    @cached_property
    def _cbor(self) -> bytes:
        return self._packed(self._message)

    @cached_property
    def _raw(self) -> bytes:
        seconds, rest = divmod(self._stamp, _SECOND)
        return self._packed({"secs": seconds, "nsecs": rest, "bytes": self._data})
