"""A submarine keeps 2 m above an uneven ground by its Doppler log and its echo sounder.

    python examples/senses/keep_altitude.py

It knows neither its pose nor the ground. The echo sounder measures the height, the log the velocity; where the log has
no lock, the submarine climbs.
"""

from __future__ import annotations

import math
from itertools import pairwise

import morse

HEIGHT, SPEED = 2.0, 0.8
#: depth of the ground below the start, m, every 6 m
GROUND = (20.0, 19.5, 18.6, 18.0, 18.0, 18.7, 19.6, 20.4, 20.9, 20.9)


def scene() -> None:
    """Describe the world."""
    from morse.builder import DVL, Cube, Drag, EchoSounder, Environment, ForceTorque, Pose, Submarine

    for index, (here, there) in enumerate(pairwise(GROUND)):
        slab = Cube(f"slab{index}")
        slab.scale = (3.2, 8.0, 0.5)
        slab.translate(6.0 * index + 3.0, 0.0, -(here + there) / 2.0 - 0.5)
        slab.rotate(y=math.atan2(there - here, 6.0))
        slab.color(0.5, 0.45, 0.3)
        slab.static()
    submarine = Submarine()
    submarine.translate(x=1.0, z=-17.0)
    engine, drag, log, sounder, pose = ForceTorque(), Drag(), DVL(), EchoSounder(), Pose()
    drag.properties(DragCoeffX=8.0, DragCoeffY=40.0, DragCoeffZ=40.0)
    log.properties(errors=True)
    sounder.properties(errors=True, beam_width=5.0)
    for part in (engine, drag, log, sounder, pose):
        submarine.append(part)
    Environment("empty", fastmode=True).set_gravity(0.001)  # it neither sinks nor rises


def main() -> tuple[float, float, float]:
    """Dive for 50 s; return the largest error of the height after 10 s, and the way by the log and by the pose, m."""
    worst = way = 0.0
    with morse.load(scene, seed=1, sockets=False) as simulation:
        submarine = simulation.submarine
        mass = simulation.context.robots["submarine"].bge_object.mass
        begin = submarine.pose.get()["x"]
        for tick in range(500):
            depth, log = submarine.sounder.get()["depth"], submarine.log.data
            forward, _, climb = log["velocity"] if log["locked"] else (0.0, 0.0, 0.0)
            error = HEIGHT - depth if math.isfinite(depth) else 1.0
            thrust = mass * (SPEED - forward) + 8.0 * SPEED**2 if log["locked"] else 0.0
            lift = mass * (5.0 * error - 4.0 * climb)
            submarine.engine.publish({"force": [thrust, 0.0, lift], "torque": [0.0, 0.0, 0.0]})
            way += forward * 0.1
            if tick > 100:
                worst = max(worst, abs(error))
        passed = submarine.pose.get()["x"] - begin
    print(f"The height was 2 m to {worst:.2f} m; {way:.1f} m by the log, {passed:.1f} m by the pose.")
    return worst, way, passed


if __name__ == "__main__":
    main()
