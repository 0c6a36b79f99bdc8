"""A park at the edge of a town: trees, ferns, grass, rocks, fences and some crates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from common.crates import crate_woods, large_crate, small_crate, transport_box
from common.land import ground, town, town_ground
from common.materials import material
from common.nature import Greens, blades, crown_of, fern, rock, trunk_of
from common.objects import collection, exact, instance, viewpoint
from common.sky import sky, sunshine
from common.stock import Stock

if TYPE_CHECKING:
    from common.parts import Part

TOWN = (18.3, 41.8, 6.82)
#: instances of collections: name, position, Euler XYZ
COPIES = {
    "fence_long": (
        ("fence_long.001", (-1.39, 2.46, -0.06), (0, 0, 0)),
        ("fence_long.002", (-7.93, -47.4, -0.06), (0, 0, 1.03)),
        ("fence_long.003", (-10.7, -47.3, -0.06), (0, 0, 1.03)),
        ("fence_long.004", (-49.8, 26.1, 0.037), (0, 0, 0.416)),
        ("fence_long.005", (-55.1, 15, 0.127), (0, 0, 0.675)),
        ("fence_long.006", (-59.5, 6.43, 0.74), (0, 0, 0.879)),
        ("fence_long.007", (-62.1, 6.92, 0.74), (0, 0, 0.879)),
        ("fence_long.008", (-68, 8.27, 0.183), (0, 0, 0.879)),
        ("fence_long.009", (-65.2, 17.5, 0.274), (0, 0, 0.675)),
        ("fence_long.010", (-63.6, -12.9, 0.235), (0, 0, 1.34)),
    ),
    "furn_001": (
        ("furn_001.001", (45.7, 2.49, -0.039), (0, 0, 0)),
        ("furn_001.002", (44.8, -5.65, 0.093), (0, 0, 0)),
        ("furn_001.003", (33.7, -1.66, 0.706), (0, 0, 0)),
        ("furn_001.004", (43.4, -15.9, 1.16), (0.036, 0.054, 1.45)),
        ("furn_001.005", (-3.75, 44.3, 4.1), (0.036, 0.054, 1.45)),
        ("furn_001.006", (38.6, -3.53, -0.139), (0, 0, 0)),
        ("furn_001.007", (36.7, -0.592, 0.059), (0, 0, 0)),
        ("furn_001.008", (36.2, -3.02, 0.207), (0, 0, 0)),
        ("furn_001.009", (37, 4.02, 0.186), (0, 0, 0)),
    ),
    "grass_002": (
        ("grass_002.001", (31.8, -22.8, 0.001), (0, 0, 0)),
        ("grass_002.002", (29.5, -19.5, -0.021), (0, 0, 0)),
        ("grass_002.003", (34.6, -19.4, 1.06), (0, 0, 0)),
        ("grass_002.004", (34.7, -22.8, 0.517), (0, 0, 0)),
        ("grass_002.005", (31.8, -19.5, 0.024), (0, 0, 0)),
        ("grass_002.006", (32.4, -21.5, 0.166), (0, 0, 0)),
        ("grass_002.007", (31.3, -24.6, 0.002), (0, 0, 0)),
        ("grass_002.008", (30.1, -20.5, 0.004), (0, 0, 0)),
        ("grass_002.009", (29.1, -22.5, 0.006), (0, 0, 0)),
        ("grass_002.010", (27.8, -20.5, 0.008), (0, 0, 0)),
        ("grass_002.011", (29.6, -17.4, 0.005), (0, 0, 0)),
        ("grass_002.012", (-15.4, -6.08, 1.13), (0, 0, 0)),
        ("grass_002.013", (-13.8, -5.08, 1.17), (0, 0, 0)),
        ("grass_002.014", (-11.8, -4.91, 1.17), (0, 0, 0)),
        ("grass_002.015", (-12.3, -6.75, 1.06), (0, 0, 0)),
        ("grass_002.016", (-12.9, -2.77, 0.746), (0, 0, 0)),
        ("grass_002.017", (-15.5, -3.56, 0.636), (0, 0, 0)),
        ("grass_002.018", (-16, -1.5, 0.076), (0, 0, 0)),
        ("grass_002.019", (-14.5, -2.11, 0.505), (0, 0, 0)),
        ("grass_002.020", (-15.6, 0.111, 0.051), (0, 0, 0)),
        ("grass_002.021", (-17.5, -0.405, 0.009), (0, 0, 0)),
        ("grass_002.022", (0.794, 1.14, 0.009), (0, 0, 0)),
        ("grass_002.023", (-0.125, 2.22, 0.009), (0, 0, 0)),
        ("grass_002.024", (0.983, 2.68, 0.009), (0, 0, 0)),
        ("grass_002.025", (-0.882, 3.57, 0.009), (0, 0, 0)),
        ("grass_002.026", (-0.098, 4.62, 0.009), (0, 0, 0)),
        ("grass_002.027", (-1.4, 5.22, 0.009), (0, 0, 0)),
        ("grass_002.028", (-1.83, 6.3, 0.009), (0, 0, 0)),
        ("grass_002.029", (-0.423, 5.65, 0.009), (0, 0, 0)),
        ("grass_002.030", (0.848, -2.76, 0.009), (0, 0, 0)),
        ("grass_002.031", (1.2, -0.972, 0.009), (0, 0, 0)),
        ("grass_002.032", (2.9, 0.866, 0.009), (0, 0, 0)),
        ("grass_002.033", (3.15, 3.98, 0.009), (0, 0, 0)),
    ),
    "large_crate": (
        ("large_crate", (41.7, -28.7, 0.104), (0, 0, 0.698)),
    ),
    "small_crate": (
        ("small_crate", (38.1, -30.7, -0.019), (0, 0, 0)),
        ("small_crate.001", (37.1, -31.6, -0.021), (0, 0, 0.798)),
        ("small_crate.002", (37.4, -31, 0.999), (0, 0, 0)),
        ("small_crate.003", (1.46, 6.84, 0.044), (0, 0, 0)),
        ("small_crate.004", (0.583, 7.88, 0.044), (0, 0, 0.442)),
        ("small_crate.005", (1.79, 8.4, 0.044), (0, 0, 0.199)),
        ("small_crate.006", (1.6, 7.64, 1.06), (0, 0, 0.199)),
    ),
    "transport_box": (
        ("transport_box", (2.49, 2.58, 0.055), (0, 0, 0)),
    ),
    "tree_brown_1": (
        ("tree_brown_1", (2.81, -39.5, -0.16), (0, 0, 0)),
        ("tree_brown_1.001", (37.5, 8.07, 2.32), (0, 0, 0)),
        ("tree_brown_1.002", (-35.9, -28.9, -0.435), (0, 0, 0)),
        ("tree_brown_1.003", (-38.2, -48.3, -0.368), (0, 0, 0)),
        ("tree_brown_1.004", (-52.5, 5.67, -0.841), (0, 0, 0)),
    ),
    "tree_brown_2": (
        ("tree_brown_2", (-28.5, -23.4, 0.438), (0, 0, 0)),
        ("tree_brown_2.001", (-44.9, 12.7, 0.438), (0, 0, 0)),
        ("tree_brown_2.002", (-6.78, 59, 0.438), (0, 0, 0)),
        ("tree_brown_2.003", (41.3, -37.2, 2.17), (0, 0, 1.51)),
        ("tree_brown_2.004", (33.5, 35.6, 3.36), (0, 0, -0.945)),
        ("tree_brown_2.005", (61.9, 1.85, 3.88), (0, 0, 1.87)),
        ("tree_brown_2.006", (38, 27.3, 4.28), (0, 0, 0)),
        ("tree_brown_2.008", (10.3, -37.8, 0.439), (0, 0, 0.928)),
        ("tree_brown_2.009", (-17.3, 63.8, 0.438), (0, 0, 0)),
        ("tree_brown_2.010", (-48.8, -0.7, 0.276), (0, 0, 0)),
    ),
    "volcano_rock1": (
        ("volcano_rock1.001", (32.1, -31.3, -0.191), (0, 0, 0)),
        ("volcano_rock1.002", (37.1, -22.6, -0.191), (0, 0, -1.15)),
        ("volcano_rock1.003", (33.9, -7.26, 1.83), (0, 0, -1.15)),
        ("volcano_rock1.004", (2.87, 5.96, -0.195), (0, 0, -0.844)),
        ("volcano_rock1.005", (0.615, 9.71, -0.195), (0, 0, -0.844)),
        ("volcano_rock1.006", (-58.8, -43, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.007", (-30.2, -51.6, 3.69), (0, 0, 2.5)),
        ("volcano_rock1.008", (-53.2, -36.8, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.009", (-50.7, -41.6, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.010", (-50.8, -35.6, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.011", (-54, -35.3, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.012", (-48.5, -39.5, 3.69), (0, 0, -0.844)),
        ("volcano_rock1.013", (-58.3, -36.2, 3.69), (0, 0, -0.844)),
    ),
    "volcano_rock2": (
        ("volcano_rock2.001", (6.46, -80.7, -0.191), (0, 0, -1.4)),
        ("volcano_rock2.002", (91.8, -64.3, -3.96), (0, 0, -1.4)),
    ),
}  # fmt: skip
#: the visible meshes of the instances of crates, which are bodies
CRATES = {"small_crate": "closed", "large_crate": "big", "transport_box": "open"}

#: half of the diagonal of the largest crate, m
FOOT = 2.3


def build() -> None:
    sky("#a9cfe8")
    sunshine(3.2, (0.7, 0.3, 0.6))
    # crates stand on the ground, the lowest of a stack first
    rooted = [
        (*at[:2], max(at[2], 0.0))
        for stem, copies in COPIES.items()
        for _, at, _ in copies
        if stem not in CRATES or at[2] < 0.5
    ]
    feet = [(at, FOOT) for stem in CRATES for _, at, _ in COPIES[stem] if at[2] < 0.5]
    land = ground([*rooted, *town_ground(TOWN, 2.42, rooted)], dip=-0.065, rise=4.145, seed=9, feet=feet)
    town(land, TOWN, (42.1, 67.9, 11.2), (0, 0, 1.22), [at for _, at, _ in COPIES["tree_brown_2"]])
    collections = {**originals(), **crates()}
    for stem, copies in COPIES.items():
        for name, at, turned in copies:
            instance(collections[stem], name, at, turned, physics_type="STATIC")
    viewpoint((9.5, -11.0, 6.2), (0.0, 3.0, 0.6), 22.0)


def shown(name: str, foot: tuple[float, float, float]) -> bpy.types.Collection:
    """A collection whose objects are in the world, and can be instantiated with ``foot`` at another position."""
    group = collection(name)
    group.instance_offset = foot
    return group


def originals() -> dict[str, bpy.types.Collection]:
    """The first object of each kind. Instances are rotated relative to it."""
    greens, stock = Greens.make(), Stock()
    stone = material("Lava", "#6b6662", 0.95)
    still, soft = {"physics_type": "STATIC"}, {"physics_type": "NO_COLLISION"}
    fence = shown("fences", (34.4, -34.7, 0.011))
    exact(
        "fence_long",
        rails(stock),
        (2.45, 0.233, 0.865),
        (0.12, 0, 0.419),
        (34.4, -34.7, 0.011),
        (0, 0, 2.09),
        within=fence,
        **still,
    )
    ferns = shown("ferns", (8.64, -0.615, -0.047))
    parts = fern(greens, 1.35, 1.0, 15, 3)
    exact(
        "furn_001",
        parts,
        (2.59, 2.69, 1.27),
        (0.063, 0.058, 0.462),
        (8.64, -0.615, -0.047),
        (0, 0, 0.156),
        within=ferns,
        **soft,
    )
    grass = shown("grass", (2.58, -1.96, 0.0))
    parts = blades(greens, 0.6, 0.5, 46, 5)
    exact(
        "grass_002",
        parts,
        (1.26, 1.15, 0.499),
        (-0.02, -0.025, 0.242),
        (2.58, -1.96, 0.006),
        within=grass,
        lod_level=0,
        **soft,
    )
    small, crag = shown("rocks", (11.4, 0.551, 0.195)), shown("crags", (-45, -47.7, 3.7))
    exact(
        "volcano_rock1",
        [rock(stone, 1.7, 1.9, 1.3, 3)],
        (1.71, 1.93, 1.29),
        (0.028, -0.022, 0.165),
        (11.4, 0.551, 0.26),
        (0, 0, -3.02),
        within=small,
        collision="convex",
        slip=True,
        **still,
    )
    exact(
        "volcano_rock2",
        [rock(stone, 3.8, 3.4, 3.5, 7)],
        (3.77, 3.44, 3.47),
        (0.327, 0.221, 0.812),
        (-45, -47.7, 4.67),
        (0, -0.017, 0),
        within=crag,
        collision="convex",
        slip=True,
        **still,
    )
    brown, old = shown("brown trees", (11.7, 8.97, 1.03)), shown("old trees", (17, 1.65, -0.36))
    exact(
        "tree_brown_001.003",
        trunk_of(greens, 11.0, 11.0, 0.42, 4),
        (5.19, 4.16, 8.06),
        (-0.521, -0.404, 2.95),
        (11.7, 8.97, 2.11),
        within=brown,
        slip=True,
        **still,
    )
    exact(
        "Plane.1060",
        crown_of(greens, 11.0, 12.0, 4),
        (12.7, 12.5, 8.84),
        (0.987, -1.84, 0.192),
        (9.69, 7.46, 7.01),
        (0.135, -0.146, 1.71),
        within=brown,
        **soft,
    )
    exact(
        "treebrown_002",
        trunk_of(greens, 11.0, 11.0, 0.5, 8),
        (5.8, 6.32, 8.3),
        (0.27, 0.714, 2.91),
        (17, 1.65, 0.881),
        within=old,
        slip=True,
        **still,
    )
    exact(
        "treebrown2_leaves.001",
        crown_of(greens, 11.0, 12.0, 8),
        (11.6, 12.2, 7.48),
        (-0.72, -2.45, -1.06),
        (17.8, 4.49, 5.98),
        within=old,
        **soft,
    )
    return {
        "fence_long": fence, "furn_001": ferns, "grass_002": grass, "volcano_rock1": small, "volcano_rock2": crag,
        "tree_brown_1": brown, "tree_brown_2": old,
    }  # fmt: skip


def rails(stock: Stock) -> list[Part]:
    """Two posts and three rails, 2.45 m long."""
    parts = [stock.board(0.11, 0.11, 0.86, "oak").moved(x, 0, 0.43) for x in (-1.1, 1.1)]
    return parts + [stock.board(2.45, 0.05, 0.12, "oak").moved(0, 0.03, z) for z in (0.22, 0.48, 0.74)]


def crates() -> dict[str, bpy.types.Collection]:
    """Crates to push; the originals of copies are not in the world."""
    planks, frame, wall, iron = crate_woods()
    made = {
        "small_crate": small_crate(CRATES["small_crate"], wall, frame),
        "large_crate": large_crate(CRATES["large_crate"], planks, frame, iron),
        "transport_box": transport_box(CRATES["transport_box"], planks, frame, iron),
    }
    for group in made.values():
        bpy.context.scene.collection.children.unlink(group)
    return made
