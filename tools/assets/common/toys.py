"""Obstacles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.colors import srgb
from common.parts import Part
from common.shapes import box, lathe, rectangle, rounded_box, sphere, torus, tube

if TYPE_CHECKING:
    import bpy

    from common.wood import Carpenter


def ball(radius: float, material: bpy.types.Material) -> Part:
    """A ball with a texture wrapped around it: u along the equator, v up."""
    shape = sphere(radius, 32, 16)
    uvs = []
    for face in shape.faces:
        corners = shape.vertices[list(face)]
        middle = corners.mean(axis=0)
        longitude = np.arctan2(corners[:, 1], corners[:, 0]) - (around := np.arctan2(middle[1], middle[0]))
        longitude = (longitude + np.pi) % (2 * np.pi) - np.pi  # a face across the seam stays whole
        longitude[np.hypot(corners[:, 0], corners[:, 1]) < 1e-6] = 0.0
        latitude = np.arcsin(np.clip(corners[:, 2] / radius, -1, 1))
        uvs.append(np.column_stack([(around + longitude) / (2 * np.pi), latitude / np.pi + 0.5]))
    return Part(shape.vertices, shape.faces, material, uvs)


def ball_picture(first: str, second: str, size: int = 128) -> np.ndarray:
    """Six stripes of two colours, and a cap on each pole."""
    v, u = np.mgrid[0:size, 0:size] / size
    picture = np.where((np.floor(u * 6) % 2 == 0)[..., None], srgb(first), srgb(second))
    picture[(v < 0.11) | (v > 0.89)] = srgb(first)
    picture[(np.abs(v - 0.115) < 0.012) | (np.abs(v - 0.885) < 0.012)] = srgb("#ffffff")
    return picture


def stool(saw: Carpenter, seat: bpy.types.Material, legs: bpy.types.Material) -> list[Part]:
    """A round stool, 0.4 m wide and 0.73 m high, standing on z=0."""
    top = lathe(
        [(0, -0.025), (0.175, -0.025), (0.19, -0.015), (0.195, 0.0), (0.19, 0.015), (0.17, 0.022), (0, 0.02)], 32
    )
    parts = [saw.cut(top, seat).moved(z=0.709)]
    for angle in (45, 135, 225, 315):
        leg = tube([(0.165, 0, 0.0), (0.11, 0, 0.69)], [0.018, 0.024], 10, round_ends=False)
        parts.append(saw.cut(leg, legs).turned(z=angle))
    parts.append(torus(0.145, 0.011, 28, 8).moved(z=0.25).painted(legs))
    return parts


def screen(front: bpy.types.Material, frame: bpy.types.Material) -> list[Part]:
    """A pin board on two feet with its texture on both sides (+X and -X); it stands on z=0, 1.71 m high."""
    height, width, sill = 1.62, 0.93, 0.07
    parts = []
    for turn in (0, 180):
        sheet = rectangle(width, height).stretched_over((0, 1)).painted(front)
        parts.append(sheet.turned(x=90, z=90).moved(0.012, 0, sill + height / 2).turned(z=turn))
    parts.append(box(0.018, width, height).moved(z=sill + height / 2).painted(frame))
    post = tube([(0, 0, 0.03), (0, 0, 1.68)], 0.03, 14)
    parts += [post.moved(y=s * (width / 2 + 0.03)).painted(frame) for s in (1, -1)]
    for z in (sill, sill + height):
        parts.append(rounded_box(0.035, width, 0.035, 0.012, 1).moved(z=z).painted(frame))
    parts += [rounded_box(0.329, 0.10, 0.07, 0.03, 2).moved(y=s * 0.485, z=0.035).painted(frame) for s in (1, -1)]
    return parts


def ramp(saw: Carpenter, deck: bpy.types.Material, stripe: bpy.types.Material, side: bpy.types.Material) -> list[Part]:
    """A ramp of 2.9 m width that rises from y=3.8 to 1.22 m at y=-1.3; it stands on z=0."""
    tilt, length = np.degrees(0.235), 5.24
    parts = []
    count = 20
    pitch = length / count
    for number in range(count):
        paint = stripe if number in (0, 1, 8, 9, 18, 19) else deck
        parts.append(
            saw.board(2.72, pitch - 0.012, 0.05, paint, 0.008).moved(0, (number + 0.5) * pitch - length / 2, 0.155)
        )
    parts += [rounded_box(0.09, length, 0.24, 0.03, 2).moved(s * 1.41, 0, 0.06).painted(side) for s in (1, -1)]
    parts += [saw.board(0.08, length - 0.3, 0.16, deck).moved(x, 0, 0.05) for x in (-0.7, 0.0, 0.7)]
    parts = [p.turned(x=-tilt).moved(0, 1.21, 0.433) for p in parts]
    # no part is below the floor
    parts = [Part(np.maximum(p.vertices, [-9, -9, 0.0]), p.faces, p.material, p.uvs, p.smooth) for p in parts]
    parts += [saw.board(0.26, 0.36, 0.80, deck).moved(x, -1.1, 0.40) for x in (-1.2, 0.0, 1.2)]
    parts += [saw.board(2.7, 0.05, 0.13, deck).moved(0, -1.29, z) for z in (0.12, 0.42, 0.72)]
    return parts
