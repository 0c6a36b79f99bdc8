"""The playground of new simulations: balls, stools, screens and a ramp inside a fence, on a meadow."""

from __future__ import annotations

from common.colors import BERRY, CORAL, CREAM, LEAF, PLUM, SKY, STEEL, SUN, TEAL, WHITE
from common.images import packed
from common.materials import material
from common.meadow import meadow
from common.nature import Greens
from common.objects import empty, exact, hidden_box, lamp, viewpoint
from common.playground import Paints, fence, playground
from common.posters import alphabet, checkerboard, colour_chart, hello
from common.sky import sky, sunshine
from common.textures import lines, speckle
from common.toys import ball, ball_picture, ramp, screen, stool
from common.wood import Carpenter, wooden

BALLS = (
    ((-8.94, 7.39, 1.29), (-0.908, 0.454, -0.062), (CORAL, WHITE)),
    ((-7.19, 7.33, 0.279), (-2.54, 0.563, -0.767), (SKY, WHITE)),
    ((2.33, 5.85, 2.77), (0, 0, 0), (SUN, CORAL)),
    ((-8.22, 7.27, 0.279), (0, 0, 0), (TEAL, SUN)),
    ((-8.52, 6.69, 0.309), (-1.1, 0.521, -0.124), (BERRY, WHITE)),
    ((-7.67, 7.39, 0.92), (0.087, 0.05, 0.228), (SUN, WHITE)),
    ((-7.21, 6.72, 0.323), (-0.658, 0.345, -0.003), (PLUM, SUN)),
    ((1.63, 2.59, 0.279), (0.826, 0.458, 0.626), (LEAF, WHITE)),
)
STOOLS = (
    ((-8.15, -4.82), 1.59),
    ((-8.15, -5.41), 1.59),
    ((-7.95, -3.91), 1.52),
    ((-1.87, -8.13), -3.12),
    ((-1.04, -8.17), 3.0),
    ((-0.101, -8.09), -3.08),
)
# empty, middle of the board, left foot, right foot, visible mesh; angle about Z
SCREENS = (
    ((6.04, 1.35, 0.008), (6.04, 1.35, 0.893), (5.83, 0.922, 0.087), (6.25, 1.79, 0.087), (6.04, 1.35, 0.882), -0.457),
    (
        (4.96, -1.55, 0.012),
        (4.96, -1.55, 0.897),
        (4.84, -2.02, 0.091),
        (5.09, -1.08, 0.091),
        (4.97, -1.55, 0.886),
        -0.26,
    ),
    ((3.6, -3.46, 0.01), (3.6, -3.46, 0.895), (3.21, -3.75, 0.09), (3.99, -3.18, 0.09), (3.6, -3.47, 0.885), -0.942),
    ((3.71, -8.28, 0.005), (3.72, -8.29, 0.89), (3.23, -8.28, 0.084), (4.2, -8.29, 0.084), (3.71, -8.29, 0.879), -1.58),
)
FENCES = (
    ((10.2, -8.07, 0.537), 0.0),
    ((-8.08, -10.2, 0.537), -1.57),
    ((-8.08, 10.1, 0.537), -1.57),
    ((-10.2, -8.07, 0.537), 0.0),
)


def build() -> None:
    sky("#a9d3ee")
    sunshine(3.2, (0.75, 0.25, 0.9))
    lamp("Fill", "SUN", 0.5, (-8, 8, 14), (-0.7, -0.3, 0.9), color="#cfe4ff", shadow=False)
    planks = wooden("Deck", "#8f6237", "#cf9f66", 3)
    arena(planks)
    jump(planks)
    balls()
    stools(planks)
    screens()
    grass = speckle(512, "#6c9a4b", "#93b866", 61, coarse=4.0)
    paint = material("Meadow", "#83ac5b", 0.95, image=packed("meadow.jpg", grass))
    meadow(paint, Greens.make(), material("Rock", "#8f8f8a", 0.95))
    viewpoint((-7.6, -7.4, 5.4), (1.2, 0.6, 0.0))


def arena(planks) -> None:
    root = empty("Arena", physics_type="NO_COLLISION")
    fixed = {"parent": root, "physics_type": "STATIC"}
    hidden_box("arena_bb1", (18, 18, 0.3), (0, 0, -0.152), **fixed)
    hidden_box("arena_bb2", (1.4, 18, 0.647), (-9.7, 0, 0.176), **fixed)
    hidden_box("arena_bb3", (1.4, 18, 0.647), (9.7, 0.001, 0.176), **fixed)
    hidden_box("arena_bb4", (18, 1.4, 0.647), (0, -9.71, 0.173), **fixed)
    hidden_box("arena_bb5", (18, 1.4, 0.647), (0, 9.7, 0.173), **fixed)
    for number, (at, turn) in enumerate(
        (((-10.2, 0, 0.644), 0), ((10.2, 0, 0.644), 0), ((0, -10.2, 0.644), 1.57), ((0, 10.1, 0.644), 1.57)), 1
    ):
        hidden_box(f"fence_bb{number}", (0.072, 16.3, 0.647), at, (0, 0, turn), **fixed)
    white = material("Fence", WHITE, 0.6)
    for number, (at, turn) in enumerate(FENCES, 1):
        # one box per fence: the gaps between the pickets are too small for robots
        exact(
            f"fence.{number:03}",
            fence(white),
            (0.08, 16.3, 0.683),
            (0, 8.1, 0.094),
            at,
            (0, 0, turn),
            collision="box",
            **fixed,
        )
    parts = playground(arena_paints(planks), Carpenter(21, metres=0.9))
    exact("ArenaMesh", parts, (20.9, 20.9, 5.15), (0, 0, 2.07), parent=root, physics_type="NO_COLLISION")


def arena_paints(planks) -> Paints:
    def tile(name: str, low: str, high: str, seed: int):
        picture = speckle(256, low, high, seed) * (1 - 0.22 * lines(256, 1, 0.02)[..., None])
        return material(name, high, 0.85, image=packed(f"{name.lower().replace(' ', '_')}.jpg", picture))

    def textured(name: str, low: str, high: str, seed: int):
        return material(name, high, 0.95, image=packed(f"{name.lower()}.jpg", speckle(256, low, high, seed)))

    names = {"cream": CREAM, "teal": TEAL, "coral": CORAL, "sky": SKY, "leaf": LEAF, "sun": SUN}
    return Paints(
        tiles=(tile("Tile Light", "#d3bd94", "#e2cfa8", 31), tile("Tile Dark", "#c8b088", "#d8c298", 33)),
        marks={name: material(f"Mark {name.title()}", color, 0.8) for name, color in names.items()},
        grass=textured("Grass", "#4e8a3c", "#86bb57", 35),
        soil=textured("Soil", "#6b4c33", "#8a6545", 37),
        deck=planks,
        bush=(material("Bush", "#4f8f46", 0.9), material("Bush Light", "#74ae58", 0.9)),
        post=material("Post", "#3f7f86", 0.5),
        bulb=material("Bulb", "#ffe2a0", 0.4, glow=1.6),
        wire=material("Wire", "#33373d", 0.7),
    )


def jump(planks) -> None:
    root = empty(
        "Jump", (2.56, 5.49, 0.661), (-0.238, 0, 1.89), physics_type="NO_COLLISION", Object=True, Graspable=False
    )
    solid = {"parent": root, "physics_type": "RIGID_BODY", "mass": 1.0}
    hidden_box("jump_bb1", (2.87, 5.25, 0.367), (2.42, 5.44, 0.433), (-0.235, 0, 1.89), **solid)
    hidden_box("jump_bb2", (2.87, 0.401, 0.834), (4.62, 6.16, 0.421), (0, 0, 1.89), **solid)
    parts = ramp(Carpenter(5), planks, material("Ramp Stripe", SUN, 0.6), material("Ramp Side", CORAL, 0.5))
    exact(
        "JumpMesh",
        parts,
        (2.91, 5.13, 1.22),
        (0, 1.25, 0.137),
        (3.57, 5.81, 0.476),
        (0, 0, 1.89),
        parent=root,
        physics_type="NO_COLLISION",
    )


def balls() -> None:
    for number, (at, turned, colors) in enumerate(BALLS, 1):
        paint = material(f"Ball {number}", colors[0], 0.45, image=packed(f"ball_{number}.png", ball_picture(*colors)))
        exact(
            f"Ball{number}",
            [ball(0.247, paint)],
            (0.494, 0.494, 0.494),
            (0, 0, 0),
            at,
            turned,
            physics_type="RIGID_BODY",
            collision="sphere",
            mass=0.2,
            Object=True,
            Graspable=True,
        )


def stools(planks) -> None:
    legs = [
        material(f"Stool {name}", color, 0.5) for name, color in (("Teal", TEAL), ("Coral", CORAL), ("Cream", CREAM))
    ]
    for number, ((x, y), turn) in enumerate(STOOLS, 1):
        parts = stool(Carpenter(number), planks, legs[number % 3])
        exact(
            f"Stool{number}",
            parts,
            (0.396, 0.385, 0.731),
            (-0.004, -0.002, 0),
            (x, y, 0.371),
            (0, 0, turn),
            physics_type="RIGID_BODY",
            collision="box",
            mass=5.0,
            Object=True,
            Graspable=True,
        )


def screens() -> None:
    frame = material("Screen Frame", STEEL, 0.35, 0.6)
    pictures = (hello(), alphabet(), colour_chart(), checkerboard())
    for number, ((at, board, left, right, mesh, turn), picture) in enumerate(zip(SCREENS, pictures, strict=True), 1):
        suffix = f".{number - 1:03}" if number > 1 else ""
        pose = (0, 0, turn)
        root = empty(
            f"Screen{number}",
            at,
            pose,
            physics_type="RIGID_BODY",
            collision="convex",
            compound=1,
            mass=1.0,
            Object=True,
            Graspable=False,
        )
        solid = {"parent": root, "physics_type": "RIGID_BODY", "mass": 1.0}
        hidden_box(f"screen_bb1{suffix}", (0.019, 0.969, 1.69), board, pose, **solid)
        hidden_box(f"screen_bb2{suffix}", (0.338, 0.106, 0.157), left, pose, **solid)
        hidden_box(f"screen_bb3{suffix}", (0.338, 0.106, 0.157), right, pose, **solid)
        paint = material(f"Poster {number}", WHITE, 0.7, image=packed(f"poster_{number}.png", picture))
        exact(
            f"ScreenMesh{suffix}",
            screen(paint, frame),
            (0.329, 1.08, 1.71),
            (0, 0.001, -0.025),
            mesh,
            pose,
            parent=root,
            physics_type="NO_COLLISION",
        )
