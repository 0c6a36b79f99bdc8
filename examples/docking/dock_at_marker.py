"""A robot finds an ArUco marker with OpenCV and its camera, and stops 0.6 m in front of it.

pip install opencv-python-headless
python dock_at_marker.py
python falsify_docking.py    # searches for starts from which it does not dock
"""

import math

import cv2
import numpy as np

import morse

#: m: half the side of the marker; where to stop. Ticks between two pictures
HALF, STOP, TICKS = 0.04, 0.6, 12
MOST_PICTURES = 250
DICTIONARY = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_ARUCO_ORIGINAL)


def scene(x=2.2, y=-0.3, yaw=0.0):
    """A Pioneer with a camera 1 m above the ground, which looks past a marker by an angle, rad."""
    from morse.builder import Arucomarker, Environment, FakeRobot, MotionVW, Pioneer3DX, Pose, VideoCamera

    robot = Pioneer3DX("robot")
    robot.translate(x=x, y=y)
    robot.rotate(z=math.pi + yaw)
    motion, pose, eye = MotionVW("motion"), Pose("pose"), VideoCamera("eye")
    eye.translate(z=1.0)
    eye.properties(cam_width=960, cam_height=720, cam_fov=60.0)
    for part in (motion, pose, eye):
        robot.append(part)
    holder = FakeRobot("holder")
    holder.append(Arucomarker("marker"))
    Environment("empty")


def locate(picture, matrix):
    """The place of the marker from the camera: right, down, ahead, m; None if it is not seen."""
    grey = cv2.cvtColor(np.ascontiguousarray(picture[..., :3]), cv2.COLOR_RGB2GRAY)
    # enlarged, because the detector needs about four pixels for a cell of the marker
    large = cv2.resize(grey, None, fx=2.0, fy=2.0, interpolation=cv2.INTER_CUBIC)
    corners, ids, _ = cv2.aruco.ArucoDetector(DICTIONARY, cv2.aruco.DetectorParameters()).detectMarkers(large)
    if ids is None:
        return None
    square = np.array([(-HALF, HALF, 0), (HALF, HALF, 0), (HALF, -HALF, 0), (-HALF, -HALF, 0)])
    pixels = (corners[0].reshape(4, 2) - 0.5) / 2.0
    _, _, place = cv2.solvePnP(square, pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    return place.ravel()


def dock(sim):
    """Drive to the marker; return whether it has arrived, and the true distance and bearing of the marker, m, rad."""
    sim.holder.marker.publish({"y": -1.0})  # Y is down: 1 m above the ground
    sim.step(30)
    docked = False
    for _ in range(MOST_PICTURES):
        data = sim.robot.eye.data
        place = locate(np.asarray(data["image"]), np.array(data["intrinsic_matrix"]))
        if place is None:
            sim.robot.motion.publish({"v": 0.0, "w": 0.2})
        else:
            right, _, ahead = place
            docked = ahead < STOP
            if docked:
                break
            w = max(-0.4, min(-2.0 * math.atan2(right, ahead), 0.4))
            sim.robot.motion.publish({"v": min(0.3, 0.1 + 0.5 * (ahead - STOP)), "w": w})
        sim.step(TICKS)
    sim.robot.motion.publish({"v": 0.0, "w": 0.0})
    sim.step(30)
    here = sim.robot.pose.data
    bearing = math.remainder(math.atan2(-here["y"], -here["x"]) - here["yaw"], math.tau)
    return {"docked": int(docked), "distance": math.hypot(here["x"], here["y"]), "bearing": bearing}


if __name__ == "__main__":
    with morse.load(scene) as simulation:
        end = dock(simulation)
    told = "docked" if end["docked"] else "has not found the marker:"
    print(f"{told} {end['distance']:.3f} m in front of the marker, {math.degrees(end['bearing']):.1f} degrees off")
