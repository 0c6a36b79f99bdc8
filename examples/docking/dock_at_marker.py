"""A robot finds an ArUco marker with OpenCV and its camera, and stops 0.6 m in front of it.

pip install opencv-python-headless
python dock_at_marker.py
"""

import math

import cv2
import numpy as np

import morse

#: m: half the side of the marker; where to stop. Ticks between two pictures
HALF, STOP, TICKS = 0.04, 0.6, 12
MOST_PICTURES = 150


def scene():
    """A Pioneer with a camera 1 m above the ground, 2.2 m in front of a marker and 0.3 m aside."""
    from morse.builder import Arucomarker, Environment, FakeRobot, MotionVW, Pioneer3DX, Pose, VideoCamera

    robot = Pioneer3DX()
    robot.translate(x=2.2, y=-0.3)
    robot.rotate(z=math.pi)
    motion, pose, eye = MotionVW(), Pose(), VideoCamera()
    eye.translate(z=1.0)
    eye.properties(cam_width=960, cam_height=720, cam_fov=60.0)
    for part in (motion, pose, eye):
        robot.append(part)
    holder = FakeRobot()
    marker = Arucomarker()
    holder.append(marker)
    Environment("empty")


def locate(picture, matrix, detector):
    """The place of the marker from the camera: right, down, ahead, m; None if it is not seen."""
    corners, ids, _ = detector.detectMarkers(cv2.cvtColor(np.ascontiguousarray(picture[..., :3]), cv2.COLOR_RGB2GRAY))
    if ids is None:
        return None
    square = np.array([(-HALF, HALF, 0), (HALF, HALF, 0), (HALF, -HALF, 0), (-HALF, -HALF, 0)])
    _, _, place = cv2.solvePnP(square, corners[0].reshape(4, 2), matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    return place.ravel()


def dock():
    """Drive to the marker; return the final true distance of the camera from it, and its true bearing, m and rad."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_ARUCO_ORIGINAL)
    detector = cv2.aruco.ArucoDetector(dictionary, cv2.aruco.DetectorParameters())
    with morse.load(scene) as sim:
        sim.holder.marker.publish({"y": -1.0})  # Y is down: 1 m above the ground
        sim.step(30)
        for _ in range(MOST_PICTURES):
            data = sim.robot.eye.data
            place = locate(np.asarray(data["image"]), np.array(data["intrinsic_matrix"]), detector)
            if place is None:
                sim.robot.motion.publish({"v": 0.0, "w": 0.2})
            else:
                right, _, ahead = place
                if ahead < STOP:
                    break
                w = max(-0.4, min(-2.0 * math.atan2(right, ahead), 0.4))
                sim.robot.motion.publish({"v": min(0.3, 0.1 + 0.5 * (ahead - STOP)), "w": w})
            sim.step(TICKS)
        sim.robot.motion.publish({"v": 0.0, "w": 0.0})
        sim.step(30)
        here = sim.robot.pose.data
        return math.hypot(here["x"], here["y"]), math.remainder(
            math.atan2(-here["y"], -here["x"]) - here["yaw"], math.tau
        )


if __name__ == "__main__":
    print("docked {:.3f} m in front of the marker, {:.1f} degrees off".format(*np.multiply(dock(), (1.0, 57.29578))))
