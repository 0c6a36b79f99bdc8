"""W1 in MORSE: N robots drive in circles, pose at 60 Hz, a scan of 181 rays at 10 Hz.

One JSON line: real-time factor, and how far the work is from its analytic answer.
"""

from __future__ import annotations

import argparse
import json
import logging
import time
from pathlib import Path

import work

from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.simulation.options import RunOptions
from morse.simulation.simulation import Simulation

SCENE = str(Path(__file__).parent / "scenes" / "w1.py")


def prepare(count: int, sensors: str = "scan") -> Simulation:
    """The simulation, with the command given and the first second done."""
    logging.disable(logging.WARNING)
    options = RunOptions(SCENE, arguments=[str(count), "planar", sensors], view="none")
    scene = load_scene(options)
    resolve_shapes(scene)
    simulation = Simulation(scene, options)
    simulation.load()
    for component in simulation.loaded.actuators:
        component.local_data.update(v=work.SPEED, w=work.RATE)
    return simulation


def poses(simulation: Simulation) -> list[work.Pose]:
    """x, y, yaw of every robot."""
    found = [c.local_data for c in simulation.loaded.sensors if "yaw" in c.local_data]
    return [(d["x"], d["y"], d["yaw"]) for d in found]


def main() -> None:
    """Run for ``--secs`` simulated seconds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=1)
    parser.add_argument("--secs", type=float, default=20.0)
    parser.add_argument("--sensors", choices=["scan", "pose"], default="scan")
    parser.add_argument("--profile", action="store_true")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    simulation = prepare(arguments.n, arguments.sensors)
    loaded = time.perf_counter() - begin
    if arguments.profile:
        from morse.simulation.profile import Profile

        simulation.profile = Profile()
    ticks = round(arguments.secs * work.TICK)
    begin = time.perf_counter()
    for _ in range(ticks):
        simulation.tick()
    wall = time.perf_counter() - begin
    final = poses(simulation)
    record = {
        "peer": "morse",
        "work": "W1" if arguments.sensors == "scan" else "W1 without scan",
        "n": arguments.n,
        "rtf": arguments.secs / wall,
        "load_s": loaded,
        "pose_err_m": work.worst_position(final, arguments.secs),
    }
    if arguments.sensors == "scan":
        record["scan_err_m"], record["scan_bad"] = scan_of_first(simulation, final)
    print(json.dumps(record))
    if simulation.profile is not None:
        from rich.console import Console

        from morse.simulation.profile_table import profile_table

        Console().print(profile_table(simulation.profile))
    simulation.shut_down()


def scan_of_first(simulation: Simulation, final: list[work.Pose]) -> tuple[float, float]:
    """Errors of the last scan of the first robot; scans come every sixth tick, so the poses are taken anew."""
    laser = next(c for c in simulation.loaded.sensors if "range_list" in c.local_data)
    while simulation.clock.tick % 6 != 1:
        simulation.tick()
    return work.scan_errors(laser.local_data["range_list"], poses(simulation))


if __name__ == "__main__":
    main()
