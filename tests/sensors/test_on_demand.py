"""Sensors of model files: what nobody reads is neither cast nor rendered, and who reads gets the present moment."""

import json
import socket
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.many import Batch
from morse.physics.rays import RayBundle
from morse.wire.listener import port_of
from tests.kit.waiting import wait_until

URDF = """<robot name="seer"><link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo reference="base">
  <sensor name="eye" type="camera"><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov>
    <image><width>16</width><height>12</height></image></camera></sensor>
  <sensor name="depth" type="depth"><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov>
    <image><width>16</width><height>12</height></image></camera></sensor>
  <sensor name="parts" type="segmentation"><camera><image><width>16</width><height>12</height></image></camera></sensor>
  <sensor name="lidar" type="ray"><update_rate>10</update_rate><ray><scan><horizontal><samples>5</samples>
    <min_angle>-0.1</min_angle><max_angle>0.1</max_angle></horizontal></scan><range><max>30</max></range></ray></sensor>
  <sensor name="sonar" type="sonar"><ray><range><max>20</max></range></ray></sensor>
</gazebo></robot>"""
SDF = """<sdf version="1.9"><model name="seer"><link name="base"><inertial><mass>1</mass></inertial>
  <sensor name="eye" type="camera"><update_rate>10</update_rate><camera>
    <image><width>16</width><height>12</height></image></camera></sensor>
  <sensor name="lidar" type="gpu_lidar"><update_rate>10</update_rate><lidar><scan><horizontal><samples>5</samples>
    <min_angle>-0.1</min_angle><max_angle>0.1</max_angle></horizontal></scan><range><max>30</max></range></lidar></sensor>
</link></model></sdf>"""
MJCF = """<mujoco model="seer"><worldbody><body name="base"><geom size="0.1" mass="1"/>
  <camera name="eye" resolution="16 12"/><site name="front" quat="0.7071068 0 0.7071068 0"/></body></worldbody>
  <sensor><rangefinder name="sonar" site="front"/></sensor></mujoco>"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z=5)
wall = Cube("wall")
wall.scale, wall.location = (0.5, 5, 5), (10, 0, 5)
wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty")
env.set_gravity(0)
{more}
"""


class Costs:
    """Counts what is cast and rendered."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.cast = self.drawn = 0
        from morse.physics.rays.rays import Rays
        from morse.rendering.renderer import Renderer

        cast, serve = Rays.cast, Renderer.serve

        def counted_cast(rays, bundles):
            self.cast += len(bundles)
            return cast(rays, bundles)

        def counted_serve(renderer, requests):
            self.drawn += sum(bool(request.wanted()) for request in requests)
            return serve(renderer, requests)

        monkeypatch.setattr(Rays, "cast", counted_cast)
        monkeypatch.setattr(Renderer, "serve", counted_serve)

    @property
    def all(self) -> tuple[int, int]:
        return self.cast, self.drawn


@pytest.fixture
def costs(monkeypatch: pytest.MonkeyPatch) -> Costs:
    return Costs(monkeypatch)


@pytest.fixture(params=["urdf", "sdf", "xml"])
def scene(request, tmp_path: Path) -> Path:
    return write(tmp_path, request.param)


def write(folder: Path, kind: str, more: str = "") -> Path:
    file = folder / f"seer.{kind}"
    file.write_text({"urdf": URDF, "sdf": SDF, "xml": MJCF}[kind])
    (folder / "scene.py").write_text(SCENE.format(file=str(file), more=more))
    return folder / "scene.py"


def test_what_nobody_reads_is_neither_cast_nor_rendered(scene: Path, costs: Costs) -> None:
    with morse.load(scene) as sim:
        sim.step(30)
        sim.step(5, measure=True)
        sim.state_hash()
        assert costs.all == (0, 0)


def test_who_calls_the_service_in_each_tick_gets_images_at_the_rate_that_the_budget_counts(
    tmp_path: Path, costs: Costs
) -> None:
    with morse.load(write(tmp_path, "sdf")) as sim:
        times = set()
        for _ in range(30):
            sim.step(1)
            times.add(sim.call("robot.eye", "get_local_data").result()["timestamp"])
        # 10 Hz in half a second; it was one in each of 30 ticks
        assert 5 <= costs.drawn <= 7
        assert len(times) == costs.drawn
        sim.restart()
        sim.step(1)
        assert sim.call("robot.eye", "get_local_data").result()["timestamp"] == pytest.approx(sim.clock.time)


def test_in_batches_as_well(scene: Path, costs: Costs) -> None:
    with Batch(scene, 2) as batch:
        batch.step(10)
        batch.step(6, measure=True)
        assert costs.all == (0, 0)


def test_a_batch_that_reads_a_lidar_gets_what_it_measures_after_each_step(tmp_path: Path) -> None:
    with Batch(write(tmp_path, "urdf"), 2) as batch:
        ranges = batch.read("robot.lidar", "range_list")
        batch.step(6, measure=True)
        assert ranges.shape == (2, 5)
        assert (ranges[:, 2] < 10.0).all()


def test_who_reads_a_sensor_gets_the_present_moment(tmp_path: Path, costs: Costs) -> None:
    with morse.load(write(tmp_path, "urdf")) as sim:
        sim.step(9)  # at its rate, the lidar would have measured two ticks before
        first = sim.robot.lidar.data
        assert first["timestamp"] == pytest.approx(9 / 60)
        assert costs.all == (1, 0)
        assert sim.robot.lidar.data["timestamp"] == first["timestamp"]
        assert costs.all == (1, 0)
        sim.rpc("simulation", "set_object_position", "robot", [4.0, 0.0, 5.0], [0.0, 0.0, 0.0])
        sim.step(1)
        second = sim.robot.lidar.data
        assert second["timestamp"] == pytest.approx(10 / 60)
        assert second["range_list"][2] == pytest.approx(first["range_list"][2] - 4.0, abs=1e-6)
        image = sim.robot.eye.data
        assert image["image"].shape[:2] == (12, 16)
        assert image["timestamp"] == pytest.approx(10 / 60)
        assert costs.drawn == 1


def test_a_reader_of_messages_gets_them_at_the_rate_of_the_sensor(tmp_path: Path, costs: Costs) -> None:
    times: dict[str, list[float]] = {"lidar": [], "eye": []}
    with morse.load(write(tmp_path, "urdf")) as sim:
        for name, seen in times.items():
            getattr(sim.robot, name).subscribe(lambda data, seen=seen: seen.append(data["timestamp"]))
        sim.step(30)
        for seen in times.values():
            assert np.diff(seen) == pytest.approx([0.1] * (len(seen) - 1))
            assert len(seen) == 5
        assert costs.all == (5, 5)


def test_a_part_of_the_simulation_that_keeps_the_data_sees_them_change(tmp_path: Path, costs: Costs) -> None:
    with morse.load(write(tmp_path, "urdf")) as sim:
        kept = sim.context.component("robot.lidar").local_data
        sim.step(12)
        assert kept["timestamp"] == pytest.approx(7 / 60)
        assert costs.cast >= 2
        sim.restart()
        costs.cast = 0
        sim.step(12)
        assert costs.cast == 0


def test_a_restored_state_has_the_data_of_that_time(tmp_path: Path) -> None:
    with morse.load(write(tmp_path, "urdf")) as sim:
        sim.step(5)
        assert sim.robot.lidar.data["timestamp"] == pytest.approx(5 / 60)
        state = sim.save()
        sim.step(10)
        sim.restore(state)
        sim.step(3)
        assert sim.robot.lidar.data["timestamp"] == pytest.approx(8 / 60)


def test_a_sensor_of_the_script_and_one_that_is_told_to_measure_all_the_time(tmp_path: Path, costs: Costs) -> None:
    scene = write(tmp_path, "urdf")
    text = scene.read_text().replace("env =", "robot.sensors['lidar'].properties(on_demand=False)\nenv =")
    scene.write_text(text)
    with morse.load(scene) as sim:
        sim.step(30)
        assert costs.cast >= 1
        assert costs.drawn == 0
        assert all(isinstance(one, RayBundle) for one in sim.robot.lidar.component.requests)


def test_noise_is_that_of_the_file_for_who_reads_now(tmp_path: Path) -> None:
    scene = write(tmp_path, "urdf")
    (tmp_path / "seer.urdf").write_text(
        URDF.replace("</ray></sensor>", "<noise><stddev>0.1</stddev></noise></ray></sensor>", 1)
    )
    with morse.load(scene) as sim:
        sim.step(7)
        near = sim.robot.lidar.data["range_list"]
        hits = near[near < 30.0]
        assert len(hits)
        assert np.std(hits - hits.mean()) > 1e-3


@pytest.mark.parametrize("name", ["eye", "lidar"])
def test_a_sensor_with_a_delay_measures_all_the_time(tmp_path: Path, name: str) -> None:
    scene = write(tmp_path, "urdf")
    scene.write_text(scene.read_text().replace("env =", f"robot.sensors[{name!r}].delay(0.05)\nenv =", 1))
    with morse.load(scene) as sim:
        sim.step(12)
        # what was measured in tick 7 was published in tick 10
        assert getattr(sim.robot, name).data["timestamp"] == pytest.approx(7 / 60)


def test_a_stream_costs_nothing_until_a_client_reads_it(tmp_path: Path, costs: Costs) -> None:
    with morse.load(write(tmp_path, "urdf"), interfaces=["socket"]) as sim:
        sim.step(30)
        assert costs.all == (0, 0)
        manager = next(one for one in sim.context.stream_managers.values() if hasattr(one, "_servers"))
        stream = sim.context.component("robot.lidar").output_functions[0].__self__
        with socket.create_connection(("127.0.0.1", port_of(manager._servers["robot.lidar"]._listener))) as client:
            client.settimeout(60)
            wait_until(lambda: bool(stream.waiting))
            sim.step(6)
            message = json.loads(client.makefile().readline())
            assert 0.5 < message["timestamp"] <= 0.6
            assert message["range_list"][2] == pytest.approx(9.5, abs=0.01)
        wait_until(lambda: not stream.waiting)
        before = costs.all
        sim.step(30)
        assert costs.all == before
        assert costs.drawn == 0
