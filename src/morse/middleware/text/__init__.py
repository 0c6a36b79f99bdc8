"""The data of sensors as text files."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

STREAM_OPTIONS = {"file": Option(str, None, "path of the file; default: the name of the component and .txt")}

MIDDLEWARE = Middleware(
    name="text",
    stream_manager="morse.middleware.text_datastream.TextDatastreamManager",
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.middleware.text_datastream.Publisher",
    default_reader=None,
    needs_network=False,
    # images and clouds would be megabytes in each tick
    not_carried=("Camera", "CameraUnit"),
)
