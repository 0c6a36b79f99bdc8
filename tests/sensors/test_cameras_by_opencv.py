"""OpenCV functions applied to images of cameras on robots."""

import math

import numpy as np
import pytest

from morse.rendering.textures import LINEAR

cv2 = pytest.importorskip("cv2")

MARKER = """
robot = FakeRobot("robot")
robot.translate(x=2.3, y=0.2, z=1.1)
robot.rotate(z=math.pi)
eye = VideoCamera("eye")
eye.properties(cam_width=640, cam_height=480, cam_fov=14.0{more})
eye.rotate(x={pan}, y={tilt})
robot.append(eye)
holder = FakeRobot("holder")
marker = Arucomarker("marker")
holder.append(marker)
env = Environment("empty")
"""


def seen(simulate, more="", pan=0.07, tilt=-0.03):
    simulation = simulate("import math\n" + MARKER.format(more=more, pan=pan, tilt=tilt), sockets=False)
    # Y is down: 1 m above the robot that carries it
    simulation.context.component("holder.marker").local_data["y"] = -1.0
    simulation.sleep(0.2)
    return simulation


@pytest.mark.parametrize(("more", "error"), [("", 0.005), (", distortion='-0.2, 0.05, 0.001, 0.001'", 0.01)])
def test_a_marker_is_found_where_it_is(simulate, more, error):
    simulation = seen(simulate, more)
    eye = simulation.context.component("robot.eye")
    # linear light, not sRGB codes: these would enlarge white areas
    grey = (LINEAR[eye.local_data["image"][..., 1]] * 255 + 0.5).astype(np.uint8)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    # within the white margin, which is 6 pixels wide
    parameters.cornerRefinementWinSize = 3
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_ARUCO_ORIGINAL), parameters)
    corners, ids, _ = detector.detectMarkers(grey)
    assert ids is not None
    assert ids.ravel().tolist() == [100]
    half = 0.04
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    matrix = np.array(eye.local_data["intrinsic_matrix"])
    bend = np.array(getattr(eye.lens, "coefficients", np.zeros(5)))
    _, _, place = cv2.solvePnP(square, corners[0].reshape(4, 2), matrix, bend, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    here, turned = eye.bge_object.world_pose()
    found = np.reshape(turned, (3, 3)) @ place.ravel() + here
    # the face of the marker is 1 mm in front of its centre
    np.testing.assert_allclose(found, (0.0, 0.0, 1.0), atol=error)
    assert math.dist(here, (0, 0, 1)) > 2


STEREO = """
robot = FakeRobot("robot")
robot.translate(z=1)
stereo = StereoUnit("stereo")
robot.append(stereo)
for name, y in (("left", 0.1), ("right", -0.1)):
    eye = VideoCamera(name)
    eye.properties(cam_width=320, cam_height=240, cam_focal=32)
    eye.translate(y=y)
    stereo.append(eye)
depth = DepthVideoCamera("depth")
depth.properties(cam_width=320, cam_height=240, cam_focal=32, cam_near=0.1, cam_far=50, Vertical_Flip=True)
depth.translate(y=0.1)
robot.append(depth)
import random
numbers = random.Random(4)
for i in range(160):
    spot = Cube(f"Spot{i}")
    far = numbers.choice((4.0, 6.0, 8.0))
    spot.location = (far, numbers.uniform(-0.5, 0.5) * far, 1 + numbers.uniform(-0.35, 0.35) * far)
    spot.scale = (0.01, numbers.uniform(0.1, 0.3), numbers.uniform(0.1, 0.3))
    spot.color(*(numbers.random() for _ in range(3)))
    spot._bpy_object.game.physics_type = "NO_COLLISION"
env = Environment("empty")
"""


def test_stereo_matching_gives_the_depth_of_the_depth_camera(simulate):
    simulation = simulate(STEREO, sockets=False)
    simulation.sleep(0.2)
    left, right = (
        cv2.cvtColor(
            np.ascontiguousarray(simulation.context.component(f"robot.stereo.{name}").local_data["image"][..., :3]),
            cv2.COLOR_RGB2GRAY,
        )
        for name in ("left", "right")
    )
    matcher = cv2.StereoSGBM.create(minDisparity=0, numDisparities=32, blockSize=5, P1=200, P2=800, uniquenessRatio=10)
    disparity = matcher.compute(left, right).astype(np.float32) / 16
    depth = simulation.context.component("robot.depth").local_data["image"]
    # f = 320 px, 0.2 m apart
    known = (disparity > 3) & np.isfinite(depth)
    known[:, :40] = False
    assert known.mean() > 0.15
    errors = np.abs(320 * 0.2 / disparity[known] - depth[known]) / depth[known]
    assert np.median(errors) < 0.02
