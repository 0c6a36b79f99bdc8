"""Control a height: P, PD, PID.

A lift hangs in the air, 0.5 m high. Write `step`, which returns the force of its motor, so that the lift rises to 2
m: after 5 s it has to stay within 2 cm of this height, and it must never rise above 2.2 m. The lift has a mass of 2
kg, so gravity pulls it down with 19.6 N. In a second trial it is heavier, and your program does not know by how much.

* P: a force proportional to the error, the distance to the target. The lift swings, and its mean height is too low.
  Why?
* D: less force the faster it rises. It swings less, and still hangs too low.
* I: add up error times seconds. This sum grows until the error is gone; a force proportional to it carries the
  weight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Control a height."""


class Controller:
    """Remembers what it needs from step to step."""

    def __init__(self):
        self.sum = 0.0
        self.before = None

    def step(self, target, height, seconds):
        """Return the force, N, from 0 to 60.

        Args:
            target: the height that is wanted, m.
            height: the present height, m.
            seconds: the time since the last step, s.
        """
        return 0.0


controller = Controller()


def step(target, height, seconds):
    return controller.step(target, height, seconds)
'''

_TARGET, _START = 2.0, 0.5
#: what ends higher than this has not come back, m
_GONE = 10.0


def scene() -> None:
    from morse.builder import Environment, ForceTorque, Pose, Quadrotor

    lift = Quadrotor("lift")
    lift.translate(z=0.5)
    lift.properties(GroundRobot=False)
    lift.set_mass(2.0)
    force = ForceTorque("motor")
    lift.append(force)
    pose = Pose("pose")
    lift.append(pose)

    env = Environment("empty")
    env.set_camera_location([0.0, -5.0, 1.5])
    env.set_camera_rotation([1.5, 0.0, 0.0])
    env.show(plots=["lift.pose.z"])


def _heights(attempt, load):
    """The heights of ten seconds, 60 a second, m."""
    lift = attempt.load(attempt.scene).lift
    heights: list[float] = []
    for _ in range(600):
        height = lift.pose.data["z"] if heights else _START
        force = attempt.number("step", _TARGET, height, 1 / 60)
        lift.motor.publish({"force": [0.0, 0.0, max(0.0, min(60.0, force)) - load], "torque": [0.0, 0.0, 0.0]})
        attempt.step(1 / 60)
        heights.append(lift.pose.data["z"])
    return heights


def check(attempt: Attempt) -> None:
    for load, name in ((0.0, "The lift"), (8.0, "The heavier lift")):
        heights = _heights(attempt, load)
        is_gone = heights[-1] > _GONE
        attempt.expect(
            max(heights) > 1.5, f"{name} rises above 1.5 m.", f"It rises to {max(heights):.2f} m: more force."
        )
        attempt.expect(
            1.5 < max(heights) <= 2.2,
            f"{name} stays below 2.2 m.",
            f"It rises to {max(heights):.2f} m: "
            + (
                "it has to rise above 1.5 m for this."
                if max(heights) <= 1.5
                else "less force when it is too high."
                if is_gone
                else "it needs damping (D)."
            ),
        )
        last = heights[300:]
        off, swing = max(abs(height - _TARGET) for height in last), max(last[-120:]) - min(last[-120:])
        attempt.expect(
            off <= 0.02,
            f"{name} is within 2 cm after 5 s.",
            f"It is up to {100 * off:.1f} cm off, {last[-1]:.2f} m high at the end: "
            + (
                "it has to rise above 1.5 m first."
                if max(heights) < 1.5
                else "less force when it is too high."
                if is_gone
                else "it still swings, which needs damping (D)."
                if swing > 0.05
                else "add the sum of errors (I)."
                if abs(last[-1] - _TARGET) > 0.02
                else "it arrives too late, so that the sum of errors (I) has to grow faster."
            ),
        )
