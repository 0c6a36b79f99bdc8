"""A tree for worlds with very many trees: a cylinder and a crown of lumps with twenty faces."""

from __future__ import annotations

from common.materials import material
from common.nature import blob
from common.objects import exact
from common.shapes import cylinder


def build() -> None:
    bark, leaves = material("Bark", "#6f4e37", 0.95), material("Leaves", "#5b9a45", 0.9)
    crown = [blob(1.65, 4, 0.08, 9, 6).painted(leaves)]
    exact("Icosphere", crown, (3.23, 3.4, 3.4), (0, 0, 0), (0, 0, 4), physics_type="STATIC", collision="convex")
    trunk = [cylinder(0.5, 3.0, columns=12).painted(bark)]
    exact("Trunk", trunk, (1, 1, 3), (0, 0, 0), (0, 0, 1.5), physics_type="STATIC", collision="cylinder")
