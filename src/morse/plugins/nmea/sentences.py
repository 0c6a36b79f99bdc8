"""NMEA 0183 sentences of a position on the earth."""

from __future__ import annotations

import math
import time

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
