"""Fly a quadrotor through gates.

Four gates stand in a field, at different heights. Write `step`, which is called twenty times per second and returns a
velocity, so that the quadrotor flies through all gates, in order, within 60 s, and touches nothing. A gate is 1.6 m
wide and high.

* Fly to a point 1 m before the gate first, on its axis, and then through the gate to a point behind it.
* The quadrotor follows a new velocity slowly: after 4 s, it has made about two thirds of the change. Compute its
  present velocity from two places, 0.05 s apart. Where it differs from the velocity that you want, ask for more than
  the difference: that brakes in time.
* Remember which gate comes next.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Fly through gates."""


def step(place, gates):
    """Return the velocity that is wanted: x, y, z, m/s; each at most 3.

    Args:
        place: x, y, z of the quadrotor, m.
        gates: (x, y, z, yaw) of the middle of each gate, in order; fly through along the direction yaw.
    """
    return 0.0, 0.0, 0.0
'''

_GATES = [(4.0, 0.0, 1.8, 0.0), (8.0, 3.0, 2.8, 1.0), (6.0, 8.0, 2.3, 2.6), (0.0, 7.0, 1.8, -2.6)]
_OPENING = 1.6


def scene() -> None:
    import math

    from morse.builder import Cube, Environment, Pose, Quadrotor, RotorcraftVelocity

    drone = Quadrotor("drone")
    drone.translate(z=1.0)
    pilot = RotorcraftVelocity("pilot")
    drone.append(pilot)
    pose = Pose("pose")
    drone.append(pose)

    gates = [(4.0, 0.0, 1.8, 0.0), (8.0, 3.0, 2.8, 1.0), (6.0, 8.0, 2.3, 2.6), (0.0, 7.0, 1.8, -2.6)]
    for k, (x, y, z, yaw) in enumerate(gates):
        bars = [(-0.9, 0, 0.1, 1.0), (0.9, 0, 0.1, 1.0), (0, 0.9, 0.8, 0.1), (0, -0.9, 0.8, 0.1)]
        for part, (side, up, width, height) in enumerate(bars):
            bar = Cube(f"gate_{k}_{part}")
            bar.location = (x - side * math.sin(yaw), y + side * math.cos(yaw), z + up)
            bar.rotation_euler = (0.0, 0.0, yaw)
            bar.scale = (0.05, width, height)
            bar.set_color(0.9, 0.2 + 0.2 * k, 0.1)
            bar.static()

    env = Environment("empty")
    env.set_camera_location([4.0, -8.0, 7.0])
    env.set_camera_rotation([1.05, 0.0, 0.0])
    env.show(overlays=["trails"], follow=drone)


def _through(before, after, gate):
    """Whether a step leads through the opening of a gate, in its direction."""
    x, y, z, yaw = gate
    ahead = [(p[0] - x) * math.cos(yaw) + (p[1] - y) * math.sin(yaw) for p in (before, after)]
    if not ahead[0] < 0.0 <= ahead[1]:
        return False
    share = -ahead[0] / (ahead[1] - ahead[0])
    at = [a + share * (b - a) for a, b in zip(before, after, strict=True)]
    side = -(at[0] - x) * math.sin(yaw) + (at[1] - y) * math.cos(yaw)
    return max(abs(side), abs(at[2] - z)) < _OPENING / 2


def check(attempt: Attempt) -> None:
    drone = attempt.simulation.drone
    contacts, flown, steps = drone.contacts(), 0, 0
    attempt.step(0.05)
    before = tuple(drone.pose.data[axis] for axis in "xyz")
    while flown < len(_GATES) and steps < 1200 and not contacts.touched:
        velocity = attempt.numbers(3, "step", before, list(_GATES))
        vx, vy, vz = (max(-3.0, min(3.0, part)) for part in velocity)
        yaw = drone.pose.data["yaw"]
        forward, left = vx * math.cos(yaw) + vy * math.sin(yaw), vy * math.cos(yaw) - vx * math.sin(yaw)
        drone.pilot.publish({"vx": forward, "vy": left, "vz": vz, "vyaw": 0.0})
        attempt.step(0.05)
        after = tuple(drone.pose.data[axis] for axis in "xyz")
        flown += _through(before, after, _GATES[flown])
        before, steps = after, steps + 1
    place = at(*before)
    attempt.expect(
        flown and not contacts.touched,
        "The quadrotor touches nothing.",
        f"It touches something at {place} m." if contacts.touched else "This counts when it has flown through gate 1.",
    )
    for k in range(len(_GATES)):
        attempt.expect(
            flown > k,
            f"It flies through gate {k + 1}.",
            f"Gate {flown + 1} is the next one; it ends at {place} m." if flown == k else f"Gate {k} comes before it.",
        )
    attempt.expect(
        flown == len(_GATES),
        "It has flown through all gates within 60 s.",
        f"It is at {place} m after {steps / 20:.0f} s, behind {flown} of {len(_GATES)} gates.",
    )
