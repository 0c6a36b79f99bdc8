"""The hall of the indoor worlds: a floor, four walls and lamps."""

from __future__ import annotations

import numpy as np

from common.colors import srgb
from common.images import packed
from common.materials import material
from common.objects import exact, lamp
from common.parts import Part
from common.shapes import box, rectangle
from common.textures import planks, speckle


def hall() -> None:
    floor = material("Floor", "#b98a5b", 0.55, image=packed("parquet.jpg", parquet(512)))
    wall = material("Wall", "#e8e2d4", 0.9, image=packed("wall.jpg", wall_picture(512)))
    ground = rectangle(39.2, 30).mapped(3.2).painted(floor)
    exact("Ground", [ground], (39.2, 30, 0), (0, 0, 0), physics_type="STATIC")
    # all walls face the inside of the hall; the image covers their whole height once
    west = upright(29.8, 4.44, wall).turned(z=90)
    exact("Plane", [west], (0, 29.8, 4.44), (0, 0, 0), (-17.7, 0.384, 2.15), physics_type="STATIC")
    north = upright(45, 4.44, wall)
    exact("Plane.001", [north], (45, 0, 4.44), (0, 0, 0), (-0.048, 14, 2.12), physics_type="STATIC")
    # MORSE 1.4 has the two walls above; without these, robots fall from the edges of the floor
    east = upright(29.8, 4.44, wall).turned(z=-90)
    exact("Plane.002", [east], (0, 29.8, 4.44), (0, 0, 0), (19.4, -0.4, 2.15), physics_type="STATIC")
    south = upright(38, 4.44, wall).turned(z=180)
    exact("Plane.003", [south], (38, 0, 4.44), (0, 0, 0), (0.9, -14.4, 2.12), physics_type="STATIC")
    lamp("Sun", "SUN", 2.2, (0, -6, 12), (0.65, -0.3, 0.2), color="#fff4e2")
    for number, (x, y) in enumerate(((-10, 0), (0, 0), (10, 0)), start=1):
        lamp(f"Lamp{number}", "POINT", 500.0, (x, y, 7.0), color="#fff0d6", shadow=False)


def upright(length: float, height: float, paint) -> Part:
    """A wall along X that faces -Y, its middle at the origin."""
    sheet = rectangle(length, height)
    uv = sheet.vertices[list(sheet.faces[0])][:, :2] / height + np.array([0.0, 0.5])
    return Part(sheet.vertices, sheet.faces, paint, [uv], smooth=False).turned(x=90)


def coloured_box(panel, edge, size: tuple[float, float, float]) -> list[Part]:
    """A box in one colour with sunken panels."""
    x, y, z = size
    rim, depth = 0.05 * x, 0.015 * x
    parts = [box(x - 2 * depth, y - 2 * depth, z - 2 * depth).painted(panel)]
    for sy in (1, -1):
        for sz in (1, -1):
            parts.append(box(x, rim, rim, 0.16 * rim).moved(0, sy * (y - rim) / 2, sz * (z - rim) / 2).painted(edge))
            parts.append(
                box(rim, y - 2 * rim, rim, 0.16 * rim).moved(sy * (x - rim) / 2, 0, sz * (z - rim) / 2).painted(edge)
            )
            parts.append(
                box(rim, rim, z - 2 * rim, 0.16 * rim).moved(sy * (x - rim) / 2, sz * (y - rim) / 2, 0).painted(edge)
            )
    return parts


def parquet(size: int) -> np.ndarray:
    """Long boards of pale wood with their ends staggered."""
    boards = 12
    picture = planks(size, "#c0925f", "#d9b184", boards, seed=11)
    mean = picture.mean(axis=(0, 1))
    picture = mean + 0.6 * (picture - mean)  # from a distance, strong joints would flicker
    columns = np.arange(size)
    for board in range(boards):
        ends = np.abs((columns - board * 197) % size - size / 2) < 1.5
        rows = slice(board * size // boards, (board + 1) * size // boards)
        picture[rows, ends] *= 0.75
    return picture


def wall_picture(size: int) -> np.ndarray:
    """Plaster, warm at the bottom, with a skirting board; row 0 is the top."""
    picture = speckle(size, "#e6e0d2", "#efeadd", seed=4)
    height = 1.0 - (np.arange(size) + 0.5) / size  # share of the wall
    metres = height * 4.44
    lower = np.clip((1.15 - metres) / 0.02, 0.0, 1.0)[:, None, None]
    picture = picture * (1 - lower) + lower * speckle(size, "#7fa6a8", "#8bb0b0", seed=6)
    rail = ((metres > 1.13) & (metres < 1.22))[:, None, None]
    picture = np.where(rail, srgb("#f6f2e8"), picture)
    skirting = (metres < 0.19)[:, None, None]
    return np.where(skirting, srgb("#5d4632"), picture)
