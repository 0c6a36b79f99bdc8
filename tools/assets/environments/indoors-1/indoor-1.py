"""A furnished hall: desks, shelves, chairs, and boxes to find and carry."""

from __future__ import annotations

from common.catalogue import catalogue_stock, furniture
from common.hall import coloured_box, hall
from common.household import bottle
from common.materials import material
from common.objects import exact, viewpoint
from common.sky import sky

#: name, position, Euler XYZ, size and centre of the bounding box, collision shape
PIECES = (
    ("Desk_1.001", (-6.09, 11, 0.684), (0, 0, 0), (2.99, 1.66, 1.32), (0, 0, 0), "convex"),
    ("Desk_2.001", (-7.62, 3.15, 0.122), (0, 0, 0), (2.35, 1.25, 0.904), (0.002, -0.056, 0.337), "convex"),
    ("Desk_3.000", (-11.6, 7.76, 0.958), (0, 0, 0), (2.65, 1.34, 0.949), (0, 0, -0.474), "convex"),
    ("Desk_3.002", (-1.63, 7.76, 0.958), (0, 0, 0), (2.65, 1.34, 0.949), (0, 0, -0.474), "convex"),
    ("red_heat.000", (-11.5, 6.42, 0.131), (0, 0, -3.14), (0.976, 0.748, 1.06), (0, 0.327, 0.421), "convex"),
    ("red_heat.001", (-1.53, 6.42, 0.131), (0, 0, -3.14), (0.976, 0.748, 1.06), (0, 0.327, 0.421), "convex"),
    ("Rolling_Chair.001", (-8.05, 1.48, 0.585), (0, 0, 0), (0.694, 0.912, 1.21), (0.001, -0.255, 0.028), "convex"),
    ("Shelf_1.001", (-12.2, 11.4, 0.29), (0, 0, 0), (1.16, 0.874, 1.51), (0.001, -0.094, 0.482), "box"),
    ("Shelf_2.001", (-10.3, 13.1, 1.01), (0, 0, 0), (1.13, 0.672, 1.94), (0, 0, 0), "box"),
    ("Shelf_3.001", (0.474, 11.1, 0.597), (0, 0, 0), (1.17, 0.848, 1.17), (0.001, -0.007, 0), "box"),
    ("Stool", (-5.2, 9.73, 0.62), (2.43, -1.57, -3.1), (1.23, 0.664, 0.661), (0.016, -0.003, 0.002), "box"),
    ("whiteboard", (-2.54, 10.9, 0.293), (0, 0, 0), (1.92, 0.85, 1.99), (-0.007, -0.015, 0.726), "convex"),
)  # fmt: skip
#: name, colours of the sides and of the edges, position, Euler XYZ, edge, mass, properties
BOXES = (
    ("RedBox", "#d3191c", "#9c0f12", (-1.47, 1.69, 0.51), (0, 0, 0), 1.0, 5.0, {"Object": True}),
    ("GreenBox", "#189a34", "#0e6f24", (-11.9, 4.09, 0.25), (0, 0, 0), 0.5, 4.0, {"Object": True}),
    (
        "PinkBox",
        "#ef7fae",
        "#c4537f",
        (-0.917, 7.53, 1.24),
        (0, 0, 0.645),
        0.5,
        3.0,
        {"Object": True, "Graspable": True},
    ),
    ("YellowBox", "#f2c62c", "#bd9410", (-5.53, 11.4, 1.83), (-3.14, 0, -3.14), 0.845, 5.0, {"Object": "Box"}),
)


def build() -> None:
    sky("#cfd8df")
    hall()
    stock = catalogue_stock()
    for piece in PIECES:
        furniture(stock, *piece)
    rigid = {"physics_type": "RIGID_BODY", "collision": "box"}
    for name, color, dark, at, turned, edge, mass, tags in BOXES:
        parts = coloured_box(material(name, color, 0.45), material(f"{name} Edge", dark, 0.5), (edge, edge, edge))
        exact(name, parts, (edge, edge, edge), (0, 0, 0), at, turned, mass=mass, **rigid, **tags)
    flask = [part.moved(z=-0.25) for part in bottle(stock, 0.17, 0.5)]
    tags = {"Object": True, "Graspable": True}
    exact("Bottle1", flask, (0.2, 0.15, 0.5), (0, 0, 0.009), (-7.57, 3.14, 1.17), mass=1.0, **rigid, **tags)
    viewpoint((7.0, -7.5, 5.0), (-2.0, 1.5, 0.4))
