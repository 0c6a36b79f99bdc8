"""Crouches, and walks: two legs at a time swing forward while the others push."""

import math

from pymorse import Morse

STEP = 0.4  # time for which a pair of legs is in the air, s
LENGTH, LIFT = 0.06, 0.05  # m
LINK = 0.22  # length of thigh and shin, m


def angles(forward, height):
    """Angles of hip and knee that put a foot below the hip, this far forward."""
    reach = math.hypot(forward, height)
    bend = math.acos(reach / (2 * LINK))
    return math.atan2(-forward, height) + bend, -2 * bend


def leg(name, time, height):
    """The angles of the joints of a leg while it walks."""
    ahead = name in ("front_left", "rear_right")
    phase = (time / (2 * STEP) + (0.0 if ahead else 0.5)) % 1.0
    if phase < 0.5:  # in the air
        forward = -LENGTH * math.cos(2 * math.pi * phase)
        height -= LIFT * math.sin(2 * math.pi * phase)
    else:
        forward = LENGTH * math.cos(2 * math.pi * (phase - 0.5))
    return angles(forward, height)


def main():
    """Returns the walked distance, m, and the torque of a knee at rest, N m."""
    with Morse() as simu:
        legs = simu.walker.legs
        names = legs.get_joints().result()
        hip, knee = angles(0.0, 0.36)
        crouch = {name: hip if name.endswith("hip") else knee for name in names}
        legs.rotate_joints(crouch, 1.5).result()
        simu.sleep(1.0)
        torques = legs.joints.get_efforts().result()
        before = simu.walker.pose.get()
        points = []
        for tick in range(1, 150):
            time = tick / 30.0
            found = {}
            for name in ("front_left", "front_right", "rear_left", "rear_right"):
                found[name + "_hip"], found[name + "_knee"] = leg(name, time, 0.36)
            points.append({"positions": [found[name] for name in names], "time_from_start": time})
        legs.trajectory({"points": points}).result()
        after = simu.walker.pose.get()
        far = math.hypot(after["x"] - before["x"], after["y"] - before["y"])
        knees = [torque for name, torque in torques.items() if name.endswith("knee")]
        return far, sum(knees) / 4


if __name__ == "__main__":
    print("Walked %.1f m; at rest, a knee needs %.1f N m." % main())
