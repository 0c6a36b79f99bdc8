"""Objects for a flat or an office, each an empty with its shapes as children, in its own collection."""

from __future__ import annotations

import math

from common.objects import collection, empty, exact, hidden_box
from common.parts import bounds
from common.shapes import box, cylinder, rounded_box
from common.stock import Stock
from common.storage import bin_of_pieces, shelf
from common.tables import rolling_chair, table


def build() -> None:
    stock = Stock()
    videotapes(stock)
    trashbins(stock)
    box_stand(stock)
    rolling_chair_(stock)
    small_table(stock)
    desk_(stock)
    ikea_shelf(stock)


def body(name: str, at, turned=(0, 0, 0), **options):
    settings = {"physics_type": "RIGID_BODY", "collision": "convex", "compound": 1, "mass": 1.0, **options}
    return empty(name, at, turned, within=collection(name), **settings)


def standing(name: str, parts, size, at, turned, parent, **options):
    """A mesh whose origin is the centre of its bounding box."""
    low, high = bounds(parts)
    middle = (low + high) / 2
    return exact(name, [p.moved(*-middle) for p in parts], size, (0, 0, 0), at, turned, parent=parent, **options)


def videotapes(stock: Stock) -> None:
    for name, paint, at, turn in (
        ("BlackVideotape", "black", (4.48, -3.7), 0.0),
        ("GreyVideotape", "stone", (4.29, -4.01), 0.0),
        ("WhiteVideotape", "white", (4.23, -3.16), 0.765),
    ):
        pose = (0, 0, turn)
        root = body(name, (*at, 0.786), pose)
        parts = [
            rounded_box(0.04, 0.12, 0.2, 0.006, 2).painted(stock[paint]),
            box(0.034, 0.1, 0.15, 0.002).moved(x=0.0031).painted(stock["paper"]),
            box(0.03, 0.1, 0.03, 0.002).moved(x=0.0053, z=0.055).painted(stock["coral"]),
            *(
                cylinder(0.02, 0.0385, 0.001, 20).turned(y=90).moved(y=0, z=z).painted(stock["steel"])
                for z in (-0.05, 0.01)
            ),
        ]
        exact(
            f"{name}_mesh",
            parts,
            (0.04, 0.12, 0.2),
            (0, 0, 0),
            (*at, 0.886),
            pose,
            parent=root,
            physics_type="RIGID_BODY",
            collision="box",
            mass=1.0,
        )


def trashbins(stock: Stock) -> None:
    root = body("BlueToyTrashbin", (4.46, -1.18, 0), (0, 0, 0.447))
    solid = {"physics_type": "RIGID_BODY", "collision": "mesh", "mass": 1.0}
    standing(
        "BlueToyTrashbin_mesh",
        bin_of_pieces(stock, 0.1385, 0.277, "sky"),
        (0.277, 0.277, 0.277),
        (4.46, -1.18, 0.139),
        (0, 0, -2.69),
        root,
        **solid,
    )
    root = body("PinkToyTrashbin", (5.33, -2.59, 0.713))
    low = [p.moved(z=-0.1385) for p in bin_of_pieces(stock, 0.1385, 0.177, "berry")]
    exact(
        "PinkToyTrashbin_mesh",
        low,
        (0.277, 0.277, 0.177),
        (0, 0, -0.05),
        (5.33, -2.59, 0.844),
        (0, 0, -math.pi),
        parent=root,
        **solid,
    )


def box_stand(stock: Stock) -> None:
    root = body("BoxStand", (5.33, -2.58, 0.009))
    hidden_box(
        "BoxStand_bb", (0.267, 0.349, 0.626), (5.33, -2.58, 0.319), parent=root, physics_type="RIGID_BODY", mass=1.0
    )
    parts = [
        stock.board(0.277, 0.369, 0.02, "oak").moved(z=0.68),
        stock.board(0.25, 0.33, 0.62, "birch").moved(z=0.35),
        stock.board(0.277, 0.369, 0.04, "oak").moved(z=0.02),
        *(stock.block(0.012, 0.27, 0.15, "white", 0.005).moved(0.127, 0, z) for z in (0.16, 0.34, 0.52)),
        *(
            cylinder(0.012, 0.012, 0.003, 12).turned(y=90).moved(0.134, 0, z).painted(stock["steel"])
            for z in (0.16, 0.34, 0.52)
        ),
    ]
    exact(
        "BoxStand_mesh",
        parts,
        (0.277, 0.369, 0.691),
        (0, 0.007, 0.202),
        (5.33, -2.58, 0.148),
        parent=root,
        physics_type="NO_COLLISION",
    )


def rolling_chair_(stock: Stock) -> None:
    pose = (0, 0, -1.9)
    root = body("RollingChair", (3.56, -8.29, 0), pose)
    for number, (size, at, mass) in enumerate(
        (
            ((0.542, 0.3, 0.466), (3.35, -8.21, 0.725), 2.0),
            ((0.53, 0.423, 0.071), (3.61, -8.3, 0.441), 2.0),
            ((0.08, 0.067, 0.351), (3.57, -8.28, 0.226), 3.0),
            ((0.597, 0.447, 0.071), (3.53, -8.27, 0.036), 3.0),
        ),
        1,
    ):
        hidden_box(f"RollingChair_bb_{number}", size, at, pose, parent=root, physics_type="RIGID_BODY", mass=mass)
    # the back is on the side of the first box, which is -Y of the chair
    parts = [p.turned(z=180) for p in rolling_chair(stock, 0.6, 0.63, 0.93)]
    standing(
        "RollingChair_mesh", parts, (0.6, 0.63, 0.93), (3.51, -8.26, 0.46), pose, root, physics_type="NO_COLLISION"
    )


def small_table(stock: Stock) -> None:
    root = empty("SmallTable", (4.38, -3.52, 0), within=collection("SmallTable"), physics_type="STATIC")
    parts = table(stock, 1.1, 0.65, 0.75, "birch", "birch", shelf=True)
    standing(
        "SmallTable_mesh",
        parts,
        (1.1, 0.65, 0.75),
        (4.38, -3.52, 0.378),
        (0, 0, -math.pi / 2),
        root,
        physics_type="RIGID_BODY",
        collision="convex",
        mass=20.0,
    )


def desk_(stock: Stock) -> None:
    pose = (0, 0, math.pi)
    root = body("Desk", (5.99, -6.15, 0.099), pose)
    solid = {"parent": root, "physics_type": "RIGID_BODY"}
    hidden_box("Desk_bb_1", (1.65, 0.792, 0.114), (5.99, -6.17, 0.77), pose, mass=15.0, **solid)
    for number, (x, y) in enumerate(((6.75, -5.82), (6.75, -6.53), (5.22, -6.53), (5.22, -5.82)), 2):
        hidden_box(f"Desk_bb_{number}", (0.052, 0.057, 0.621), (x, y, 0.408), pose, mass=5.0, **solid)
    for number, x in ((6, 5.22), (7, 6.75)):
        hidden_box(f"Desk_bb_{number}", (0.052, 0.722, 0.039), (x, -6.17, 0.3), pose, mass=2.0, **solid)
    parts = [
        stock.board(1.65, 0.792, 0.035, "oak").moved(z=0.81),
        stock.block(1.5, 0.7, 0.06, "steel", 0.01).moved(z=0.76),
    ]
    parts += [
        stock.block(0.052, 0.057, 0.64, "steel", 0.01).moved(x, y, 0.417)
        for x in (-0.765, 0.765)
        for y in (-0.355, 0.355)
    ]
    parts += [stock.block(0.045, 0.7, 0.035, "steel", 0.01).moved(x, 0, 0.3) for x in (-0.765, 0.765)]
    exact(
        "Desk_mesh",
        parts,
        (1.65, 0.792, 0.73),
        (0, 0, 0.462),
        (5.99, -6.17, 0),
        pose,
        parent=root,
        physics_type="NO_COLLISION",
    )


def ikea_shelf(stock: Stock) -> None:
    root = body("IKEAShelf", (5.21, -4.79, 0))
    hidden_box(
        "IKEAShelf_bb",
        (0.827, 0.85, 0.788),
        (5.21, -4.79, 0.399),
        (0, 0, -2.4),
        parent=root,
        physics_type="RIGID_BODY",
        mass=5.6,
    )
    parts = [p.turned(z=90) for p in shelf(stock, 0.79, 0.398, 0.79, rows=2, columns=2, wood="walnut", books=7)]
    exact(
        "IKEAShelf_mesh",
        parts,
        (0.398, 0.79, 0.79),
        (0.001, 0, 0.395),
        (5.21, -4.79, 0),
        parent=root,
        physics_type="NO_COLLISION",
    )
