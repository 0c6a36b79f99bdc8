"""A robot delivers through a corridor of a hospital: people come towards it, sit and open a door.

    python examples/people/deliver.py

The robot sees by a laser scanner alone. In each step, it drives towards the direction that is free for its breadth and
nearest to that of the goal, and the slower the nearer somebody is.
"""

from __future__ import annotations

import math

import numpy as np

import morse

START, GOAL = -13.0, 13.0


def scene() -> None:
    """Describe the corridor: 30 m by 3.4 m, a room behind a door, a counter at its end, and a bench."""
    from morse.builder import Crowd, Cube, Door, Environment, Jido, MotionVW, Pose, Sick

    def block(
        name: str, x: float, y: float, length: float, depth: float, height: float = 2.4, color: float = 0.8
    ) -> None:
        solid = Cube(name)
        solid.scale, solid.location = (length / 2, depth / 2, height / 2), (x, y, height / 2)
        solid.color(0.8, 0.8, 0.76)
        solid.static()

    block("south", 0.0, -1.75, 32.0, 0.1)
    block("north left", -7.98, 1.75, 16.04, 0.1)
    block("north right", 9.0, 1.75, 14.0, 0.1)
    for name, x, y, length, depth in (("west", 0, 3.7, 0.1, 3.8), ("east", 4, 3.7, 0.1, 3.8), ("back", 2, 5.6, 4, 0.1)):
        block(f"room {name}", x, y, length, depth)
    block("beside the door", 1.52, 1.75, 0.96, 0.1)
    door = Door("door", kind="sliding")
    door.translate(0.55, 1.75)
    door.rotate(z=math.pi / 2)
    block("bench", -4.0, -1.45, 2.4, 0.45, height=0.45)
    for name, begin, goals, count in (("east", (-12, 8), [(14.5, -0.6)], 8), ("west", (4, 15), [(-14.5, 0.7)], 8)):
        crowd = Crowd(name, count, groups=0.3, children=0.1)
        crowd.start([(begin[0], -1.0), (begin[1], 1.0)], goals=[*goals, (begin[0], 0.0)], then="repeat")
    sitting, visiting = Crowd("sitting", 3), Crowd("visiting", 3)
    sitting.start([(-8, -1.2), (-6, 0)], goals=[(-4.8, -1.5), (-4.0, -1.5), (-3.2, -1.5)], then="sit")
    visiting.start([(-3, 0.0), (-1, 1.2)], goals=[(2, 4)])
    robot = Jido("robot")
    robot.translate(START, 0.0, 0.1)
    scan = Sick("scan")
    scan.translate(0.3, 0.0, 0.4)
    for part in (MotionVW("motion"), Pose("pose"), scan):
        robot.append(part)
    Environment("empty").set_camera_location([-8.0, -6.0, 6.0])


def steer(points: np.ndarray, ranges: np.ndarray, bearing: float) -> tuple[float, float]:
    """Return the speed, m/s, and the yaw rate, rad/s, towards a bearing, rad, around what a scan has hit."""
    hits = points[ranges < 4.0, :2]
    best, cost, free = 0.0, math.inf, 0.0
    for angle in np.radians(np.arange(-80, 81, 8)):
        along = hits[:, 0] * math.cos(angle) + hits[:, 1] * math.sin(angle)
        across = np.abs(hits[:, 1] * math.cos(angle) - hits[:, 0] * math.sin(angle))
        way = along[(along > 0.0) & (across < 0.5)].min(initial=3.0)
        price = abs(angle - bearing) + 0.8 * (3.0 - way)
        if price < cost:
            best, cost, free = float(angle), price, float(way)
    return max(0.0, min(0.9, 0.7 * (free - 0.5)) * math.cos(best)), 1.5 * best


def main(limit: float = 120.0) -> tuple[float, int]:
    """Drive to the other end; return the time it took, s, and how many contacts ISO/TS 15066 does not permit."""
    with morse.load(scene, seed=2, sockets=False) as simulation:
        robot = simulation.robot
        crowds = [getattr(simulation, name) for name in ("east", "west", "sitting", "visiting")]
        while simulation.time() < limit:
            simulation.step(3)
            here, seen = robot.pose.data, robot.scan.data
            if here["x"] > GOAL:
                break
            bearing = math.remainder(math.atan2(-here["y"], 2.0) - here["yaw"], math.tau)
            v, w = steer(np.array(seen["point_list"]), np.array(seen["range_list"]), bearing)
            robot.motion.publish({"v": v, "w": w})
        time, hard = simulation.time(), sum(crowd.data["exceeded"] for crowd in crowds)
    print(f"Delivered after {time:.0f} s, with {hard} contacts that were too hard.")
    return time, hard


if __name__ == "__main__":
    main()
