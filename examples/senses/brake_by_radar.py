"""A car brakes for what its radar sees: it stops before a parked car, and not for a sign beside the road.

    python examples/senses/brake_by_radar.py

The radar has the errors of a real one. The car brakes with 5 m/s² as soon as the distance to what is in its lane, at
the speed at which it approaches, demands it.
"""

from __future__ import annotations

import math

import morse

SPEED, BRAKE, MARGIN, LANE = 12.0, 5.0, 4.0, 1.5
DT = 0.05


def scene() -> None:
    """Describe the world."""
    from morse.builder import ATRV, Cube, Empty, Environment, MotionVW, Pose, Radar

    car = ATRV()
    car.translate(z=0.2)
    motion, pose, radar = MotionVW(), Pose(), Radar()
    radar.translate(x=0.5, z=0.6)
    radar.properties(elevation_fov=4.0, errors=True)
    for part in (motion, pose, radar):
        car.append(part)
    road = Cube("road")
    road.scale = (60.0, 6.0, 0.5)
    road.translate(x=50.0, z=-0.5)
    road.color(0.25, 0.25, 0.27)
    road.static()
    parked = Cube("parked")
    parked.scale = (2.0, 0.9, 0.7)
    parked.translate(x=70.0, z=0.75)
    parked.color(0.6, 0.1, 0.1)
    parked.properties(radar_reflectivity=1.0)
    parked.static()
    sign = Empty("sign")
    sign.translate(40.0, 4.0, 0.9)
    sign.properties(radar_corner=0.15)
    Environment("empty", fastmode=True)


def main() -> tuple[float, float]:
    """Drive until the car stands; return its distance to the parked car and the speed at the sign, m and m/s."""
    speed, at_sign = SPEED, 0.0
    with morse.load(scene, seed=1, sockets=False) as simulation:
        car = simulation.car
        while speed > 0.0 and simulation.time() < 30.0:
            found = car.radar.get()["detections"]
            ahead = [
                one for one in found if abs(one["range"] * math.sin(one["azimuth"])) < LANE and one["velocity"] < -0.5
            ]
            room = min((one["range"] for one in ahead), default=math.inf) - MARGIN
            if speed < SPEED or speed**2 / (2.0 * BRAKE) > room:
                speed = max(speed - BRAKE * DT, 0.0)
            car.motion.publish({"v": speed, "w": 0.0})
            x = car.pose.data["x"]
            at_sign = speed if x < 40.0 else at_sign
        simulation.sleep(0.2)
        gap = 68.0 - car.pose.get()["x"]
    print(f"The car passed the sign at {at_sign:.1f} m/s and stands {gap:.1f} m before the parked car.")
    return gap, at_sign


if __name__ == "__main__":
    main()
