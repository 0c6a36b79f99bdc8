"""Floors carry where they are shown, whichever way round their triangles run."""

import numpy as np
import pytest

import morse
from morse.assets.collision import resolve_shapes
from morse.scene import BodySettings, Mesh, Node, NodeKind, PhysicsType, Scene

CORNERS = ((-5, -5), (5, -5), (5, 5), (-5, 5))
UP, DOWN = ((0, 1, 2), (0, 2, 3)), ((0, 2, 1), (0, 3, 2))
SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(z=0.3)
robot.append(Pose("pose"))
env = Environment({file!r}, fastmode=True)
"""


def _height(tmp_path, file: str) -> float:
    (tmp_path / "scene.py").write_text(SCENE.format(file=file))
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(120)
        return float(sim.robot.pose.get()["z"])


@pytest.mark.parametrize("faces", [UP, DOWN], ids=["up", "down"])
def test_a_robot_stands_on_a_sheet_from_either_side(tmp_path, faces) -> None:
    points = "".join(f"v {x} {y} 0\n" for x, y in CORNERS)
    (tmp_path / "room.obj").write_text(points + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
    height = _height(tmp_path, str(tmp_path / "room.obj"))
    assert height == pytest.approx(_height(tmp_path, "empty"), abs=2e-3)


def _sheet(name, faces, heights=(0.0, 0.0, 0.0, 0.0), scale=(1, 1, 1), rotation=(0, 0, 0), kind=PhysicsType.STATIC):
    points = np.array([(x, y, z) for (x, y), z in zip(CORNERS, heights, strict=True)], np.float32)
    mesh = Mesh(name, points, np.array(faces, np.int32), np.zeros(2, np.int32))
    node = Node(name, kind=NodeKind.MESH, mesh=mesh, body=BodySettings(type=kind))
    node.scale[:], node.rotation_euler[:] = scale, rotation
    return node


def _plate(node) -> float:
    """The height of the middle of what collides, m, in the frame of the sheet."""
    shapes = node.shapes
    return float(np.mean([s.position[2] if s.vertices is None else np.mean(s.vertices, axis=0)[2] for s in shapes]))


@pytest.mark.parametrize("heights", [(0.0,) * 4, (-0.5, 0.5, 0.5, -0.5), (0.0, 0.3, 0.0, 0.3)], ids=str)
@pytest.mark.parametrize("mirrored", [1, -1])
@pytest.mark.parametrize("faces", [UP, DOWN], ids=["up", "down"])
def test_plates_of_floors_are_below_them(faces, mirrored, heights) -> None:
    floor, scene = _sheet("floor", faces, heights, scale=(1, mirrored, 1)), Scene(environment="empty")
    scene.roots = [floor]
    resolve_shapes(scene)
    assert _plate(floor) < np.mean(heights) - 0.01


def test_a_floor_that_is_turned_over_is_one() -> None:
    floor, scene = _sheet("floor", UP, rotation=(np.pi, 0, 0)), Scene(environment="empty")
    scene.roots = [floor]
    resolve_shapes(scene)
    assert _plate(floor) > 0.01  # along its own Z, which points down


def test_meshes_without_substance_are_no_floors() -> None:
    nowhere, broken = _sheet("nowhere", DOWN), _sheet("broken", DOWN, (np.nan,) * 4)
    nowhere.mesh.vertices = np.zeros((0, 3), np.float32)
    scene = Scene(environment="empty")
    scene.roots = [nowhere, broken, _sheet("point", DOWN, scale=(0, 0, 0))]
    resolve_shapes(scene)
    assert nowhere.shapes == []


def test_ceilings_and_what_moves_keep_their_inside() -> None:
    floor, ceiling = _sheet("floor", DOWN), _sheet("ceiling", DOWN, (2.0,) * 4)
    lid = _sheet("lid", DOWN, (-1.0,) * 4, kind=PhysicsType.RIGID_BODY)
    scene = Scene(environment="empty")
    scene.roots = [floor, ceiling, lid]
    resolve_shapes(scene)
    assert _plate(floor) < -0.01
    assert _plate(ceiling) > 2.01
    assert _plate(lid) > -0.99
