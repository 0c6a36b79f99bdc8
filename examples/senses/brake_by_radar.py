"""In fog, a car brakes for what its radar sees: it stops before a parked car, and not for a sign beside the road.

    python examples/senses/brake_by_radar.py

The radar has the errors of a real one. The car brakes with 5 m/s² as soon as the distance to what is in its lane, at
the speed at which it approaches, demands it. A second run, with a lidar of 60 m, shows why: in fog with a range of
sight of 20 m its echoes are lost beyond 11 m, and the car brakes too late.
"""

from __future__ import annotations

import math

import morse

SPEED, BRAKE, MARGIN, LANE = 12.0, 5.0, 4.0, 1.5
DT = 0.05


def scene() -> None:
    """Describe the world."""
    from morse.builder import ATRV, Cube, Empty, Environment, LaserScanner, MotionVW, Pose, Radar

    car = ATRV()
    car.translate(z=0.2)
    motion, pose, radar = MotionVW(), Pose(), Radar()
    radar.translate(x=0.5, z=0.6)
    radar.properties(elevation_fov=4.0, errors=True)
    lidar = LaserScanner()
    lidar.translate(x=0.5, z=0.6)
    lidar.properties(laser_range=60.0, scan_window=2.0, resolution=0.5)
    lidar.frequency(20)
    for part in (motion, pose, radar, lidar):
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
    env = Environment("empty", fastmode=True)
    env.weather(fog=20.0)


def room_by_radar(car) -> float:
    """The distance of the nearest detection in the lane that comes nearer, m."""
    found = car.radar.get()["detections"]
    ahead = [one for one in found if abs(one["range"] * math.sin(one["azimuth"])) < LANE and one["velocity"] < -0.5]
    return min((one["range"] for one in ahead), default=math.inf)


def room_by_lidar(car) -> float:
    """The distance of the nearest echo, m, except that of the fog itself before the scanner."""
    ranges = car.lidar.get()["range_list"]
    return min((one for one in ranges if 2.0 < one < 60.0), default=math.inf)


def drive(look) -> tuple[float, float, float]:
    """Drive until the car stands, or has hit; return its distance to the parked car, m, and two speeds, m/s.

    The speeds are that at the sign, and that at which it hits the parked car.
    """
    speed, at_sign, at_hit = SPEED, 0.0, 0.0
    with morse.load(scene, seed=1, sockets=False) as simulation:
        car, touched = simulation.car, simulation.car.contacts()
        while speed > 0.0 and simulation.time() < 30.0:
            room = look(car) - MARGIN
            if speed < SPEED or speed**2 / (2.0 * BRAKE) > room:
                speed = max(speed - BRAKE * DT, 0.0)
            car.motion.publish({"v": speed, "w": 0.0})
            x = car.pose.data["x"]
            at_sign = speed if x < 40.0 else at_sign
            if x > 66.0 and touched.touched:
                at_hit = speed
                break
        simulation.sleep(0.2)
        return 68.0 - car.pose.get()["x"], at_sign, at_hit


def main() -> tuple[float, float, float]:
    """Drive by radar, and by lidar; return distance and speed at the sign of the first, and the speed of the hit."""
    gap, at_sign, _ = drive(room_by_radar)
    print(f"By radar, the car passed the sign at {at_sign:.1f} m/s and stands {gap:.1f} m before the parked car.")
    _, _, at_hit = drive(room_by_lidar)
    print(f"By lidar, it hit the parked car at {at_hit:.1f} m/s.")
    return gap, at_sign, at_hit


if __name__ == "__main__":
    main()
