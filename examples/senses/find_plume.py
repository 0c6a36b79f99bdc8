"""A robot finds a leak: it surges upwind while it smells gas, and casts across the wind when it does not.

    python examples/senses/find_plume.py

It knows the wind, but not the plume, which consists of puffs with gaps between them. The rule is that of moths
(J. Farrell, S. Pang, W. Li, "Chemical plume tracing via an autonomous underwater vehicle", 2005). Where it comes back
again and again is the leak.
"""

from __future__ import annotations

import math

import morse

LEAK = (-9.0, 2.5)
SPEED, TRACE, WHILE = 1.0, 2e-3, 150


def scene() -> None:
    """Describe the world."""
    from morse.builder import Empty, Environment, FakeRobot, GasSensor, MotionXYW, Pose

    robot = FakeRobot()
    robot.translate(x=9.0, y=-1.0, z=1.0)
    motion, nose, pose = MotionXYW(), GasSensor(), Pose()
    for part in (motion, nose, pose):
        robot.append(part)
    leak = Empty("leak")
    leak.translate(*LEAK, 1.0)
    leak.properties(gas_source=3.0)
    Environment("empty", fastmode=True).properties(wind_x=0.9, wind_y=-0.1)


def main() -> tuple[float, float]:
    """Search for at most 300 s; return the error of the place that it finds (m), and the time (s)."""
    side, cast, leg, lost, peak = 1.0, 1.0, 0.0, 100.0, 0.0
    track: list[tuple[float, float]] = []
    with morse.load(scene, seed=4, sockets=False) as simulation:
        robot = simulation.robot
        simulation.sleep(20.0)
        begin = simulation.time()
        while simulation.time() - begin < 300.0:
            gas = robot.nose.get()["concentration"]
            track.append((robot.pose.data["x"], robot.pose.data["y"]))
            recent = track[-WHILE:]
            if len(track) > WHILE and max(x for x, _ in recent) - min(x for x, _ in recent) < 1.2:
                break  # it comes back to the same place again and again
            peak = max(0.98 * peak, gas)
            lost = 0.0 if gas > max(TRACE, 0.4 * peak) else lost + 0.1
            if lost < 0.5:
                x, y, cast, leg = -SPEED, 0.0, 1.0, 0.0
            else:
                # across the wind, each time farther, and slowly back
                x, y, leg = 0.2 * SPEED, side * SPEED, leg + 0.1
                if leg > cast:
                    side, cast, leg = -side, min(cast * 1.6, 8.0), 0.0
            robot.motion.publish({"x": x, "y": y, "w": 0.0})
        passed = simulation.time() - begin
    place = [sum(axis) / len(recent) for axis in zip(*recent, strict=True)]
    distance = math.dist(place, LEAK)
    print(f"The robot says where the leak is, to {distance:.2f} m, after {passed:.0f} s.")
    return distance, passed


if __name__ == "__main__":
    main()
