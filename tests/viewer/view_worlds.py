"""Worlds for the tests of the live view."""

import io
import math

import numpy as np
from PIL import Image as Picture

from morse.scene import Camera, ComponentDeclaration, Image, Light, Material, Mesh, Node, NodeKind, Scene
from morse.viewer.snapshot import MovingNode


def box(name: str, *materials: Material, size: float = 1.0, uvs: bool = False) -> Mesh:
    """A cube around the origin; its six sides use the materials in turn."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float32) * size / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    square = [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]]
    return Mesh(
        name,
        corners,
        np.array(triangles, dtype=np.int32),
        np.repeat(np.arange(6, dtype=np.int32) % max(len(materials), 1), 2),
        uvs=np.array(square * 6, dtype=np.float32) if uvs else None,
        materials=materials,
    )


def plane(name: str, material: Material, size: float, tiles: float = 1.0) -> Mesh:
    """A square in the XY plane with a repeated texture."""
    half = size / 2
    corners = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], dtype=np.float32)
    uvs = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], dtype=np.float32) * tiles
    return Mesh(
        name, corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), np.zeros(2, np.int32), uvs, None, (material,)
    )


def sphere(name: str, material: Material, radius: float) -> Mesh:
    """A smooth ball."""
    rings, sides = 16, 24
    points = [
        (math.sin(math.pi * i / rings) * math.cos(2 * math.pi * j / sides),
         math.sin(math.pi * i / rings) * math.sin(2 * math.pi * j / sides),
         math.cos(math.pi * i / rings))
        for i in range(rings + 1)
        for j in range(sides)
    ]  # fmt: skip
    triangles = []
    for i in range(rings):
        for j in range(sides):
            a, b = i * sides + j, i * sides + (j + 1) % sides
            triangles += [(a, a + sides, b + sides), (a, b + sides, b)]
    unit, index = np.array(points, np.float32), np.array(triangles, np.int32)
    return Mesh(name, unit * radius, index, np.zeros(len(index), np.int32), None, unit[index], (material,))


def chequers(a: tuple[int, int, int], b: tuple[int, int, int], cells: int = 8) -> Image:
    """A PNG with two colours."""
    grid = np.indices((64, 64)).sum(axis=0) * 0 + (np.indices((64, 64)) * cells // 64).sum(axis=0)
    pixels = np.where((grid % 2)[..., None] == 0, np.array(a), np.array(b)).astype(np.uint8)
    out = io.BytesIO()
    Picture.fromarray(pixels).save(out, "PNG")
    return Image("chequers", out.getvalue(), "image/png")


def mesh_node(name: str, mesh: Mesh, location: tuple[float, float, float] = (0, 0, 0), **more: object) -> Node:
    """A node with a mesh."""
    return Node(name, NodeKind.MESH, location=list(location), mesh=mesh, **more)  # type: ignore[arg-type]


def playground(robots: int = 3) -> tuple[Scene, list[MovingNode]]:
    """A floor, crates, a ball, robots with a rotating sensor each, a lamp and a camera."""
    floor = Material("floor", (0.55, 0.56, 0.58, 1.0), roughness=0.9)
    wood = Material("wood", (0.9, 0.9, 0.9, 1.0), roughness=0.8, image=chequers((176, 124, 74), (150, 100, 56)))
    red, dark = Material("red", (0.65, 0.06, 0.03, 1.0), roughness=0.4), Material("dark", (0.05, 0.06, 0.07, 1.0))
    blue = Material("blue", (0.05, 0.16, 0.5, 1.0), metallic=0.2, roughness=0.25)
    scene = Scene("playground")
    scene.roots.append(mesh_node("floor", plane("floor", floor, 40.0)))
    crate = box("crate", wood, uvs=True)
    for i in range(10):
        angle = i * 2.4
        place = (math.cos(angle) * (4 + i * 0.6), math.sin(angle) * (4 + i * 0.6), 0.5)
        scene.roots.append(mesh_node(f"crate{i}", crate, place, rotation_euler=[0.0, 0.0, angle * 1.7]))
    scene.roots.append(mesh_node("ball", sphere("ball", blue, 0.7), (-2.0, 1.5, 0.7)))
    moving = []
    body, head = box("body", red, dark), box("head", dark, size=0.3)
    for i in range(robots):
        robot = mesh_node(f"robot{i}", body, (0, 0, 0.4), scale=[1.0, 0.7, 0.5])
        lidar = mesh_node(f"robot{i}.lidar", head, (0.2, 0.0, 0.8))
        robot.attach(lidar)
        scene.roots.append(robot)
        scene.components.append(ComponentDeclaration(robot, "robot", "test.Robot", robot))
        scene.components.append(ComponentDeclaration(lidar, "sensor", "test.Lidar", robot))
        moving += [MovingNode(robot, "world"), MovingNode(lidar, "parent")]
    scene.roots.append(Node("camera", NodeKind.CAMERA, location=[0, 0, 6], camera=Camera()))
    scene.settings.view.camera_location = (10.0, -10.0, 8.0)
    scene.settings.view.camera_rotation = (1.05, 0.0, 0.78)
    return scene, moving


def with_lamp(scene: Scene) -> Scene:
    """The scene with a lamp above it."""
    scene.roots.append(Node("lamp", NodeKind.LIGHT, location=[2, 2, 6], light=Light("POINT", energy=1.0)))
    return scene
