"""A robot that patrols buildings: two driven wheels and three casters under a rounded body."""

from __future__ import annotations

import math

from common.colors import CREAM, NAVY, RUBBER, STEEL, SUN
from common.images import packed
from common.materials import material
from common.objects import exact
from common.parts import in_frame_of, mirrored
from common.posters import plate
from common.shapes import box, cylinder, ellipsoid, lathe, rectangle, rounded_box
from common.wheels import caster, dish, tyre

PI = math.pi
AXLE = (PI / 2, 0, 0)


def build() -> None:
    cream, black = material("Cream", CREAM, 0.4), material("Black", NAVY, 0.4)
    rubber, steel = material("Rubber", RUBBER, 0.85), material("Steel", STEEL, 0.3, 0.9)
    root = exact(
        "PatrolBot",
        body(cream, black),
        (0.58, 0.48, 0.348),
        (-0.003, -0.001, 0.033),
        (0, 0, 0.17),
        physics_type="RIGID_BODY",
        collision="box",
        mass=1.0,
    )
    rigid = {"physics_type": "RIGID_BODY", "mass": 1.0}
    drive(root, rubber, steel, black, rigid)
    casters(root, rubber, steel, rigid)
    for name, at, size, centre in (
        ("Bridge_Left", (0.114, 0.209, 0.287), (0.111, 0.038, 0.023), (0, -0.001, 0.005)),
        ("Bridge_Right", (0.127, -0.216, 0.287), (0.111, 0.042, 0.004), (0, 0.002, -0.009)),
    ):
        turned = (-0.262, PI / 2, 0)
        exact(
            name, [box(*size, 0.001).painted(steel)], size, centre, at, turned, parent=root, collision="convex", **rigid
        )
    show = {"parent": root, "physics_type": "NO_COLLISION"}
    lamp = lathe([(0, 0), (0.01, 0.0), (0.009, 0.012), (0.005, 0.018), (0, 0.02)], 16).painted(
        material("Lamp", SUN, 0.3, glow=1.5)
    )
    exact(
        "Fancy_Lamp",
        in_frame_of([lamp], AXLE),
        (0.02, 0.02, 0.02),
        (0, -0.015, 0.051),
        (-0.225, 0.035, 0.385),
        AXLE,
        **show,
    )
    logo = material("Logo", CREAM, 0.5, image=packed("patrol.png", plate("PATROL")))
    for name, side, at in (("Logo_Plate_L", 1, (-0.005, 0.236, 0.148)), ("Logo_Plate_R", -1, (-0.005, -0.244, 0.148))):
        sheet = rectangle(0.277, 0.227).stretched_over((0, 1)).turned(x=90, z=90 + 90 * side).painted(logo)
        exact(name, [sheet], (0.277, 0.0, 0.227), (0.003, 0.003, -0.004), at, **show)


def drive(root, rubber, steel, black, rigid) -> None:
    for name, side, at in (("Wheel_L", 1, (0, 0.203, 0.09)), ("Wheel_R", -1, (0.001, -0.205, 0.09))):
        wheel = [*tyre(0.0908, 0.046, 0.055, rubber), *dish(0.055, 0.047, steel, black)]
        parts = [p.turned(x=90 + 90 * side) for p in wheel]
        exact(
            name,
            parts,
            (0.1815, 0.1815, 0.05),
            (0, 0, -0.001 * side),
            at,
            AXLE,
            parent=root,
            collision="cylinder",
            **rigid,
        )


def casters(root, rubber, steel, rigid) -> None:
    """The wheels of the rear casters are children of the swivel with the name of the other side, as in MORSE 1.4."""
    swivels = {}
    for name, at, centre in (
        ("Swivel_F", (0.178, 0.005, 0.063), (0.004, 0, 0.001)),
        ("Swivel_L", (-0.18, -0.164, 0.065), (0.003, 0, 0.003)),
        ("Swivel_R", (-0.18, 0.163, 0.065), (0.003, 0, 0.003)),
    ):
        fork = [box(0.03, 0.004, 0.07, 0.001).moved(0, s * 0.0195, 0) for s in (1, -1)]
        fork.append(cylinder(0.025, 0.012, 0.002, 20).moved(z=0.034))
        swivels[name] = exact(
            name,
            [p.painted(steel) for p in fork],
            (0.05, 0.043, 0.081),
            centre,
            at,
            parent=root,
            collision="convex",
            **rigid,
        )
    for name, parent, at, size in (
        ("CasterWheel", root, (0.17, 0.005, 0.032), (0.072, 0.072, 0.029)),
        ("CasterWheel_L", swivels["Swivel_R"], (-0.193, 0.163, 0.037), (0.075, 0.075, 0.03)),
        ("CasterWheel_R", swivels["Swivel_L"], (-0.194, -0.164, 0.036), (0.076, 0.076, 0.03)),
    ):
        wheel = caster(0.037, 0.029, rubber, steel)
        exact(name, wheel, size, (0, 0, 0), at, AXLE, parent=parent, collision="cylinder", **rigid)


def body(cream, black) -> list:
    """Sizes relative to the root, 0.17 m above the ground."""
    blue = material("Shell", "#245a8d", 0.35)
    glass, eye = material("Glass", "#0d161d", 0.1), material("Eye", "#bff4ff", 0.3, glow=1.2)
    parts = [
        ellipsoid(0.29, 0.235, 0.075, squareness=0.75, columns=40, rows=12).moved(z=-0.06).painted(black),
        ellipsoid(0.285, 0.23, 0.12, squareness=0.6, columns=40, rows=14).moved(z=0.07).painted(blue),
        ellipsoid(0.20, 0.17, 0.05, squareness=0.5, columns=36, rows=10).moved(-0.02, 0, 0.165).painted(cream),
        rounded_box(0.06, 0.22, 0.06, 0.028, 3).moved(0.262, 0, 0.09).painted(glass),
        ellipsoid(0.2925, 0.2375, 0.022, squareness=0.75, columns=40, rows=8).moved(z=-0.075).painted(cream),
    ]
    parts += mirrored([ellipsoid(0.008, 0.018, 0.022, columns=16, rows=8).moved(0.289, 0.05, 0.092).painted(eye)])
    parts += [
        cylinder(0.013, 0.012, 0.002, 14).turned(y=90).moved(0.278, y, 0.025).painted(glass)
        for y in (-0.1, -0.05, 0.0, 0.05, 0.1)
    ]
    return parts
