"""A robot drives twice round a square in the office by the estimate of KISS-ICP, which sees nothing but its lidar.

    pip install kiss-icp
    python drive_by_lidar.py

KISS-ICP (Vizzo et al., IEEE Robotics and Automation Letters 8, 2023) matches each scan with the map of the former ones.
The true pose is used only at the end, to say how large the error is.
"""

import math

import numpy as np
from kiss_icp.config import KISSConfig
from kiss_icp.kiss_icp import KissICP

import morse

#: corners relative to the start, m; m/s; rad/s; ticks between two scans at 10 Hz
CORNERS = [(1.6, 0.0), (1.6, 1.6), (0.0, 1.6), (0.0, 0.0)] * 2
SPEED, TURN, TICKS = 0.5, 0.5, 6
MOST_SCANS = 1500


def scene():
    """A Pioneer with a lidar of 16 layers in the office."""
    from morse.builder import Environment, LaserScanner, MotionVW, Pioneer3DX, Pose

    robot = Pioneer3DX()
    motion, pose, lidar = MotionVW(), Pose(), LaserScanner()
    lidar.translate(z=0.6)
    lidar.properties(scan_window=360.0, resolution=1.0, layers=16, layer_separation=2.0, laser_range=30.0)
    lidar.frequency(10)
    for part in (motion, pose, lidar):
        robot.append(part)
    Environment("indoors-1/office")


def drive():
    """Drive the square; return the estimated and the true track, (N, 2) each, relative to the start."""
    config = KISSConfig()
    config.data.max_range, config.data.min_range, config.data.deskew = 30.0, 0.5, False
    config.mapping.voxel_size = 0.15
    odometry = KissICP(config)
    estimates, truth = [], []
    with morse.load(scene) as sim:
        corners = list(CORNERS)
        begin = sim.robot.pose.data
        c, s, start = math.cos(begin["yaw"]), math.sin(begin["yaw"]), (begin["x"], begin["y"])
        for _ in range(MOST_SCANS):
            sim.step(TICKS)
            points = np.asarray(sim.robot.lidar.data["point_list"], dtype=np.float64)
            odometry.register_frame(points[np.any(points != 0.0, axis=1)], np.zeros(0))
            matrix = odometry.last_pose
            x, y, yaw = matrix[0, 3], matrix[1, 3], math.atan2(matrix[1, 0], matrix[0, 0])
            true = sim.robot.pose.data
            east, north = true["x"] - start[0], true["y"] - start[1]
            estimates.append((x, y))
            truth.append((c * east + s * north, c * north - s * east))
            if math.dist((x, y), corners[0]) < 0.1:
                corners.pop(0)
                if not corners:
                    break
            error = math.remainder(math.atan2(corners[0][1] - y, corners[0][0] - x) - yaw, math.tau)
            forward = SPEED if abs(error) < 0.3 else 0.0
            sim.robot.motion.publish({"v": forward, "w": max(-TURN, min(1.5 * error, TURN))})
        assert not corners, f"{len(corners)} corners are left"
    return np.array(estimates), np.array(truth)


if __name__ == "__main__":
    estimates, truth = drive()
    way = float(np.sum(np.linalg.norm(np.diff(truth, axis=0), axis=1)))
    error = float(np.linalg.norm(estimates[-1] - truth[-1]))
    print(f"driven {way:.2f} m, final error {error:.3f} m, drift {100.0 * error / way:.2f} %")
