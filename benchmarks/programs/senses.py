"""What radar, sonar and event camera cost: processor seconds per simulated second, and the pace of events.

python -m benchmarks.programs.senses
"""

from __future__ import annotations

import argparse
from functools import partial

import morse
from benchmarks import stopwatch

#: sensor: its class, rate (Hz), properties, ticks per second
SENSES = {
    "sonar_512x256_10hz": ("ImagingSonar", 10.0, {"errors": True}),
    "events_320x240_100hz": ("EventCamera", 100.0, {"errors": True}),
    "radar_64x128_20hz": ("Radar", 20.0, {"errors": True}),
}


def scene(sensor: str, rate: float, properties: dict[str, object]) -> None:
    """Describe a robot that turns among boxes, with one sensor or none."""
    from morse import builder

    robot = builder.ATRV()
    motion = builder.MotionVW()
    robot.append(motion)
    if sensor:
        eye = getattr(builder, sensor)("eye")
        eye.translate(x=0.6, z=1.2)
        eye.frequency(rate)
        eye.properties(**properties)
        robot.append(eye)
    builder.Environment("indoors-1/boxes").simulator_frequency(100)


def cost(sensor: str, rate: float, properties: dict[str, object], seconds: float) -> stopwatch.Cost:
    """Return the times of a simulated second."""
    with morse.load(partial(scene, sensor, rate, properties), sockets=False) as simulation:
        simulation.robot.motion.publish({"v": 0.3, "w": 0.3})
        simulation.step(50)
        return stopwatch.cost_of(lambda: simulation.step(100), max(round(seconds / 5), 1))


def main() -> None:
    """Measure each sensor for about ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--secs", type=float, default=10.0)
    seconds = parser.parse_args().secs
    bare = cost("", 1.0, {}, seconds)
    figures = {}
    for name, (sensor, rate, properties) in SENSES.items():
        whole = cost(sensor, rate, properties, seconds)
        figures[f"{name}_cores"] = whole.processor - bare.processor
        figures[f"{name}_pace"] = 1.0 / whole.wall
    stopwatch.report(**figures)


if __name__ == "__main__":
    main()
