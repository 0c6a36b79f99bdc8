"""Parts of the world with a weather of their own, and the ways of rays through them.

A zone is an upright prism with a convex base: a valley with fog, a tunnel without rain. Lengths are in metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Options
    from morse.plugins.weather.medium import Conditions

    Floats = NDArray[np.floating]

#: greatest number of zones, and of corners of one
MOST_ZONES, MOST_CORNERS = 32, 32
#: m, the farthest place of a corner
_FARTHEST = 1e6
#: m; corners that are nearer to each other, and borders that overlap by less, count as equal
_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Zone:
    """An upright prism.

    Attributes:
        name: of the zone.
        corners: (x, y) of its convex base, counterclockwise.
        top: height of its upper end; infinite for none. It has no lower end.
    """

    name: str
    corners: tuple[tuple[float, float], ...]
    top: float = math.inf

    def half_spaces(self) -> list[tuple[tuple[float, float, float], float]]:
        """Return the borders as (n, c): a place p is within all of them where ``n . p <= c``."""
        borders = []
        for (x, y), (after_x, after_y) in zip(self.corners, (*self.corners[1:], self.corners[0]), strict=True):
            size = math.hypot(after_x - x, after_y - y)
            outward = ((after_y - y) / size, (x - after_x) / size, 0.0)
            borders.append((outward, outward[0] * x + outward[1] * y))
        if math.isfinite(self.top):
            borders.append(((0.0, 0.0, 1.0), self.top))
        return borders

    def contains(self, place: Sequence[float]) -> bool:
        """Whether a place (3,) is within the zone."""
        return all(sum(a * b for a, b in zip(n, place, strict=True)) <= c for n, c in self.half_spaces())

    def overlaps(self, other: Zone) -> bool:
        """Whether the zone and another one have a common part; a common border is none."""
        for n, _ in (*self.half_spaces(), *other.half_spaces()):
            mine = [n[0] * x + n[1] * y for x, y in self.corners]
            theirs = [n[0] * x + n[1] * y for x, y in other.corners]
            if n[2] == 0.0 and (max(mine) <= min(theirs) + _TOLERANCE or max(theirs) <= min(mine) + _TOLERANCE):
                return False
        return True

    def span(self, start: Floats, ways: Sequence[Floats]) -> tuple[Floats, Floats]:
        """Return where rays enter and leave the zone, as distances (...); both are equal for rays that miss it.

        Args:
            start: (3,) of all rays.
            ways: x, y and z (...) of their directions, of length 1.
        """
        enter = np.zeros_like(ways[0])
        leave = np.full_like(ways[0], np.inf)
        for normal, border in self.half_spaces():
            speed = sum(part * way for part, way in zip(normal, ways, strict=True) if part)
            room = border - float(sum(part * place for part, place in zip(normal, start.tolist(), strict=True)))
            with np.errstate(all="ignore"):
                there = np.divide(room, speed)
            outward = speed > 0.0
            np.minimum(leave, there, out=leave, where=outward)
            np.maximum(enter, there, out=enter, where=speed < 0.0)
            if room < 0.0:
                # parallel to the border, outside of it
                leave[speed == 0.0] = 0.0
        return enter, np.maximum(leave, enter)


class Atmosphere(NamedTuple):
    """The weather everywhere at one time.

    Attributes:
        outside: the weather outside of all zones.
        zones: each zone with its weather.
    """

    outside: Conditions
    zones: tuple[tuple[Zone, Conditions], ...] = ()

    @property
    def is_clear(self) -> bool:
        """Whether nothing is in the air, wherever it be."""
        return all(conditions.is_clear for conditions in self.media)

    def at(self, place: Sequence[float]) -> Conditions:
        """Return the weather at a place (3,)."""
        return self.media[self.number_at(place)]

    @property
    def media(self) -> tuple[Conditions, ...]:
        """The weather outside of all zones, and then that of each zone."""
        return self.outside, *(conditions for _, conditions in self.zones)

    def number_at(self, place: Sequence[float]) -> int:
        """Return the number among the media of that at a place (3,)."""
        return next((number for number, (zone, _) in enumerate(self.zones, start=1) if zone.contains(place)), 0)

    def along(
        self, start: Floats, ways: Sequence[Floats], lengths: Floats, per_metre: Callable[[Conditions], float]
    ) -> Floats:
        """Return the integral of a quantity along rays (...), e.g. the optical depth.

        Args:
            start: (3,) of all rays.
            ways: x, y and z (...) of their directions, of length 1.
            lengths: (...) of the rays, finite.
            per_metre: returns the quantity per metre.
        """
        around = per_metre(self.outside)
        total = around * lengths
        for zone, conditions in self.zones:
            if difference := per_metre(conditions) - around:
                enter, leave = zone.span(start, ways)
                total += difference * np.maximum(np.minimum(leave, lengths) - enter, 0.0)
        return total


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number that fits into a float."""
    # an integer of more bits is greater than all floats
    is_huge = isinstance(value, int) and value.bit_length() > 1000
    return isinstance(value, Real) and not isinstance(value, bool) and not is_huge


def checked_zone(options: Options, others: Sequence[Zone], fail: Callable[[str], Exception]) -> Zone:
    """Return the zone of a script: its ``zone`` (a name), ``area`` and ``height``.

    Raises:
        Exception: the result of ``fail``, for a message.
    """
    name, area, height = options["zone"], options["area"], options["height"]
    if not isinstance(name, str) or not name.strip():
        raise fail(f"zone={name!r:.60}: expected the name of the zone")
    if any(other.name == name for other in others):
        raise fail(f"there is a zone {name!r:.60} already; change its weather with schedule={{seconds: {{...}}}}")
    if len(others) >= MOST_ZONES:
        raise fail(f"there are {MOST_ZONES} zones at most")
    if height is not None and not (is_number(height) and abs(height) <= _FARTHEST):
        raise fail(
            f"height={height!r:.60}: expected the height of the top of zone {name!r:.60} in the world, m, or None"
        )
    corners = _corners(name, area, fail)
    zone = Zone(name, corners, math.inf if height is None else float(height))
    for other in others:
        if zone.overlaps(other):
            raise fail(f"the zones {other.name!r:.60} and {name!r:.60} overlap: a place has one weather")
    return zone


def _corners(name: str, area: object, fail: Callable[[str], Exception]) -> tuple[tuple[float, float], ...]:
    expected = "expected two opposite corners [(x, y), (x, y)] of a rectangle, or the corners of a convex polygon, m"
    given = list(area) if isinstance(area, (list, tuple, np.ndarray)) else []
    points = []
    for each in given[: MOST_CORNERS + 1]:
        pair = list(each) if isinstance(each, (list, tuple, np.ndarray)) else []
        if len(pair) != 2 or not all(is_number(part) and abs(part) <= _FARTHEST for part in pair):
            raise fail(f"area of zone {name!r:.60}: {expected}, not the corner {each!r:.60}")
        points.append((float(pair[0]), float(pair[1])))
    if len(points) == 2:
        (x, y), (far_x, far_y) = points
        points = [(x, y), (far_x, y), (far_x, far_y), (x, far_y)]
    if not 3 <= len(points) <= MOST_CORNERS:
        raise fail(f"area={area!r:.60}: {expected}, at most {MOST_CORNERS}")
    edges = np.roll(points, -1, axis=0) - np.array(points)
    after = np.roll(edges, -1, axis=0)
    # twice the area of the triangle of each corner, and the angle by which the border turns there
    cross = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    turning = sum(math.atan2(c, d) for c, d in zip(cross.tolist(), (edges * after).sum(axis=1).tolist(), strict=True))
    # a star turns one way as well, but more than once around
    is_convex = (np.all(cross > -_TOLERANCE) or np.all(cross < _TOLERANCE)) and 6.0 < abs(turning) < 7.0
    if not is_convex or np.min(np.abs(edges).max(axis=1)) < _TOLERANCE or np.max(np.abs(cross)) < _TOLERANCE:
        raise fail(f"area of zone {name!r:.60}: its corners do not bound a convex polygon; write several zones")
    return tuple(points if turning > 0.0 else points[::-1])
