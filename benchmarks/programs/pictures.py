"""Images of the sandbox in MORSE.

``draw`` renders them as fast as possible, each image anew; ``export FILE`` writes the triangles for another renderer;
``first`` captures the first image after loading; ``standing`` and ``turning`` compare a simulation with a camera at
30 Hz with one without, on a robot that stands or turns on the spot; ``beside`` compares a camera with a delay of one
frame, whose images are rendered while the simulation goes on, with one without, each image anew; ``workers`` compares
four cameras with a delay of three frames, whose images no, one and two other processes render.
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, prepare, sensors_with
from morse.rendering import Lens, Renderer
from morse.sensors.camera import Camera

if TYPE_CHECKING:
    from pathlib import Path

    from morse.rendering import CameraRequest
    from morse.simulation.simulation import Simulation

_CHUNK = 10
_WARM = 3
#: s, until a robot is at rest
_SETTLED = 1.0
#: delays of the camera, s
_DELAYS = {"at once": 0.0, "beside": 1 / 30}
#: numbers of other processes that render, number of cameras, and their delay, s
_WORKERS, _CAMERAS, _DELAY = (0, 1, 2), 4, 0.1


class Tripod:
    """A mount for a camera that looks at the centre of the sandbox: X to the right, Y down."""

    def __init__(self) -> None:
        eye, target = np.array(work.PICTURE_EYE), np.array(work.PICTURE_TARGET)
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        self.axes = np.column_stack([right, np.cross(forward, right), forward])

    def world_pose(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Position and rotation, row by row."""
        return tuple(work.PICTURE_EYE), tuple(self.axes.ravel())


def draw(width: int, height: int, cameras: int, samples: int, color: bool) -> None:
    """Render as fast as possible."""
    renderer = Renderer(_world(), samples)
    requests = [_request(renderer, width, height, color) for _ in range(cameras)]
    for _ in range(_WARM):
        renderer.serve(requests)
    cost = stopwatch.cost_of(lambda: renderer.serve(requests), _CHUNK)
    picture = requests[0].picture
    assert picture is not None
    stopwatch.report(
        ms=1e3 * cost.wall, processor_ms=1e3 * cost.processor, depths=work.depth_grid(picture.depth.tolist())
    )


def export(path: Path) -> None:
    """Write all triangles in the world frame, one mesh for each instance, and their colours."""
    renderer = Renderer(_world())
    renderer.serve([_request(renderer, 8, 8, False)])
    contents = renderer.contents
    poses, drawing = contents.scenery.poses(contents.frames()), contents.scenery.drawing
    arrays: dict[str, Any] = {}
    shown = 0
    for instance, node in enumerate(renderer.contents.nodes):
        model = poses.models[instance].reshape(3, 4).astype(np.float64)
        if node.mesh is None or not model.any():
            continue
        number, shown = shown, shown + 1
        triangles = np.asarray(node.mesh.triangles).reshape(-1, 3)
        arrays[f"v{number}"] = np.asarray(node.mesh.vertices) @ model[:, :3].T + model[:, 3]
        arrays[f"t{number}"] = triangles[:, ::-1] if np.linalg.det(model[:, :3]) < 0 else triangles
        part = int(np.flatnonzero(drawing.parts[:, 1] == instance)[0])
        arrays[f"c{number}"] = drawing.materials["color"][drawing.slots[drawing.parts[part, 2]]]
    np.savez(path, count=shown, **arrays)
    stopwatch.report(instances=shown)


def first() -> None:
    """The first image of a camera."""
    simulation = prepare("pictures")
    wall, processor = time.perf_counter(), time.process_time()
    simulation.tick()
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    if not simulation.robot.camera.data["image"].any():
        raise RuntimeError("the camera captured no image")
    stopwatch.report(s=wall, processor_s=processor)


def share(secs: float, turning: bool) -> None:
    """The share of real time that a camera takes on a robot that turns on the spot, or stands."""
    costs = []
    for rate in (30, 0):
        simulation = prepare("pictures", rate=rate, turning=int(turning))
        if turning:
            command_all(simulation)
            for actuator in simulation.loaded.actuators:
                actuator.local_data["v"] = 0.0
        for _ in range(round(_SETTLED * work.TICK)):
            simulation.tick()
        pace, _ = stopwatch.measure(simulation.tick, secs)
        costs.append(1 / pace.processor)
        simulation.close()
    stopwatch.report(share=costs[0] - costs[1], processor_share=costs[0] - costs[1], without=costs[1])


def beside(others: int, chunks: int) -> None:
    """The time of ticks with a camera at 30 Hz, without delay and with a delay of one frame, in turns."""
    simulations = {name: prepare("pictures", delay=delay, others=others) for name, delay in _DELAYS.items()}
    for simulation in simulations.values():
        _draw_anew(simulation)
    spent: dict[str, list[stopwatch.Cost]] = {name: [] for name in simulations}
    own: dict[str, list[float]] = {name: [] for name in simulations}
    for chunk in range(chunks + 1):
        for name, simulation in simulations.items():
            wall, processor, thread = time.perf_counter(), time.process_time(), time.thread_time()
            for _ in range(work.TICK // 2):
                simulation.tick()
            if not chunk:
                continue  # the first images take longer
            own[name].append(time.thread_time() - thread)
            spent[name].append(stopwatch.Cost(time.perf_counter() - wall, time.process_time() - processor))
    wall = {name: statistics.median(cost.wall for cost in costs) for name, costs in spent.items()}
    processor = {name: statistics.median(cost.processor for cost in costs) for name, costs in spent.items()}
    thread = {name: statistics.median(times) for name, times in own.items()}
    stopwatch.report(
        faster=wall["at once"] / wall["beside"],
        processor_ratio=processor["beside"] / processor["at once"],
        thread_share=thread["beside"] / thread["at once"],
        tick_ms={name: 1e3 * value / (work.TICK // 2) for name, value in wall.items()},
    )


def workers(chunks: int) -> None:
    """The time of ticks with four cameras at 30 Hz, by the number of other processes that render, in turns."""
    simulations = {count: prepare("pictures", cameras_on=count, cameras=_CAMERAS, delay=_DELAY) for count in _WORKERS}
    times: dict[int, list[float]] = {count: [] for count in simulations}
    for chunk in range(chunks + 1):
        for count, simulation in simulations.items():
            if not chunk:
                _draw_anew(simulation)
            wall = time.perf_counter()
            for _ in range(work.TICK // 2):
                simulation.tick()
            if chunk:  # the first images take longer
                times[count].append(time.perf_counter() - wall)
    for simulation in simulations.values():
        simulation.close()
    none, one, two = (times[count] for count in _WORKERS)
    stopwatch.report(
        two_of_one=statistics.median(a / b for a, b in zip(one, two, strict=True)),
        two_of_none=statistics.median(a / b for a, b in zip(none, two, strict=True)),
    )


def _draw_anew(simulation: Simulation) -> None:
    """Let no camera take over parts of its last image."""
    for camera in sensors_with(simulation, "image"):
        assert isinstance(camera, Camera)
        camera.request.memory = None


def _world() -> Any:
    simulation = prepare("pictures", rate=0)
    simulation.tick()
    return simulation.world


def _request(renderer: Renderer, width: int, height: int, color: bool) -> CameraRequest:
    lens = Lens.of_focal_length(width, height, work.PICTURE_FOCAL, work.PICTURE_NEAR, work.PICTURE_FAR)
    request = renderer.request(Tripod(), lens, color=color)
    request.memory = None
    return request


def main() -> None:
    """Run the measurement that the first argument names."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["draw", "export", "first", "standing", "turning", "beside", "workers"])
    parser.add_argument("file", nargs="?")
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--cameras", type=int, default=1)
    parser.add_argument("--samples", type=int, default=5)
    parser.add_argument("--secs", type=float, default=2.0)
    parser.add_argument("--others", type=int, default=0)
    parser.add_argument("--no-color", action="store_true")
    given = parser.parse_args()
    if given.what == "draw":
        draw(given.width, given.width * 3 // 4, given.cameras, given.samples, not given.no_color)
    elif given.what == "export":
        export(given.file)
    elif given.what == "beside":
        beside(given.others, max(3, round(2 * given.secs)))
    elif given.what == "workers":
        workers(max(3, round(2 * given.secs)))
    elif given.what == "first":
        first()
    else:
        share(given.secs, given.what == "turning")


if __name__ == "__main__":
    main()
