"""What clients set and spawn has one budget of pixels and rays; a scene script has none."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from limited import limited_run

import morse
from morse.builder import ATRV, Environment, Hokuyo, UltrasonicRangeFinder, VideoCamera
from morse.core.clients.budgets import MOST_PIXELS, RAY, SensingBudget
from morse.core.exceptions import MorseError
from morse.simulation.simulation import Simulation
from tests.kit.programs import Line

CAMERAS = ("one", "two", "three")


def _scene(rate: float = 10.0) -> None:
    robot = ATRV("robot")
    for name in CAMERAS:
        camera = VideoCamera(name)
        camera.properties(cam_width=64, cam_height=64)
        camera.frequency(rate)
        robot.append(camera)
    large = VideoCamera("large")
    large.properties(cam_width=4096, cam_height=2048, capturing=False)
    robot.append(large)
    robot.append(Hokuyo("scan"))
    robot.append(UltrasonicRangeFinder("sonar"))
    Environment("empty")


@pytest.fixture
def sim() -> Iterator[Simulation]:
    with morse.load(_scene) as simulation:
        yield simulation


def _set(sim: Simulation, component: str, name: str, value: object) -> None:
    sim.context.components[f"robot.{component}"].set_property(name, value)


def _pixels(sim: Simulation) -> float:
    budget: Any = sim.context.sensing
    return sum(map(budget._extra, sim.context.components.values()))


def test_what_is_refused_says_the_budget_what_is_asked_and_what_is_left(sim: Simulation) -> None:
    _set(sim, "one", "cam_width", 1064)  # 64,000 pixels more, ten times a second
    _set(sim, "two", "cam_width", 1024)
    with pytest.raises(MorseError) as refusal:
        _set(sim, "two", "cam_height", 1 << 13)
    text = str(refusal.value)
    assert "robot.two, cam_height" in text
    assert f"{MOST_PIXELS:,} pixels per simulated second" in text
    assert f"{(1024 * 8192 - 64 * 64) * 10:,} are asked" in text
    assert f"{MOST_PIXELS - 640_000:,} are left" in text
    assert "the scene script may set more" in text
    assert sim.context.components["robot.two"].image_height == 64


@pytest.mark.parametrize("rate", [0.01, 1.0, 10.0, 30.0])
def test_all_properties_together_stay_in_the_budget(rate: float) -> None:
    """Whatever the component and the rate: rare images are not large ones."""
    with morse.load(lambda: _scene(rate)) as sim:
        refused = 0
        for size in (128, 256, 512, 1024, 2048, 4096, 8192):
            wishes: list[tuple[str, str, float]] = [
                (camera, name, size) for camera in CAMERAS for name in ("cam_width", "cam_height")
            ]
            wishes += [
                ("scan", "resolution", 30.0 / size),
                ("scan", "layers", size // 128),
                ("scan", "scan_window", 360.0),
            ]
            for wish in wishes:
                try:
                    _set(sim, *wish)
                except MorseError:
                    refused += 1
        assert refused > 10
        assert 0.5 * MOST_PIXELS < _pixels(sim) <= MOST_PIXELS
        images = sum(sim.context.components[f"robot.{name}"].sensing_cost() for name in CAMERAS)
        assert images <= MOST_PIXELS / 10 + 3 * 64 * 64


def test_scripts_may_have_more_and_clients_may_go_back_to_it(sim: Simulation) -> None:
    _set(sim, "large", "cam_width", 16)
    _set(sim, "large", "cam_width", 4096)
    assert _pixels(sim) == 0.0
    with pytest.raises(MorseError, match="are left"):
        _set(sim, "large", "cam_width", 8192)


def test_a_saved_state_and_a_restart_do_not_add_up(sim: Simulation) -> None:
    for number, camera in enumerate(CAMERAS):
        try:
            _set(sim, camera, "cam_width", 8192)
            _set(sim, camera, "cam_height", 64)
        except MorseError:
            assert number > 0
        state = sim.save()
        sim.restart()
        assert _pixels(sim) == 0.0
        sim.restore(state)
        assert _pixels(sim) <= MOST_PIXELS
    sim.restart()
    _set(sim, "three", "cam_width", 8192)


def test_cones_and_layers_count(sim: Simulation) -> None:
    finder = sim.context.components["robot.sonar"]
    for cone, resolution in ((30.0, 3.0), (180.0, 0.5), (90.0, 1.0), (60.0, 5.0)):
        finder._cone, finder._resolution = cone, resolution
        finder._look_ahead()
        assert finder.sensing_cost() == pytest.approx(RAY * len(finder.rays), rel=0.35)
    scan = sim.context.components["robot.scan"]
    assert scan.sensing_cost() == RAY * len(scan.rays)
    with pytest.raises(MorseError, match="a ray counts as 16 pixels"):
        _set(sim, "scan", "layers", 200)
    assert scan.layers == 1


URDF = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
iyz="0"/></inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<gazebo reference="a">{}</gazebo></robot>"""
EYE = """<sensor type="camera" name="c{}"><update_rate>{}</update_rate><camera><horizontal_fov>1</horizontal_fov><image>
<width>{}</width><height>{}</height></image><clip><near>0.1</near><far>9</far></clip></camera></sensor>"""


def test_the_sensors_of_spawned_robots_count(sim: Simulation) -> None:
    small = URDF.format(EYE.format(0, 10, 320, 240))
    spawned = MOST_PIXELS // (320 * 240 * 10)
    for number in range(spawned):
        sim.spawn(f"guest{number}", small, (5.0 + 3 * number, 0.0, 1.0))
    with pytest.raises(MorseError, match=r"are asked, .* are left"):
        sim.spawn(f"guest{spawned}", small, (-5.0, 0.0, 1.0))
    assert f"guest{spawned}" not in sim.context.robots
    assert not [name for name in sim.context.components if name.startswith(f"guest{spawned}.")]
    sim.delete("guest0")
    sim.spawn("again", small, (-5.0, 0.0, 1.0))
    sim.population.restart("again", None)
    with pytest.raises(MorseError, match="are left"):
        sim.spawn("more", small, (-9.0, 0.0, 1.0))
    for size in ((4096, 4096, 1), (64, 64, 30)):
        sensors = "".join(EYE.format(number, size[2], *size[:2]) for number in range(70))
        with pytest.raises(MorseError, match="are left"):
            sim.spawn("many", URDF.format(sensors), (-9.0, 0.0, 1.0))


def test_a_function_of_a_program_is_no_client(sim: Simulation) -> None:
    def guest() -> Any:
        robot = ATRV()
        camera = VideoCamera("eye")
        camera.properties(cam_width=4096, cam_height=4096)
        robot.append(camera)
        return robot

    sim.spawn("guest", guest, (5.0, 0.0, 0.2))
    assert _pixels(sim) == 0.0


def test_a_component_that_cannot_tell_its_cost_is_created() -> None:
    class Odd:
        frequency, clock = None, None

        def sensing_cost(self) -> float:
            raise RuntimeError

    odd: Any = Odd()
    budget = SensingBudget(lambda: [odd])
    budget.grant([odd])
    budget.check("odd", [odd])


SCENE = """
from morse.builder import *
robot = ATRV()
for name in ('one', 'two', 'three'):
    camera = VideoCamera()
    camera.properties(cam_width=256, cam_height=256)
    robot.append(camera)
    camera.name = name
robot.add_default_interface('socket')
env = Environment('empty')
"""


def mean_wait(client: Line, calls: int = 80) -> float:
    """The time of a call that does nothing, s."""
    begin = time.monotonic()
    for _ in range(calls):
        client.call("simulation", "list_robots")
    return (time.monotonic() - begin) / calls


def test_who_sets_all_that_is_allowed_keeps_nobody_waiting(tmp_path: Path) -> None:
    with limited_run(SCENE, tmp_path, 1024, "--view", "none") as run:
        port = run.port(r"services are on port (\d+)")
        with Line(port) as other, Line(port) as hostile:
            mean_wait(other)
            before = mean_wait(other)
            refused = 0
            for size in (4096, 300, 400, 600, 800, 1200):
                for camera in CAMERAS:
                    for name in ("cam_width", "cam_height"):
                        answer = hostile.answer(f"robot.{camera}", "set_property", name, size)
                        refused += b"the budget for what clients set" in answer
            assert 6 <= refused < 36
            assert mean_wait(other) < 2.0 * before
