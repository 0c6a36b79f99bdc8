"""Bumper strip, whiskers, tactile skin: sensors that are pressed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property
from morse.plugins.senses.scanning import ScanningSensor, palette, picture, steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


class BumperStrip(ScanningSensor):
    """A strip around a part of a round robot that tells which of its segments are pressed.

    The strip is an arc of ``radius`` about the sensor. A segment is pressed if an object is nearer to the arc than
    ``travel`` at one of the five rays of the segment.
    """

    _name = "Bumper strip"
    _short_desc = "A strip of switches along an arc"
    _builder = BuilderDefaults(frequency=60.0, visual=Visual("cylinder", (0.03, 0.03, 0.02), (0.1, 0.1, 0.1)))

    add_data("pressed", [], "list<bool>", "Whether each segment is pressed, the leftmost first")
    add_property("segments", 6, "segments", "integer", "Number of segments", low=1, high=64)
    add_property("radius", 0.2, "radius", "float", "Of the arc", unit="m", low=0.01, high=5.0)
    add_property("arc", 180.0, "arc", "float", "Angle of the arc", unit="deg", low=1.0, high=360.0)
    add_property("travel", 0.01, "travel", "float", "Distance at which it is pressed", unit="m", low=1e-4, high=0.2)
    add_kind("contact", touching=lambda strip: any(strip.local_data["pressed"]))

    shaping = ("segments", "radius", "arc", "travel")
    segments: int
    radius: float
    arc: float
    travel: float

    def directions(self) -> Floats:
        """Return five rays for each segment."""
        angles = steps(math.radians(self.arc), 5 * self.segments)[::-1]
        return np.array([(math.cos(angle), math.sin(angle), 0.0) for angle in angles])

    def reach(self) -> float:
        """Return the distance from the middle at which a segment is pressed, m."""
        return self.radius + self.travel

    def ray_count(self) -> float:
        """Return the number of rays."""
        return 5.0 * self.segments

    def measure(self) -> None:
        """Measure which segments are pressed."""
        hit = self.scan().hit.reshape(self.segments, 5) >= 0
        self.local_data["pressed"] = hit.any(axis=1).tolist()

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields: switches have no noise."""
        return ()


class Whiskers(ScanningSensor):
    """Whiskers in a fan: how far each is bent.

    A whisker of the length L that meets an object at the distance d is bent by 1 - d / L.
    """

    _name = "Whiskers"
    _short_desc = "A fan of whiskers that bend"
    _builder = BuilderDefaults(frequency=60.0, visual=Visual("sphere", (0.01, 0.01, 0.01), (0.1, 0.1, 0.1)))

    add_data(
        "bends", [], "list<float>", "How far each whisker is bent, the leftmost first", shape=(None,), low=0.0, high=1.0
    )
    add_property("count", 7, "count", "integer", "Number of whiskers", low=1, high=64)
    add_property("spread", 120.0, "spread", "float", "Angle of the fan", unit="deg", low=0.0, high=360.0)
    add_property("length", 0.15, "length", "float", "Of a whisker", unit="m", low=0.01, high=2.0)
    add_kind("contact", touching=lambda whiskers: any(bend > 0.0 for bend in whiskers.local_data["bends"]))

    shaping = ("count", "spread", "length")
    count: int
    spread: float
    length: float

    def directions(self) -> Floats:
        """Return a ray for each whisker."""
        angles = steps(math.radians(self.spread), self.count)[::-1]
        return np.array([(math.cos(angle), math.sin(angle), 0.0) for angle in angles])

    def reach(self) -> float:
        """Return the length of a whisker, m."""
        return self.length

    def ray_count(self) -> float:
        """Return the number of whiskers."""
        return float(self.count)

    def measure(self) -> None:
        """Measure how far the whiskers are bent."""
        self.local_data["bends"] = np.clip(1.0 - self.scan().ranges / self.length, 0.0, 1.0).tolist()


class TactileArray(ScanningSensor):
    """A skin of taxels: the force on each.

    The skin is a soft layer of ``thickness`` ahead (X) of the sensor, in the plane Y-Z. Each taxel is a spring: an
    object that reaches into it by δ presses with k δ (a Winkler foundation; K. Johnson, "Contact Mechanics", section
    4.3). The skin must not collide itself, and objects reach into it as far as the bodies behind it let them.
    """

    _name = "Tactile array"
    _short_desc = "Forces on the taxels of a soft skin"
    _source = "Winkler foundation: Johnson, Contact Mechanics, section 4.3"
    _builder = BuilderDefaults(frequency=60.0, visual=Visual("cube", (0.002, 0.02, 0.02), (0.2, 0.2, 0.25)))

    add_data(
        "forces",
        np.zeros((0, 0), np.float32),
        "buffer",
        "Force on each taxel: the top row and the left column first",
        unit="N",
        shape=(None, None),
        dtype="float32",
        low=0.0,
    )
    add_data("total", 0.0, "float", "Sum of the forces", unit="N", low=0.0, follows="forces")
    add_property("rows", 8, "rows", "integer", "Number of rows", low=1, high=128)
    add_property("columns", 8, "columns", "integer", "Number of columns", low=1, high=128)
    add_property("pitch", 0.004, "pitch", "float", "Distance of taxels", unit="m", low=1e-4, high=0.2)
    add_property("thickness", 0.005, "thickness", "float", "Of the skin", unit="m", low=1e-4, high=0.2)
    add_property("stiffness", 200.0, "stiffness", "float", "k of a taxel", unit="N/m", low=1e-3, high=1e7)
    add_kind("image", pixels="forces", encoding="32FC1", unit="N")

    shaping = ("rows", "columns", "pitch", "thickness")
    rows: int
    columns: int
    pitch: float
    thickness: float
    stiffness: float

    def directions(self) -> Floats:
        """Return a ray ahead for each taxel."""
        return np.tile([1.0, 0.0, 0.0], (self.rows * self.columns, 1))

    def origins(self) -> Floats:
        """Return the places of the taxels, row by row from the top left."""
        across, up = steps(self.pitch * self.columns, self.columns), steps(self.pitch * self.rows, self.rows)
        return np.array([(0.0, y, z) for z in up[::-1] for y in across[::-1]])

    def reach(self) -> float:
        """Return the thickness of the skin, m."""
        return self.thickness

    def ray_count(self) -> float:
        """Return the number of taxels."""
        return float(self.rows * self.columns)

    def measure(self) -> None:
        """Measure the forces."""
        depth = np.maximum(self.thickness - self.scan().ranges, 0.0).reshape(self.rows, self.columns)
        self.local_data["forces"] = (self.stiffness * depth).astype(np.float32)

    def report(self) -> None:
        """Compute the sum."""
        self.local_data["total"] = float(np.sum(self.local_data["forces"], dtype=np.float64))

    def shown(self) -> dict[str, object]:
        """The forces as a picture; white is a skin that is pressed flat."""
        forces = np.asarray(self.local_data["forces"], dtype=np.float64)
        return picture(palette(forces / (self.stiffness * self.thickness)), self.local_data) if forces.size else {}
