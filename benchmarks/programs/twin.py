"""Ten planted parameters of three robots: are they found in a noisy log, and is the stated spread true?

``python -m benchmarks.programs.twin --seeds 3`` prints a line of JSON for each log, ``--table FILE`` a table for the
documentation. The values are drawn by the seed, within 20 % of those of the scene, or from a range.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import morse
from morse.many import Twin

if TYPE_CHECKING:
    from collections.abc import Callable

#: length of a log, s
LENGTH = 60.0

ROVER = """
from morse.builder import *

robot = Pioneer3DX("robot")
motion, pose, imu = MotionVWDiff("motion"), Pose("pose"), IMU("imu")
pose.frequency(20)
imu.translate(x=0.1, z=0.2)
for part in (motion, pose, imu):
    robot.append(part)
env = Environment("empty")
"""
ARM_FILE = """<robot name='arm'><link name='world'/>
<link name='upper'><inertial><origin xyz='0 0 0.25'/><mass value='3'/>
<inertia ixx='0.06' iyy='0.06' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>
<link name='fore'><inertial><origin xyz='0 0 0.2'/><mass value='1.5'/>
<inertia ixx='0.02' iyy='0.02' izz='0.004' ixy='0' ixz='0' iyz='0'/></inertial></link>
<joint name='shoulder' type='revolute'><parent link='world'/><child link='upper'/><origin xyz='0 0 1.5'/>
<axis xyz='0 1 0'/><limit lower='-2.5' upper='2.5' effort='500' velocity='20'/>
<dynamics damping='2.0' friction='0.8'/></joint>
<joint name='elbow' type='revolute'><parent link='upper'/><child link='fore'/><origin xyz='0 0 0.5'/>
<axis xyz='0 1 0'/><limit lower='-2.5' upper='2.5' effort='300' velocity='20'/>
<dynamics damping='1.0' friction='0.3'/></joint></robot>
"""
ARM = """
from morse.builder import *

robot = Robot("arm.urdf")
arm = Armature("arm", armature_name="arm_joints")
arm.gains(150.0, 8.0, ["shoulder"])
arm.gains(60.0, 4.0, ["elbow"])
state = ArmaturePose("state")
arm.append(state)
robot.append(arm)
env = Environment("empty")
"""
QUADROTOR = """
from morse.builder import *

robot = Quadrotor("robot")
robot.translate(z=20.0)
motion, pose, imu = RotorcraftVelocity("motion"), Pose("pose"), IMU("imu")
pose.frequency(20)
for part in (motion, pose, imu):
    robot.append(part)
env = Environment("empty")
"""


class Robot(NamedTuple):
    """A robot with planted parameters.

    Attributes:
        script: of its scene.
        files: others beside it.
        noise: lines of the script of the real robot.
        parameters: names, and the range of the values; a range of factors if the first number is above 0.5.
        command: the commands from a time on.
        period: time for which a command holds, s.
    """

    script: str
    files: dict[str, str]
    noise: str
    parameters: dict[str, tuple[float, float]]
    command: Callable[[np.random.Generator, float], tuple[str, dict[str, float]]]
    period: float


_FACTOR = (0.8, 1.2)
ROBOTS = {
    "differential drive": Robot(
        ROVER,
        {},
        'pose.noise(gaussian=0.01)\nimu.noise(gaussian=0.02, field="angular_velocity")\n'
        'imu.noise(gaussian=0.1, field="linear_acceleration")\n',
        {
            "robot.wheel_radius": _FACTOR,
            "robot.track": _FACTOR,
            "robot.friction": (0.6, 1.0),
            "robot.motion.lag": (0.05, 0.2),
            "robot.motion.delay": (0.01, 0.1),
            "robot.imu.place.yaw": (-0.1, 0.1),
            "robot.imu.bias.angular_velocity.z": (-0.03, 0.03),
            "robot.imu.bias.linear_acceleration.x": (-0.2, 0.2),
            "robot.imu.gain.angular_velocity.z": (0.95, 1.05),
            "robot.pose.delay": (0.02, 0.12),
        },
        lambda rng, _: ("motion", {"v": 0.9 * rng.uniform(-1.0, 1.0), "w": 1.5 * rng.uniform(-1.0, 1.0)}),
        1.0,
    ),
    "arm": Robot(
        ARM,
        {"arm.urdf": ARM_FILE},
        "state.noise(gaussian=0.002)\n",
        {
            "robot.upper.mass": _FACTOR,
            "robot.fore.mass": _FACTOR,
            "robot.shoulder.damping": _FACTOR,
            "robot.elbow.damping": _FACTOR,
            "robot.shoulder.friction": _FACTOR,
            "robot.shoulder.gain": _FACTOR,
            "robot.elbow.gain": _FACTOR,
            "robot.arm.lag": (0.03, 0.1),
            "robot.arm.delay": (0.01, 0.08),
            "robot.arm.state.bias.shoulder": (-0.03, 0.03),
        },
        lambda rng, _: ("arm", {"shoulder": 1.2 * rng.uniform(-1.0, 1.0), "elbow": 1.5 * rng.uniform(-1.0, 1.0)}),
        1.0,
    ),
    "quadrotor": Robot(
        QUADROTOR,
        {},
        'pose.noise(gaussian=0.02)\nimu.noise(gaussian=0.01, field="angular_velocity")\n'
        'imu.noise(gaussian=0.1, field="linear_acceleration")\n',
        {
            "robot.mass": _FACTOR,
            "robot.motion.HorizontalPgain": _FACTOR,
            "robot.motion.VerticalPgain": _FACTOR,
            "robot.motion.RollPitchPgain": _FACTOR,
            "robot.motion.lag": (0.05, 0.2),
            "robot.motion.delay": (0.01, 0.1),
            "robot.imu.bias.angular_velocity.x": (-0.03, 0.03),
            "robot.imu.bias.linear_acceleration.z": (-0.2, 0.2),
            "robot.imu.place.yaw": (-0.1, 0.1),
            "robot.pose.delay": (0.02, 0.12),
        },
        lambda rng, _: (
            "motion",
            {
                "vx": 1.5 * rng.uniform(-1.0, 1.0),
                "vy": 1.5 * rng.uniform(-1.0, 1.0),
                "vz": 0.8 * rng.uniform(-1.0, 1.0),
                "vyaw": 0.6 * rng.uniform(-1.0, 1.0),
            },
        ),
        1.5,
    ),
}


def drawn(robot: Robot, scene: Path, rng: np.random.Generator) -> dict[str, float]:
    """The planted values: of a range of factors, times the value in the scene."""
    twin_values = {one.name: one.value for one in _parameters(scene, list(robot.parameters))}
    values = {}
    for name, (low, high) in robot.parameters.items():
        number = float(rng.uniform(low, high))
        is_factor = low > 0.5 and ".gain." not in name and name != "robot.friction"
        values[name] = number * twin_values[name] if is_factor else number
        if name.endswith("pose.delay"):
            # measurements are published in ticks
            values[name] = round(60.0 * number) / 60.0
    return values


def _parameters(scene: Path, names: list[str]) -> list[Any]:
    from morse.launch.load import described
    from morse.plugins.twin.parameters import Parameters
    from morse.plugins.twin.replay import probe
    from morse.simulation.options import RunOptions

    plain = described(scene, RunOptions())
    known = probe(plain)
    return Parameters(plain, known.wheels, known.fields).find(names)


def record(robot: Robot, scene: Path, path: Path, rng: np.random.Generator) -> None:
    """Record a run with commands at random."""
    with morse.load(scene, seed=int(rng.integers(1 << 30))) as sim, sim.record(path):
        for _ in range(math.ceil(LENGTH / robot.period)):
            name, command = robot.command(rng, sim.time())
            ticks = round(robot.period * 60.0)
            for _ in range(ticks // 6):
                sim.robot[name].publish(command)
                sim.step(6)


def trial(name: str, seed: int, workers: int) -> dict[str, Any]:
    """Plant, record and fit."""
    robot = ROBOTS[name]
    rng = np.random.default_rng([seed, len(name)])
    with tempfile.TemporaryDirectory() as folder:
        scene, real = Path(folder) / "scene.py", Path(folder) / "real.py"
        for file, text in robot.files.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        scene.write_text(robot.script, encoding="utf-8")
        values = drawn(robot, scene, rng)
        (Path(folder) / "planted.json").write_text(json.dumps({"morse preset": 1, "values": values}), encoding="utf-8")
        real.write_text(f'{robot.script}{robot.noise}env.preset("planted.json")\n', encoding="utf-8")
        record(robot, real, Path(folder) / "log.mcap", rng)
        begin, processor = time.perf_counter(), _processor_time()
        twin = Twin(Path(folder) / "log.mcap", scene, fit=list(values))
        fitted = twin.fit(workers=workers)
        wall, cpu = time.perf_counter() - begin, _processor_time() - processor
    found = {}
    for one, value, spread in zip(fitted.result.parameters, fitted.result.values, fitted.result.spreads, strict=True):
        error = abs(float(value) - values[one.name])
        found[one.name] = {
            "planted": values[one.name],
            "found": float(value),
            "spread": float(spread),
            "percent": 100.0 * error / max(abs(values[one.name]), 1e-12),
            "spreads": error / float(spread),
            "is_known": one.name in fitted.values,
            "is_right": one.name in fitted.values and error <= max(0.02 * abs(values[one.name]), 3.0 * float(spread)),
        }
    right = sum(one["is_right"] for one in found.values())
    return {
        "robot": name,
        "seed": seed,
        "right": right,
        "unknown": sum(not one["is_known"] for one in found.values()),
        "of": len(found),
        "wall": round(wall, 1),
        # of all processes; half of it is the time on two idle processors
        "cpu": round(cpu, 1),
        "simulations": fitted.result.simulations,
        "parameters": found,
    }


def _processor_time() -> float:
    """Processor time of this process and of those that it has waited for, s."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def table(trials: list[dict[str, Any]]) -> str:
    """The results as a table in Markdown."""
    lines = ["| robot | seed | right | said to be unknown | wrong | processor time, s |", "|---|--:|--:|--:|--:|--:|"]
    for one in trials:
        wrong = one["of"] - one["right"] - one["unknown"]
        lines.append(
            f"| {one['robot']} | {one['seed']} | {one['right']} | {one['unknown']} | {wrong} | {one['cpu']:.0f} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Fit all robots."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--robots", nargs="*", default=list(ROBOTS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--table", type=Path)
    options = parser.parse_args()
    trials = []
    for name in options.robots:
        for seed in range(options.first, options.first + options.seeds):
            trials.append(trial(name, seed, options.workers))
            print(json.dumps(trials[-1]), flush=True)
    right, count = sum(one["right"] for one in trials), sum(one["of"] for one in trials)
    print(json.dumps({"right": right, "of": count, "cpu": max(one["cpu"] for one in trials)}))
    if options.table:
        options.table.write_text(table(trials), encoding="utf-8")


if __name__ == "__main__":
    main()
