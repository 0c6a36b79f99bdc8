"""Ranges and bearings to known transponders: USBL, UWB, RFID."""

from __future__ import annotations

import math
from typing import Any

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_property
from morse.plugins.senses.scanning import number_of
from morse.plugins.senses.sources import sources, walls


class USBL(Sensor):
    """Measures distance and direction of acoustic transponders: objects with the property ``usbl_beacon``.

    With ``errors``, the distance has the deviation ``range_error`` as a share of it, and the angles ``angle_error``.
    ``max_range`` is the largest distance; a transponder behind an object is not heard.
    """

    _name = "USBL"
    _short_desc = "Ultra-short baseline: distance and direction of transponders"
    _builder = BuilderDefaults(frequency=1.0, visual=Visual("cylinder", (0.05, 0.05, 0.1), (0.9, 0.8, 0.1)))
    _products = (
        BuilderDefaults(
            "SeaTracX150",
            frequency=1.0,
            visual=Visual("cylinder", (0.028, 0.028, 0.08), (0.1, 0.1, 0.1)),
            properties={"max_range": 1000.0, "angle_error": 1.0, "range_error": 0.0001, "errors": True},
            doc="A Blueprint Subsea SeaTrac X150: 1 km, 1 degree.",
            source="data sheet of the SeaTrac X150 (Blueprint Subsea): range, bearing resolution",
        ),
    )

    add_data(
        "fixes", [], "list<objects>", "Dictionaries with name, range (m), azimuth and elevation (rad)", frame="own"
    )
    add_property("max_range", 500.0, "max_range", "float", "Largest distance", unit="m", low=1.0, high=1e5)
    add_property("angle_error", 1.0, "angle_error", "float", "Deviation of the angles", unit="deg", low=0.0, high=90.0)
    add_property("range_error", 0.001, "range_error", "float", "Deviation, share of the distance", low=0.0, high=1.0)
    add_property("errors", False, "errors", "bool", "With the errors of a real one")

    max_range: float
    angle_error: float
    range_error: float
    errors: bool

    def measure(self) -> None:
        """Measure all transponders."""
        fixes: list[dict[str, Any]] = []
        for source in sources(self, "usbl_beacon"):
            if source.distance > self.max_range or walls(self, source.body):
                continue
            errors = (0.0, 0.0, 0.0)
            if self.errors:
                errors = tuple(self.tick_random(source.body.name).standard_normal(3).tolist())
            angle = math.radians(self.angle_error)
            fixes.append(
                {
                    "name": source.body.name,
                    "range": source.distance * max(1.0 + self.range_error * errors[0], 0.0),
                    "azimuth": math.remainder(source.azimuth + angle * errors[1], 2.0 * math.pi),
                    "elevation": source.elevation + angle * errors[2],
                }
            )
        self.local_data["fixes"] = fixes

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()


class UWB(Sensor):
    """Measures distances of ultra-wideband anchors: objects with the property ``uwb_anchor``.

    A wall of the thickness d delays the pulse: the distance is too large by (√ε - 1) d (D. Dardari et al., "Ranging
    with ultrawide bandwidth signals in multipath environments", Proc. IEEE 97, 2009). ε is the property
    ``permittivity`` of the object, 5.3 without it (concrete, ITU-R P.2040). Each wall also costs ``wall_loss`` of the
    ``link_margin`` at 1 m, as the distance does by 20 log r.
    """

    _name = "UWB"
    _short_desc = "Distances of ultra-wideband anchors, with the bias of walls"
    _source = "Dardari et al. 2009; ITU-R P.2040"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cube", (0.01, 0.02, 0.02), (0.1, 0.3, 0.1)))

    add_data("ranges", [], "list<objects>", "Dictionaries with name, range (m) and los (whether nothing is between)")
    add_property("link_margin", 40.0, "link_margin", "float", "At 1 m", unit="dB", low=0.0, high=200.0)
    add_property("wall_loss", 8.0, "wall_loss", "float", "By an object between", unit="dB", low=0.0, high=200.0)
    add_property("deviation", 0.1, "deviation", "float", "Of the distance, with errors", unit="m", low=0.0, high=100.0)
    add_property("errors", False, "errors", "bool", "With noise")

    link_margin: float
    wall_loss: float
    deviation: float
    errors: bool

    def measure(self) -> None:
        """Measure the distances of all anchors."""
        ranges: list[dict[str, Any]] = []
        for source in sources(self, "uwb_anchor"):
            between = walls(self, source.body)
            loss = 20.0 * math.log10(max(source.distance, 0.01)) + self.wall_loss * len(between)
            if loss > self.link_margin:
                continue
            distance = source.distance
            for wall in between:
                distance += (math.sqrt(number_of(wall.body, "permittivity", 5.3, 1.0, 100.0)) - 1.0) * wall.thickness
            if self.errors:
                distance += self.deviation * float(self.tick_random(source.body.name).standard_normal())
            ranges.append({"name": source.body.name, "range": max(distance, 0.0), "los": not between})
        self.local_data["ranges"] = ranges

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()


class RFIDReader(Sensor):
    """Reads RFID tags: objects with the property ``rfid``, which is what they say.

    A passive tag answers if the power that reaches it suffices: P + G - 20 log(4 π r f / c) - ``wall_loss`` for each
    object between is at least ``tag_sensitivity`` (free space, H. Friis, Proc. IRE 34, 1946), and if it is in the beam.
    """

    _name = "RFID reader"
    _short_desc = "Reads tags in its beam"
    _source = "Friis 1946"
    _builder = BuilderDefaults(frequency=5.0, visual=Visual("cube", (0.01, 0.1, 0.1), (0.9, 0.9, 0.9)))

    add_data(
        "tags", [], "list<objects>", "Dictionaries with name, id and power (dBm) at the tag, in the order of the scene"
    )
    add_property("carrier", 866e6, "carrier", "float", "Frequency", unit="Hz", low=1e5, high=1e11)
    add_property(
        "power", 36.0, "power", "float", "Radiated, with the gain of the antenna", unit="dB", low=-50.0, high=80.0
    )
    add_property(
        "tag_sensitivity", -18.0, "tag_sensitivity", "float", "Least power, dBm", unit="dB", low=-120.0, high=50.0
    )
    add_property("beam", 70.0, "beam", "float", "Full angle about X", unit="deg", low=1.0, high=360.0)
    add_property("wall_loss", 10.0, "wall_loss", "float", "By an object between", unit="dB", low=0.0, high=200.0)

    carrier: float
    power: float
    tag_sensitivity: float
    beam: float
    wall_loss: float

    def measure(self) -> None:
        """Read all tags."""
        tags: list[dict[str, Any]] = []
        for source in sources(self, "rfid"):
            ahead = source.offset[0] / max(source.distance, 1e-9)
            if math.acos(min(max(ahead, -1.0), 1.0)) > math.radians(self.beam) / 2.0:
                continue
            power = self.power - free_space(source.distance, self.carrier)
            power -= self.wall_loss * len(walls(self, source.body))
            if power >= self.tag_sensitivity:
                tags.append({"name": source.body.name, "id": str(source.body.get("rfid"))[:200], "power": power})
        self.local_data["tags"] = tags


def free_space(distance: float, carrier: float) -> float:
    """Return the loss in free space, dB: 20 log(4 π r f / c), not less than 0.

    Args:
        distance: m.
        carrier: Hz.
    """
    return max(20.0 * math.log10(4.0 * math.pi * max(distance, 1e-3) * carrier / 299_792_458.0), 0.0)
