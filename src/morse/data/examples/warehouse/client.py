"""Fetches a pallet from a rack, and puts it on a conveyor."""

import math

from pymorse import Morse

#: heights of the fork, m: in a pallet on the shelf, above the shelf, on the way, in a pallet on the belt
SHELF, RAISED, CARRIED, BELT = 1.1, 1.3, 0.75, 0.49
EAST, SOUTH = 0.0, -0.5 * math.pi


def straight(truck, v, heading, way, line):
    """Drive along a line.

    Args:
        v: speed, m/s, negative backwards.
        heading: of the truck, rad.
        way: coordinate along the heading at which it stops, m.
        line: coordinate of the line across the heading, m.
    """
    c, s = math.cos(heading), math.sin(heading)
    sign = math.copysign(1.0, v)
    while True:
        at = truck.pose.get()
        left = sign * (way - (c * at["x"] + s * at["y"]))
        if left < 0.02:
            break
        aside = line - (c * at["y"] - s * at["x"])
        turned = math.remainder(heading - at["yaw"], math.tau)
        speed = min(abs(v), 0.1 + 0.8 * left)
        truck.motion.publish({"v": sign * speed, "w": speed * (2.0 * turned + sign * aside)})
    truck.motion.publish({"v": 0.0, "w": 0.0})


def turn(truck, v, w, heading):
    """Drive along an arc until the truck has a heading, rad."""
    truck.motion.publish({"v": v, "w": w})
    while math.copysign(1.0, w) * math.remainder(heading - truck.pose.get()["yaw"], math.tau) > 0.02:
        pass
    truck.motion.publish({"v": 0.0, "w": 0.0})


def main():
    """Returns the load of the truck, kg, and where the pallet is in the end, m."""
    with Morse() as simu:
        truck = simu.truck
        truck.lift(SHELF).result()
        straight(truck, 1.0, EAST, 4.7, 0.75)
        truck.lift(RAISED).result()
        simu.sleep(0.5)
        load = -truck.scales.get()["force"][2] / 9.81
        straight(truck, -1.0, EAST, 2.0, 0.75)
        truck.lift(CARRIED).result()
        turn(truck, -0.5, -0.4, SOUTH)
        straight(truck, 0.8, SOUTH, 2.05, 0.5)
        truck.lift(BELT).result()
        simu.rpc("belt", "start")
        simu.sleep(6.0)
        simu.rpc("belt", "stop")
        simu.sleep(1.0)
        return load, simu.rpc("simulation", "get_scene_objects")["pallet"][1]


if __name__ == "__main__":
    print(
        "Carried %.0f kg; the pallet is on the belt, at (%.1f, %.1f, %.1f)." % (lambda load, at: (load, *at))(*main())
    )
