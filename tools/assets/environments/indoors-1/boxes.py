"""A hall with two walls and three coloured boxes: the place where sensors are tried out."""

from __future__ import annotations

from common.hall import coloured_box, hall
from common.materials import material
from common.objects import exact
from common.sky import sky

SIZE = (1.0, 1.0, 1.8)
BOXES = (
    ("RedBox", "#d3191c", "#9c0f12", (-7.5, 0.0, 0.99)),
    ("BlueBox", "#1a45d6", "#10309b", (-3.5, -3.0, 0.97)),
    ("GreenBox", "#189a34", "#0e6f24", (-6.5, 6.0, 1.0)),
)


def build() -> None:
    sky("#cfd8df")
    hall()
    for name, color, dark, at in BOXES:
        parts = coloured_box(material(name, color, 0.45), material(f"{name} Edge", dark, 0.5), SIZE)
        exact(name, parts, SIZE, (0, 0, 0), at, physics_type="RIGID_BODY", collision="box", mass=1.0, Object=name)
