"""OpenCV calibrates a camera from images of a chessboard, and finds the parameters of the lens."""

import numpy as np
import pytest
from studio import Studio, Tripod, body, triangles

from morse.rendering import Lens
from morse.rendering.textures import LINEAR
from morse.scene import Material

cv2 = pytest.importorskip("cv2")

COLUMNS, ROWS, SIDE = 9, 7, 0.1
LENS = Lens(640, 480, 520.0, 500.0, 330.0, 228.0, 0.05, 50.0)


def chessboard():
    """Squares of two colours, with a white margin, in the plane z = 0."""
    points, faces, slots = [], [], []
    for i in range(-1, COLUMNS + 1):
        for j in range(-1, ROWS + 1):
            first = len(points)
            points += [(i * SIDE, j * SIDE, 0), ((i + 1) * SIDE, j * SIDE, 0)]
            points += [((i + 1) * SIDE, (j + 1) * SIDE, 0), (i * SIDE, (j + 1) * SIDE, 0)]
            faces += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
            inside = 0 <= i < COLUMNS and 0 <= j < ROWS
            slots += [int(inside and (i + j) % 2 == 0)] * 2
    node = body("Board", triangles(points, faces, index=slots))
    white = Material("white", color=(1, 1, 1, 1), shadeless=True)
    node.materials = [white, Material("black", color=(0, 0, 0, 1), shadeless=True)]
    return node


def test_the_lens_is_found_from_pictures_of_a_chessboard():
    studio = Studio(chessboard())
    middle = np.array([COLUMNS * SIDE / 2, ROWS * SIDE / 2, 0.0])
    inner = (COLUMNS - 1, ROWS - 1)
    grid = np.zeros((inner[0] * inner[1], 3), np.float32)
    grid[:, :2] = np.mgrid[1 : inner[0] + 1, 1 : inner[1] + 1].T.reshape(-1, 2) * SIDE
    places, found = [], []
    for x, y, z in [(0, 0, 1.2), (0.7, 0, 1.0), (-0.7, 0.2, 1.1), (0.1, 0.7, 1.0), (0.2, -0.8, 1.1), (0.5, 0.5, 0.9),
                    (-0.6, -0.5, 1.0), (-0.5, 0.6, 1.2)]:  # fmt: skip
        picture = studio.look(
            Tripod(middle + np.array([x, y, z]), middle + np.array([0.05 * x, 0, 0]), up=(0, 1, 0)), LENS
        )
        # linear light, not sRGB codes: these would shift the edges between black and white
        gray = (LINEAR[picture.rgb[..., 0]] * 255 + 0.5).astype(np.uint8)
        seen, corners = cv2.findChessboardCorners(gray, inner)
        if seen:
            window = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
            found.append(cv2.cornerSubPix(gray, corners, (5, 5), (-1, -1), window))
            places.append(grid)
    assert len(found) >= 6
    size, flags = (LENS.width, LENS.height), cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST
    error, matrix, distortion, _, _ = cv2.calibrateCamera(places, found, size, None, None, flags=flags)
    assert error < 0.1
    # the centre of the first pixel is at 0 in OpenCV, at 0.5 here
    assert [matrix[0, 0], matrix[1, 1]] == pytest.approx([LENS.fx, LENS.fy], abs=0.5)
    assert [matrix[0, 2], matrix[1, 2]] == pytest.approx([LENS.cx - 0.5, LENS.cy - 0.5], abs=0.15)
    assert abs(distortion.ravel()[0]) < 0.005
