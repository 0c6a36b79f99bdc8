"""A robot drives twice round a square by an extended Kalman filter of filterpy, from its odometry and its GPS.

    pip install "filterpy>=2,<3"
    python drive_by_filter.py
    python falsify_filter.py     # searches for the smallest error of the first heading with which the filter fails

The odometry is 3 % short, and the GPS is 0.5 m off along each axis. The true pose is used
only at the end, to say how large the errors are.
"""

import math

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

import morse

#: corners, m; m/s; rad/s; ticks between two measurements of the GPS
CORNERS = [(6.0, 0.0), (6.0, 6.0), (0.0, 6.0), (0.0, 0.0)] * 2
SPEED, TURN, TICKS = 0.8, 0.6, 12
#: standard deviations of the GPS, m, and of the odometry over each m
GPS_NOISE, WHEEL_NOISE = 0.5, 0.05
MOST_STEPS = 900


def scene():
    """A Pioneer with odometry and a GPS."""
    from morse.builder import GPS, Environment, MotionVW, Odometry, Pioneer3DX, Pose

    robot = Pioneer3DX("robot")
    motion, pose, gps, wheels = MotionVW("motion"), Pose("pose"), GPS("gps"), Odometry("wheels")
    gps.noise(gaussian=GPS_NOISE)
    for part in (motion, pose, gps, wheels):
        robot.append(part)
    Environment("empty")


class Localisation:
    """Where the robot believes to be.

    Args:
        yaw: the heading at the start, rad.
    """

    def __init__(self, yaw=0.0):
        self.filter = ExtendedKalmanFilter(dim_x=3, dim_z=2)
        self.filter.x = np.array([[0.0], [0.0], [yaw]])
        # the robot may have been put down with any heading: with 0.3 rad², what is 2.6 rad off is corrected too late
        self.filter.P = np.diag([0.25, 0.25, math.pi**2])
        self.filter.R = np.eye(2) * GPS_NOISE**2

    @property
    def pose(self):
        """x, y, m, and yaw, rad."""
        return tuple(float(value) for value in self.filter.x[:, 0])

    def move(self, forward, turn):
        """Take a motion by the wheels into account, m, rad."""
        x, y, yaw = self.pose
        middle = yaw + turn / 2.0
        self.filter.x = np.array(
            [[x + forward * math.cos(middle)], [y + forward * math.sin(middle)], [math.remainder(yaw + turn, math.tau)]]
        )
        change = np.array(
            [[1.0, 0.0, -forward * math.sin(middle)], [0.0, 1.0, forward * math.cos(middle)], [0.0, 0.0, 1.0]]
        )
        size = WHEEL_NOISE * abs(forward) + 1e-4
        noise = np.diag([size, size, 0.2 * size + 0.05 * abs(turn)]) ** 2
        self.filter.P = change @ self.filter.P @ change.T + noise

    def see(self, x, y):
        """Take a measurement of the GPS into account, m."""
        matrix = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        self.filter.update(np.array([[x], [y]]), lambda _: matrix, lambda state: state[:2])


def drive(sim, wrong=0.0):
    """Drive the square; return the root mean square errors of the filter, the GPS and the wheels alone, m.

    Args:
        wrong: error of the heading with which the filter begins, rad.
    """
    localisation, alone = Localisation(wrong), Localisation(wrong)
    corners, errors = list(CORNERS), []
    before = sim.robot.wheels.data
    for _ in range(MOST_STEPS):
        sim.step(TICKS)
        wheels, gps, true = sim.robot.wheels.data, sim.robot.gps.data, sim.robot.pose.data
        # 3 % short, as by wheels that are larger than the odometry believes
        forward = math.dist((wheels["x"], wheels["y"]), (before["x"], before["y"])) / 1.03
        turn = math.remainder(wheels["yaw"] - before["yaw"], math.tau)
        before = wheels
        for one in (localisation, alone):
            one.move(forward, turn)
        localisation.see(gps["x"], gps["y"])
        places = (localisation.pose[:2], (gps["x"], gps["y"]), alone.pose[:2])
        errors.append([math.dist(place, (true["x"], true["y"])) for place in places])
        x, y, yaw = localisation.pose
        if math.dist((x, y), corners[0]) < 0.4:
            corners.pop(0)
            if not corners:
                break
        error = math.remainder(math.atan2(corners[0][1] - y, corners[0][0] - x) - yaw, math.tau)
        sim.robot.motion.publish(
            {"v": SPEED if abs(error) < 0.8 else 0.2 * SPEED, "w": max(-TURN, min(1.2 * error, TURN))}
        )
    sim.robot.motion.publish({"v": 0.0, "w": 0.0})
    by_filter, by_gps, by_wheels = np.sqrt(np.mean(np.square(errors), axis=0))
    errors = {"filter": float(by_filter), "gps": float(by_gps), "wheels": float(by_wheels)}
    return {"corners": len(CORNERS) - len(corners), **errors}


if __name__ == "__main__":
    with morse.load(scene, seed=1) as sim:
        found = drive(sim)
    print("{corners} corners, errors: filter {filter:.3f} m, GPS {gps:.3f} m, wheels {wheels:.3f} m".format(**found))
