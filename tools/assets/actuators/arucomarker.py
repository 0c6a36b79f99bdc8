"""A marker for visual localisation: number 100 of the original ArUco dictionary, 8 cm wide, on a white card."""

from __future__ import annotations

import math

import numpy as np
from common.images import packed
from common.materials import material
from common.objects import empty, exact
from common.shapes import rectangle

NUMBER = 100
#: the five cells of a row for each two bits of the number
ROWS = ("10000", "10111", "01001", "01110")


def build() -> None:
    root = empty("arucomarker", turned=(math.pi, 0, 0), physics_type="NO_COLLISION")
    show = {"parent": root, "physics_type": "NO_COLLISION"}
    sign = material("Marker", "#ffffff", 0.9, image=packed("aruco_100.png", picture(NUMBER)))
    white = material("Card", "#ffffff", 0.9)
    face = rectangle(0.08, 0.08).stretched_over((0, 1)).painted(sign)
    exact("arplane", [face], (0.08, 0.08, 0), (0, 0, 0), turned=(-math.pi / 2, 0, math.pi / 2), **show)
    back = rectangle(0.08, 0.08).painted(white)
    exact("arplane.back", [back], (0.08, 0.08, 0), (0, 0, 0), (-0.001, 0, 0), (-math.pi / 2, 0, math.pi / 2), **show)
    card = rectangle(0.09, 0.09).painted(white)
    exact("white_plane", [card], (0.09, 0.09, 0), (0, 0, 0), (-0.001, 0, 0), (2.03, -math.pi / 2, 1.11), **show)


def picture(number: int, cell: int = 16) -> np.ndarray:
    """Five by five cells in a black frame, row 0 at the top."""
    cells = np.zeros((7, 7))
    for row in range(5):
        bits = number >> (8 - 2 * row) & 3
        cells[row + 1, 1:6] = [int(bit) for bit in ROWS[bits]]
    return np.kron(cells, np.ones((cell, cell)))[..., None] * np.ones(3)
