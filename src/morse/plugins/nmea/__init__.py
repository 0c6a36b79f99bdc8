"""Positions on the earth as NMEA 0183 sentences, over TCP and serial lines."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

#: the port of NMEA 0183 by the IANA registry
PORT = 10110

MANAGER_OPTIONS = {
    "port": Option(int, PORT, "port of the first receiver; 0 for any free one", low=0, high=65535),
}
STREAM_OPTIONS = {
    "port": Option(int, None, "port of this receiver; by default the next one", low=0, high=65535),
    "device": Option(str, "", "serial device as well, such as /dev/ttyUSB0; 'pty' for a new pseudo-terminal"),
    "baud": Option(int, 4800, "rate of the serial device", low=50, high=4_000_000),
    "talker": Option(str, "GP", "first two letters of the sentences: GP, GN, GL, GA, …"),
}

MIDDLEWARE = Middleware(
    name="nmea",
    stream_manager="morse.plugins.nmea.datastream.NmeaManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_reader=None,
    kinds=("fix",),
    purpose="NMEA 0183 sentences of GPS receivers, over TCP and serial lines",
)
