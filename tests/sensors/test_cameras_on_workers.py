"""Images that other processes render: the same bits, also when these processes die; none outlives its parent."""

import hashlib
import importlib.util
import os
import signal
import sys
import time

import numpy as np
import pytest

from morse.builder.script import ScriptError
from morse.rendering import Renderer
from tests.kit.programs import python

#: wall-clock time, s
LIMIT = 60.0
CAMERAS = {
    "color": "VideoCamera()",
    "blurred": "VideoCamera(); camera.properties(exposure_time=0.02, readout_time=0.02, motion_steps=3)",
    "fisheye": "VideoCamera(); camera.properties(lens_model='equidistant', cam_fov=190.0)",
    "cloud": "DepthCamera()",
    "normals": "NormalCamera()",
    "flow": "OpticalFlowCamera()",
    "semantic": "SemanticCamera()",
    "heat": "ThermalCamera()",
    "things": "SegmentationCamera()",
}
SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
robot.translate(0, 0, 0.5)
robot.append(MotionVW("motion"))
lamp = Light("lamp")
lamp.translate(x=0.2)
robot.append(lamp)
{cameras}
box = Cube("Box")
box.scale, box.location = (0.3, 0.3, 0.3), (4, 0, 0.4)
box.properties(Object=True, Temperature=40.0)
env = Environment("empty")
{more}
"""
ONE = """
camera = {make}
camera.name = "{name}"
camera.properties(cam_width=32, cam_height=24, cam_near=0.1)
camera.frequency(20)
camera.delay({delay})
robot.append(camera)
"""


@pytest.fixture
def load(load):
    def drive(delay=0.05, more="", names=tuple(CAMERAS), **options):
        cameras = "".join(ONE.format(name=name, make=CAMERAS[name], delay=delay) for name in names)
        simulation = load(SCENE.format(cameras=cameras, more=more), **options)
        simulation.robot.motion.publish({"v": 1.0, "w": 0.4})
        return simulation

    return drive


def listen(simulation):
    """Digests of all published images: camera, time stamp and content."""
    heard = []

    def hear(sensor):
        digest = hashlib.sha256()
        for name in sorted(sensor.local_data):
            value = sensor.local_data[name]
            digest.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())
        heard.append((sensor.name(), sensor.local_data["timestamp"], digest.hexdigest()))

    for camera in simulation.context.components.values():
        if getattr(camera, "is_camera", False):
            camera.output_functions.append(hear)
    return heard


def pool(simulation):
    return simulation.context.server(Renderer)._pool


def change(simulation):
    """Steps, between which the contents and the colours of the world change."""
    simulation.step(12)
    simulation.robot.set_color((0.9, 0.1, 0.1))
    simulation.step(6)
    simulation.rpc("simulation", "set_object_visibility", "Box", False, True)
    simulation.step(6)


def wait_for_end(pid):
    until = time.monotonic() + LIMIT
    while _lives(pid):
        assert time.monotonic() < until, f"the process {pid} is still there"
        time.sleep(0.02)


def _lives(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("delay", [0.0, 0.1])
def test_the_images_are_the_same(load, delay):
    here, there = load(delay), load(delay, cameras_on=2)
    expected, images = listen(here), listen(there)
    change(here)
    change(there)
    assert images == expected
    assert len(images) >= 5 * len(CAMERAS)


def test_a_worker_that_dies_is_replaced_without_a_gap(load):
    here, there = load(0.1, names=["color", "cloud"]), load(0.1, names=["color", "cloud"], cameras_on=2)
    expected, images = listen(here), listen(there)
    here.step(40)
    pids = set()
    for _ in range(20):
        there.step(2)
        if there.clock.tick in (10, 20):
            for worker in list(pool(there).workers):
                pids.add(worker.pid)
                os.kill(worker.pid, signal.SIGKILL)
    assert images == expected
    assert len(pids) >= 3, "no worker has been replaced"


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="the system cannot stop a process")
def test_a_worker_that_does_not_answer_is_replaced_without_a_gap(load, monkeypatch, caplog):
    monkeypatch.setattr("morse.rendering.workers.PATIENCE", 5.0)
    here, there = load(0.1, names=["color"]), load(0.1, names=["color"], cameras_on=1)
    expected, images = listen(here), listen(there)
    here.step(20)
    there.step(10)
    (worker,) = pool(there).workers
    os.kill(worker.pid, signal.SIGSTOP)
    there.step(10)
    assert images == expected
    assert worker not in pool(there).workers
    assert "does not answer" in caplog.text


def test_simulations_share_workers_which_end_with_the_last(load):
    one, other = (load(names=["color"], cameras_on=1) for _ in range(2))
    one.step(4)
    other.step(4)
    assert pool(one) is pool(other)
    (worker,) = pool(one).workers
    one.close()
    other.step(4)
    assert _lives(worker.pid)
    other.close()
    wait_for_end(worker.pid)


def test_a_restart_keeps_the_workers(load):
    simulation = load(names=["color"], more="env.cameras_on(1)")
    images = listen(simulation)
    simulation.step(8)
    before = set(pool(simulation).workers)
    simulation.restart()
    again = listen(simulation)
    simulation.robot.motion.publish({"v": 1.0, "w": 0.4})
    simulation.step(8)
    assert before == pool(simulation).workers
    assert again == images


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="the process table is that of Linux")
@pytest.mark.parametrize("end", ["sys.exit()", "os.kill(os.getpid(), signal.SIGKILL)", "raise ValueError", "pass"])
def test_no_worker_outlives_the_simulation(load, end, tmp_path):
    load(names=["color"], cameras_on=0)
    program = tmp_path / "program.py"
    program.write_text(
        "import os, signal, sys, morse\n"
        "from morse.rendering import Renderer\n"
        f"sim = morse.load({str(tmp_path / 'scene.py')!r}, cameras_on=2)\n"
        "sim.step(6)\n"
        "print(*[worker.pid for worker in sim.context.server(Renderer)._pool.workers], flush=True)\n"
        f"{end}\n"
    )
    done = python(program)
    pids = [int(word) for word in done.stdout.split()]
    assert pids, done.stderr
    for pid in pids:
        wait_for_end(pid)


def test_a_simulation_without_cameras_starts_no_process(load):
    assert pool(load(names=[], cameras_on=2)) is None


@pytest.mark.parametrize("place", ["proceses", -1, 1.5, True, 100000])
def test_a_place_that_does_not_exist_is_refused(load, place):
    with pytest.raises(ValueError, match="cameras_on is 'processes' or a number"):
        load(cameras_on=place)
    with pytest.raises(ScriptError, match="cameras_on is"):
        load(more=f"env.cameras_on({place!r})")


@pytest.fixture
def cluster():
    """A cluster of Ray of two processors; None without Ray, of 260 MB, which MORSE does not install."""
    if importlib.util.find_spec("ray") is None:
        yield None
        return
    import ray

    ray.init(address="local", num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="ERROR")
    yield ray
    ray.shutdown()


@pytest.mark.slow
@pytest.mark.peer("ray", does="its processes render the images of cameras")
def test_a_cluster_renders_the_same_images_also_when_its_processes_die(cluster, load):
    if cluster is None:
        return
    here, there = load(0.1), load(0.1, cameras_on="ray://auto")
    expected, images = listen(here), listen(there)
    change(here)
    there.step(12)
    workers = set(pool(there).workers)
    for worker in workers:
        cluster.kill(worker.actor)
    there.robot.set_color((0.9, 0.1, 0.1))
    there.step(6)
    there.rpc("simulation", "set_object_visibility", "Box", False, True)
    there.step(6)
    assert images == expected
    assert pool(there).workers.isdisjoint(workers)
    assert len(pool(there).workers) <= 2


def test_without_ray_the_error_names_the_extra(load, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(Exception, match=r'pip install "ray>=2.40,<3"'):
        load(cameras_on="ray://auto")
