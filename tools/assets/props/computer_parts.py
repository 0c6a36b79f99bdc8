"""A computer with its screen and keyboard, and a laptop."""

from __future__ import annotations

import math
from itertools import product

from common.colors import SKY
from common.materials import material
from common.objects import exact
from common.parts import Part, bounds, in_frame_of
from common.shapes import box, cylinder, rounded_box
from common.stock import Stock

QUARTER = math.pi / 2


def build() -> None:
    stock = Stock()
    display = material("Display", SKY, 0.2, glow=0.6)
    for name, parts, at, turned, size, centre, collision in (
        (
            "cpu",
            tower(stock),
            (-0.166, 0.61, 0.234),
            (math.pi, 0, QUARTER),
            (0.212, 0.462, 0.482),
            (-0.007, -0.177, -0.02),
            "box",
        ),
        (
            "keyboard",
            keys(stock),
            (-0.129, 0.154, 0.013),
            (0.047, 0, QUARTER),
            (0.558, 0.247, 0.041),
            (0.021, -0.028, 0.022),
            "box",
        ),
        (
            "laptop",
            laptop(stock, display),
            (0.264, 0.403, 0.031),
            (1.22, 0, 0),
            (0.321, 0.387, 0.276),
            (0, 0.083, 0.12),
            "convex",
        ),
        (
            "monitor",
            monitor(stock, display),
            (-0.371, 0.175, 0.264),
            (QUARTER, 0, QUARTER),
            (0.512, 0.447, 0.268),
            (0, -0.031, -0.027),
            "box",
        ),
    ):
        # built in the axes of the world, whatever the axes of the object
        own = in_frame_of(parts, turned)
        low, high = bounds(own)
        own = [p.moved(*-(low + high) / 2) for p in own]
        exact(name, own, size, centre, at, turned, physics_type="STATIC", collision=collision)


def tower(stock: Stock) -> list[Part]:
    """Its front faces +X."""
    parts = [rounded_box(0.462, 0.212, 0.482, 0.012, 2).painted(stock["black"])]
    parts += [box(0.006, 0.16, 0.035, 0.002).moved(0.231, 0, z).painted(stock["stone"]) for z in (0.17, 0.12)]
    parts += [box(0.006, 0.15, 0.006).moved(0.231, 0, z).painted(stock["stone"]) for z in (-0.05, -0.08, -0.11, -0.14)]
    return [*parts, cylinder(0.012, 0.01, 0.002, 16).turned(y=90).moved(0.231, 0.06, 0.05).painted(stock["sky"])]


def keys(stock: Stock) -> list[Part]:
    """Used from +X."""
    parts = [rounded_box(0.247, 0.558, 0.025, 0.008, 2).painted(stock["black"])]
    key = box(0.034, 0.033, 0.012, 0.002).painted(stock["white"])
    places = product(range(5), range(14))
    return [*parts, *(key.moved(-0.08 + 0.04 * row, -0.25 + 0.0385 * column, 0.016) for row, column in places)]


def monitor(stock: Stock, display) -> list[Part]:
    return [
        rounded_box(0.05, 0.512, 0.33, 0.015, 2).moved(z=0.06).painted(stock["black"]),
        box(0.006, 0.48, 0.29).moved(0.024, 0, 0.06).painted(display),
        box(0.04, 0.06, 0.16, 0.005).moved(-0.02, 0, -0.12).painted(stock["black"]),
        rounded_box(0.268, 0.26, 0.02, 0.008, 2).moved(0, 0, -0.205).painted(stock["black"]),
    ]


def laptop(stock: Stock, display) -> list[Part]:
    """It opens towards -Y."""
    lid = [
        box(0.32, 0.012, 0.24, 0.004).painted(stock["steel"]),
        box(0.30, 0.004, 0.21).moved(0, -0.007, 0).painted(display),
    ]
    base = [
        box(0.32, 0.24, 0.02, 0.006).moved(0, -0.12, -0.125).painted(stock["steel"]),
        box(0.28, 0.11, 0.006).moved(0, -0.09, -0.113).painted(stock["black"]),
    ]
    return [
        *base,
        *(p.turned(x=-18).moved(0, 0.035, -0.005) for p in lid),
        box(0.09, 0.06, 0.004).moved(0, -0.19, -0.114).painted(stock["stone"]),
    ]
