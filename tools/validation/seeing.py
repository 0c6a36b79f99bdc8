"""Cameras, by OpenCV."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import cv2
import numpy as np
from figures import Figure, scene

from morse.rendering.textures import LINEAR

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

#: inner corners of the chessboard, and the size of a square, m
COLUMNS, ROWS, SQUARE = 8, 5, 0.1
BOARD = f"""
robot = FakeRobot("robot")
robot.translate(0, 0, 1)
eye = VideoCamera("eye")
eye.properties(cam_width=640, cam_height=480, cam_focal=32)
eye.rotate(x=0.05, z=0.04)
robot.append(eye)
board = Cube("board")
board.location = (1.55, 0, 1)
board.scale = (0.04, 0.75, 0.6)
board.color(1, 1, 1)
for i in range({COLUMNS + 1}):
    for j in range({ROWS + 1}):
        if (i + j) % 2 == 0:
            square = Cube(f"Square{{i}}_{{j}}")
            square.location = (1.505, (i - {COLUMNS / 2}) * {SQUARE}, 1 + (j - {ROWS / 2}) * {SQUARE})
            square.scale = (0.005, {SQUARE / 2}, {SQUARE / 2})
            square.color(0, 0, 0)
env = Environment("empty")
"""
MARKER = """
robot = FakeRobot("robot")
robot.translate(x=2.3, y=0.2, z=1.1)
robot.rotate(z=math.pi)
eye = VideoCamera("eye")
eye.properties(cam_width=640, cam_height=480, cam_fov=14.0)
eye.rotate(x=0.07, y=-0.03)
robot.append(eye)
holder = FakeRobot("holder")
marker = Arucomarker("marker")
holder.append(marker)
env = Environment("empty")
"""


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    yield from chessboard()
    yield marker()


def grey(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Linear light, not sRGB codes: these would enlarge white areas."""
    return np.asarray(LINEAR[image[..., 1]] * 255 + 0.5).astype(np.uint8)


def chessboard() -> Iterator[Figure]:
    """The corners of a chessboard, against the projection by the published matrix."""
    with scene(BOARD) as sim:
        sim.step(12)
        eye = sim.context.component("robot.eye")
        flags = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
        _, corners = cv2.findChessboardCornersSB(grey(eye.local_data["image"]), (COLUMNS, ROWS), flags=flags)
        here, turned = eye.bge_object.world_pose()
        matrix = np.array(eye.local_data["intrinsic_matrix"])
    axes = np.reshape(turned, (3, 3))
    seen = corners.reshape(-1, 2)
    points = [
        (1.5, (i - (COLUMNS - 1) / 2) * SQUARE, 1 + (j - (ROWS - 1) / 2) * SQUARE)
        for i in range(COLUMNS)
        for j in range(ROWS)
    ]
    rays = (np.array(points) - here) @ axes @ matrix.T
    wanted = rays[:, :2] / rays[:, 2:]
    nearest = np.linalg.norm(seen[:, None] - wanted[None], axis=2).argmin(axis=0)
    offset = seen[nearest] - wanted
    source = "projection by the published intrinsic matrix"
    for axis, name in enumerate("xy"):
        yield Figure(
            f"chessboard of {COLUMNS} × {ROWS} corners, by OpenCV",
            f"mean offset in {name}, pixels",
            0.0,
            float(offset[:, axis].mean()),
            0.05,
            source,
        )


def marker() -> Figure:
    """The position of an ArUco marker."""
    with scene(MARKER) as sim:
        sim.context.component("holder.marker").local_data["y"] = -1.0
        sim.step(12)
        eye = sim.context.component("robot.eye")
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        parameters.cornerRefinementWinSize = 3
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_ARUCO_ORIGINAL)
        corners, _, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey(eye.local_data["image"]))
        here, turned = eye.bge_object.world_pose()
        matrix = np.array(eye.local_data["intrinsic_matrix"])
    half = 0.04
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    flags = cv2.SOLVEPNP_IPPE_SQUARE
    _, _, place = cv2.solvePnP(square, corners[0].reshape(4, 2), matrix, np.zeros(5), flags=flags)
    position = np.reshape(turned, (3, 3)) @ place.ravel() + here
    error = math.dist(position.tolist(), (0.0, 0.0, 1.0))
    return Figure(
        "marker of 8 cm at 2.3 m, by OpenCV", "error of its position, m", 0.0, error, 0.008, "its pose in the scene"
    )
