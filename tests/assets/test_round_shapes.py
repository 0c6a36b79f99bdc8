"""Balls and cylinders of model files are drawn as what lasers hit."""

import math

import numpy as np
import pytest

FILE = '<mujoco><worldbody><geom name="thing" type="{kind}" size="{size}" pos="2 0 1"/></worldbody></mujoco>'
SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
robot.translate(z=1)
eye = DepthVideoCamera("eye")
eye.properties(cam_width=640, cam_height=480, cam_focal=32, cam_near=0.1, cam_far=50, Vertical_Flip=True)
robot.append(eye)
env = Environment("{world}")
"""


def depths(simulate, tmp_path, kind: str, size: tuple[float, ...]):
    """The depths of the image, and those of the exact shape at 2 m along each pixel, m."""
    (tmp_path / "ball.xml").write_text(FILE.format(kind=kind, size=" ".join(map(str, size))))
    simulation = simulate(SCENE.format(world=tmp_path / "ball.xml"), sockets=False)
    simulation.sleep(0.2)
    data = simulation.context.component("robot.eye").local_data
    depth, matrix = np.array(data["image"], dtype=float), np.array(data["intrinsic_matrix"])
    rows, columns = np.mgrid[: depth.shape[0], : depth.shape[1]]
    across, down = (columns - matrix[0, 2]) / matrix[0, 0], (rows - matrix[1, 2]) / matrix[1, 1]
    # depth along the axis: |d (1, across, down) - (2, 0, 0)| = r, for a cylinder without down
    squared = 1.0 + across**2 + (down**2 if kind == "sphere" else 0.0)
    with np.errstate(invalid="ignore"):
        exact = (2.0 - np.sqrt(4.0 - squared * (4.0 - size[0] ** 2))) / squared
    inside = np.isfinite(exact) & (np.abs(down) * 2.0 < 0.9 * size[-1])
    return depth[inside], exact[inside]


@pytest.mark.parametrize(("kind", "size"), [("sphere", (0.5,)), ("sphere", (0.15,)), ("cylinder", (0.4, 0.8))])
def test_the_depth_of_a_round_shape_is_that_of_its_formula(simulate, tmp_path, kind: str, size: tuple[float, ...]):
    seen, exact = depths(simulate, tmp_path, kind, size)
    front = exact < 2.0 - 0.3 * size[0]
    assert front.sum() > 100
    # towards the rim, an error of the surface is a larger one of the depth
    assert np.abs(seen - exact)[front].max() < 1e-3
    assert np.median(np.abs(seen - exact)[front]) < 1e-4


def test_small_balls_have_few_triangles():
    from morse.assets import solids

    counts = [len(solids.ball(radius).triangles) for radius in (0.01, 0.05, 0.2, 0.5, 5.0)]
    assert counts == sorted(counts)
    assert counts[0] <= 1280
    assert counts[-1] <= 20480
    for radius in (0.01, 0.05, 0.2, 0.5):
        mesh = solids.ball(radius)
        middles = np.linalg.norm(mesh.vertices[mesh.triangles].mean(axis=1), axis=1)
        corners = np.linalg.norm(mesh.vertices, axis=1)
        assert max(abs(middles - 1.0).max(), abs(corners - 1.0).max()) * radius < 1.05e-4
        sides = solids.round_cylinder(radius)
        width = len(sides.vertices) // 2
        assert radius * (1.0 - math.cos(math.pi / width)) < 1.05e-4
