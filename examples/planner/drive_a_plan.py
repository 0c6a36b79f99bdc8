"""A robot maps what its laser scanner sees, python_motion_planning plans a way round it, and the robot drives it.

    pip install python_motion_planning
    python drive_a_plan.py

The map is a grid of 0.1 m of the places that were hit by a ray. A* plans again each second.
"""

import math

import numpy as np
from python_motion_planning.common import TYPES, Grid
from python_motion_planning.path_planner import AStar

import morse

#: m; m/s; rad/s; ticks between two plans; distance that the robot keeps, m
GOAL, CELL, SPEED, TURN, TICKS, ROOM = (7.0, 0.0), 0.1, 0.5, 0.8, 60, 0.45
LOW, HIGH = -6.0, 12.0
MOST_PLANS = 120


def scene():
    """A Pioneer with a laser scanner, and a wall across its way."""
    from morse.builder import Environment, LaserScanner, MotionVW, PassiveObject, Pioneer3DX, Pose

    robot = Pioneer3DX()
    motion, pose, scan = MotionVW(), Pose(), LaserScanner()
    scan.translate(z=0.25)
    scan.properties(scan_window=360.0, resolution=0.5, laser_range=8.0)
    for part in (motion, pose, scan):
        robot.append(part)
    for number in range(5):
        box = PassiveObject("props/objects", "BoxStand")
        box.translate(x=3.0, y=-1.6 + 0.8 * number)
    Environment("empty")


def cells(points):
    """Indices of the cells of positions (N, 2), m."""
    return np.clip(((points - LOW) / CELL).astype(int), 0, round((HIGH - LOW) / CELL) - 1)


def drive():
    """Drive to the goal; return the final distance from it, the length of the way, and the least distance, m."""
    grid = Grid(bounds=[[LOW, HIGH], [LOW, HIGH]], resolution=CELL)
    hits = np.zeros(np.shape(grid.type_map.data), dtype=bool)
    way, nearest = 0.0, math.inf
    with morse.load(scene) as sim:
        sim.step(10)
        before = sim.robot.pose.data
        for _ in range(MOST_PLANS):
            here, scan = sim.robot.pose.data, sim.robot.scan.data
            c, s = math.cos(here["yaw"]), math.sin(here["yaw"])
            points = np.asarray(scan["point_list"])[:, :2]
            points = points[np.any(points != 0.0, axis=1)]
            seen = cells(points @ np.array([[c, s], [-s, c]]) + (here["x"], here["y"]))
            hits[seen[:, 0], seen[:, 1]] = True
            grid.type_map[:] = TYPES.FREE
            reach = math.ceil(ROOM / CELL)
            for i, j in np.argwhere(hits):
                grid.type_map[max(0, i - reach) : i + reach + 1, max(0, j - reach) : j + reach + 1] = TYPES.OBSTACLE
            start, goal = (tuple(map(int, cells(np.array(place)))) for place in ((here["x"], here["y"]), GOAL))
            path, told = AStar(map_=grid, start=start, goal=goal).plan()
            assert told["success"], "there is no way"
            way_points = np.array(path) * CELL + LOW + CELL / 2.0
            for _ in range(TICKS):
                here = sim.robot.pose.data
                way += math.dist((here["x"], here["y"]), (before["x"], before["y"]))
                before = here
                nearest = min(nearest, float(np.min(sim.robot.scan.data["range_list"])))
                left = math.dist((here["x"], here["y"]), GOAL)
                if left < 0.15:
                    return left, way, nearest
                away = np.linalg.norm(way_points - (here["x"], here["y"]), axis=1)
                ahead = way_points[min(int(np.argmin(away)) + 5, len(way_points) - 1)]
                error = math.remainder(math.atan2(ahead[1] - here["y"], ahead[0] - here["x"]) - here["yaw"], math.tau)
                sim.robot.motion.publish(
                    {"v": SPEED if abs(error) < 0.5 else 0.0, "w": max(-TURN, min(2.0 * error, TURN))}
                )
                sim.step()
    raise AssertionError("the robot did not arrive")


if __name__ == "__main__":
    print("at the goal within {:.2f} m, after {:.1f} m, never closer than {:.2f} m to anything".format(*drive()))
