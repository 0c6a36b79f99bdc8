"""Sentences of NMEA 0183, and their receivers: a port for each GPS, and a serial line if a script wants one."""

from __future__ import annotations

import calendar
import errno
import logging
import math
import os
import sys
import time
from typing import TYPE_CHECKING

from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds import bind
from morse.core.mapping import maps
from morse.plugins.nmea import MANAGER_OPTIONS, STREAM_OPTIONS
from morse.wire.lines import LineClient
from morse.wire.listener import listen, port_of
from morse.wire.server import LineServer

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.streams.kind_stream import KindStream
    from morse.core.values import Options

#: m/s in a knot
_KNOT = 1852.0 / 3600.0


def sentence(body: str) -> bytes:
    """A sentence with its checksum, the exclusive or of all characters between ``$`` and ``*``."""
    checksum = 0
    for character in body.encode("ascii", "replace"):
        checksum ^= character
    return f"${body}*{checksum:02X}\r\n".encode("ascii", "replace")


def angle(degrees: float, letters: str) -> str:
    """A latitude (``NS``) or longitude (``EW``): degrees, minutes to 1e-5 (2 cm), and the letter of the hemisphere."""
    width = 2 if letters == "NS" else 3
    # whole units of the last digit: 59.999999 minutes are no 60.00000
    units = round(abs(degrees) * 60.0 * 1e5)
    minutes, whole = units % (60 * 10**5), units // (60 * 10**5)
    return f"{whole:0{width}d}{minutes / 1e5:08.5f},{letters[degrees < 0.0]}"


def sentences(
    talker: str,
    seconds: float,
    longitude: float,
    latitude: float,
    altitude: float,
    velocity: tuple[float, float, float] | None,
) -> bytes:
    """GGA, and with a velocity RMC and VTG.

    Args:
        seconds: UTC since 1970.
        longitude, latitude: degrees.
        altitude: above the ellipsoid, m; the separation of the geoid is 0, since MORSE has no geoid.
        velocity: to the east, to the north and up, m/s; None if it is not measured.
    """
    # a receiver counts hundredths, also where rounding would give the next day
    hundredths = round(seconds * 100.0)
    utc = time.gmtime(hundredths // 100)
    clock = f"{time.strftime('%H%M%S', utc)}.{hundredths % 100:02d}"
    place = f"{angle(latitude, 'NS')},{angle(longitude, 'EW')}"
    lines = [f"{talker}GGA,{clock},{place},1,12,1.0,{altitude:.3f},M,0.0,M,,"]
    if velocity is not None:
        east, north, _ = velocity
        speed = math.hypot(east, north)
        course = f"{math.degrees(math.atan2(east, north)) % 360.0:.2f}" if speed > 1e-3 else ""
        lines.append(f"{talker}RMC,{clock},A,{place},{speed / _KNOT:.3f},{course},{time.strftime('%d%m%y', utc)},,,A")
        lines.append(f"{talker}VTG,{course},T,,M,{speed / _KNOT:.3f},N,{speed * 3.6:.3f},K,A")
    return b"".join(map(sentence, lines))


logger = logging.getLogger(__name__)

_NANO = 1e-9
#: ports that are tried after that of the first receiver
_PORTS = 64


class _Reader(LineClient):
    """A program that reads sentences; what it sends, such as settings for a receiver, has no effect."""

    def importance(self) -> tuple[float, ...]:
        """If there are too many, those that do not read leave first, then the newest."""
        return (not self.congested, -self._since)

    def __init__(self, server: LineServer) -> None:
        super().__init__(server)
        self._since = self.heard

    def data_received(self, data: bytes) -> None:
        """Drop it, also without ends of lines."""
        self.is_welcome(data)

    def eof_received(self) -> bool:
        """Keep the connection: who has nothing to send may close this side, and reads on; else the next write fails."""
        return True


class Receiver:
    """A port, and possibly a serial line, of one GPS.

    Attributes:
        port: of TCP.
        path: of the serial line, for programs that read it; empty for none.
    """

    def __init__(self, name: str, context: Context, ports: range, options: Options) -> None:
        self._network = context.network
        listener = listen(context.host, ports)
        self.port = port_of(listener)
        self._line, self._far, self.path = -1, -1, ""
        try:
            if options["device"]:
                self._line, self._far, self.path = _serial(str(options["device"]), int(options["baud"]))
        except BaseException:
            listener.close()
            raise
        self._server = LineServer(f"nmea: {name}", listener, _Reader)
        self._network.call(self._server.start(self._network))

    @property
    def is_read(self) -> bool:
        """Whether a client is connected, or there is a serial line."""
        return self._server.connected > 0 or self._line >= 0

    def send(self, data: bytes) -> None:
        """Send sentences to all clients that keep up; a full serial line drops them."""
        if self._server.connected:
            self._network.post(self._write, data)
        if self._line >= 0 and not self._is_written(data) and self._far >= 0 and sys.platform != "win32":
            # a pseudo-terminal that nobody reads: who opens it later gets no positions of long ago
            import termios

            termios.tcflush(self._far, termios.TCIFLUSH)
            self._is_written(data)

    def _is_written(self, data: bytes) -> bool:
        """Write to the serial line; return whether it has taken everything: it may be full, slow or unplugged."""
        try:
            return os.write(self._line, data) == len(data)
        except OSError as error:
            if error.errno not in (errno.EAGAIN, errno.EIO, errno.ENODEV, errno.ENXIO):
                raise
            return False

    def _write(self, data: bytes) -> None:
        for client in list(self._server.clients):
            if not client.congested:
                client.transport.write(data)

    def close(self) -> None:
        """Disconnect all clients and close the line."""
        self._network.call(self._server.close())
        for descriptor in (self._line, self._far):
            if descriptor >= 0:
                os.close(descriptor)
        self._line = self._far = -1


def _serial(device: str, baud: int) -> tuple[int, int, str]:
    """Open a serial line without echo or conversions of line ends; `device` may be ``pty``.

    Returns:
        The descriptor to write to, the other end of a pseudo-terminal, which stays open so that readers may come and
        go, or -1, and the path.

    Raises:
        MorseMiddlewareError: it cannot be opened, or is no serial line.
    """
    try:
        import termios
        import tty
    except ImportError:
        raise MorseMiddlewareError("nmea: serial lines need Linux or macOS; TCP works everywhere") from None
    far = -1
    try:
        if device == "pty":
            line, far = os.openpty()
            device, own = os.ttyname(far), far
        else:
            line = own = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise MorseMiddlewareError(f"nmea: the device '{device:.200}' cannot be opened: {error.strerror}") from None
    try:
        os.set_blocking(line, False)
        tty.setraw(own)
        rate = getattr(termios, f"B{baud}", None)
        if rate is None:
            raise MorseMiddlewareError(f"nmea: serial lines do not have the rate baud={baud}; usual are 4800 and 38400")
        settings = termios.tcgetattr(own)
        settings[4] = settings[5] = rate
        termios.tcsetattr(own, termios.TCSANOW, settings)
    except (termios.error, OSError):
        os.close(line)
        raise MorseMiddlewareError(
            f"nmea: '{device:.200}' is not a serial line; expected a device such as /dev/ttyUSB0, or 'pty'"
        ) from None
    except MorseMiddlewareError:
        for descriptor in (line, far):
            if descriptor >= 0:
                os.close(descriptor)
        raise
    return line, far, device


class NmeaManager(DatastreamManager):
    """GGA, RMC and VTG of each GPS, on a port of its own.

    The sentences have the time of the simulation, as UTC. Altitudes are those above the ellipsoid.
    """

    manager_options = MANAGER_OPTIONS

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        #: by name of the component
        self.receivers: dict[str, Receiver] = {}

    def opened(self, stream: KindStream) -> None:
        """Open the receiver of a component.

        Raises:
            MorseMiddlewareError: the component has no position on the earth, or a port or device is not to be had.
        """
        name = stream.component_name
        if not any(bound.kind.name == "fix" for bound in bind(stream.component_instance)):
            raise MorseMiddlewareError(
                f"nmea: {name} has no position on the earth: it takes a GPS, and env.properties(longitude=..., "
                "latitude=..., altitude=...)"
            )
        if name in self.receivers:
            return
        options = {key: stream.kwargs.get(key, option.default) for key, option in STREAM_OPTIONS.items()}
        if options["port"] is not None:
            ports = range(int(options["port"]), int(options["port"]) + 1)
        elif self.options["port"] == 0:
            ports = range(1)
        else:
            first = int(self.options["port"])
            ports = range(first, min(first + _PORTS, 65536))
        receiver = self.receivers[name] = Receiver(name, self.context, ports, options)
        line = f" and on {receiver.path}" if receiver.path else ""
        logger.info("nmea: %s sends NMEA 0183 on port %d%s", name, receiver.port, line)

    def left(self, name: str) -> None:
        """Close the receiver of a component that is deleted."""
        if receiver := self.receivers.pop(name, None):
            receiver.close()

    def wanted(self, stream: KindStream, topic: str) -> bool:
        """Whether anybody may read the sentences."""
        receiver = self.receivers.get(stream.component_name)
        return receiver is not None and receiver.is_read

    @maps("general")
    def general(self, stream: KindStream, message: Message) -> None:
        """Nothing: other kinds of a component with a position on the earth have no sentences."""

    @maps("fix")
    def fix(self, stream: KindStream, message: Message) -> bytes:
        """The sentences of a position on the earth."""
        slots = message.slots
        velocity, utc = slots.get("velocity"), slots.get("utc")
        seconds = message.stamp * _NANO
        if utc:
            # the date; the time is finer in the stamp
            seconds = calendar.timegm(time.strptime(utc, "%Y-%m-%dT%H:%M:%SZ")) + seconds % 1.0
        return sentences(
            str(stream.kwargs.get("talker", "GP"))[:2],
            seconds,
            float(slots["longitude"]),
            float(slots["latitude"]),
            float(slots["altitude"]),
            None if velocity is None else (float(velocity[0]), float(velocity[1]), float(velocity[2])),
        )

    def send(self, stream: KindStream, payload: bytes) -> None:
        """Send the sentences of a measurement."""
        receiver = self.receivers.get(stream.component_name)
        if receiver is not None:
            receiver.send(payload)

    def finalize(self) -> None:
        """Close all receivers."""
        super().finalize()
        for name in list(self.receivers):
            self.left(name)
