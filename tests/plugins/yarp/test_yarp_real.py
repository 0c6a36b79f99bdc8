"""Ports of YARP with the real name server, the real bindings and the real command line."""

import json
import re
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from yarp_real import HERE, LIMIT, Yarp

pytestmark = pytest.mark.slow
PAGE = Path(__file__).resolve().parents[3] / "docs/yarp.md"
COMPONENTS = """
pose = Pose(); robot.append(pose)
goal = Waypoint(); robot.append(goal)
turret = PTU(); robot.append(turret)
scan = Hokuyo(); scan.translate(x=0.3, z=0.6); robot.append(scan)
camera = VideoCamera(); depth = DepthVideoCamera(); ids = SegmentationCamera()
for one in (camera, depth, ids):
    one.properties(cam_width=33, cam_height=20); one.frequency(10); one.translate(x=0.3, z=1.0); robot.append(one)
robot.add_default_interface("yarp")
"""


@pytest.fixture(scope="module")
def yarp(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Yarp]:
    made = Yarp(tmp_path_factory.mktemp("yarp"))
    yield made
    made.close()


def finish(sim: Any, process: subprocess.Popen[str]) -> str:
    """Step until a program has ended; returns its output."""
    end = time.monotonic() + LIMIT
    try:
        while process.poll() is None:
            assert time.monotonic() < end, "the program does not end"
            sim.step()
            time.sleep(0.002)  # leaves the processor to the program
    finally:
        process.kill()
        said, complaints = process.communicate()
    assert process.returncode == 0, f"{said}\n{complaints}"
    return said


@pytest.fixture(scope="module")
def seen(yarp: Yarp, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    import morse

    script = tmp_path_factory.mktemp("scene") / "scene.py"
    script.write_text(
        f'from morse.builder import *\nrobot = ATRV()\n{COMPONENTS}env = Environment("sandbox")\n'
        f'env.configure_stream_manager("yarp", port={yarp.port})\n'
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MORSE_SOCKET_PORT", "0")
        with morse.load(script, sockets=True) as sim:
            said = finish(sim, yarp.python(str(HERE / "yarp_peer.py")))
            # the libraries of YARP write their log to the same place
            found = json.loads(next(line for line in said.splitlines() if line.startswith("{")))
            data = {name.partition(".")[2]: one.local_data for name, one in sim.context.components.items()}
            found["truth"] = {
                "image": np.asarray(data["camera"]["image"]),
                "turret": data["turret"]["pan"],
                "point": list(data["scan"]["point_list"][540]),
                "x": sim.robot.pose.get()["x"],
            }
    found["left"] = finish_alone(yarp.start("yarp", "name", "list"))
    return dict(found)


def finish_alone(process: subprocess.Popen[str]) -> str:
    said, _ = process.communicate(timeout=LIMIT)
    return said


@pytest.mark.peer("yarp")
def test_programs_of_yarp_connect_and_disconnect(seen: dict[str, Any]) -> None:
    assert seen["connected"]
    assert seen["is connected"]
    assert not seen["over udp"]
    assert seen["disconnected"] == [True, False]


@pytest.mark.peer("yarp")
def test_a_bottle_has_the_fields_in_their_order(seen: dict[str, Any]) -> None:
    timestamp, x, y, z, *angles = seen["pose"]
    assert timestamp > 0.0
    assert (x, y, z) == pytest.approx((0.0, 0.0, 0.1), abs=0.02)
    assert angles == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


def test_a_scan_is_a_list_of_points(seen: dict[str, Any]) -> None:
    assert seen["points"] == 1081
    assert len(seen["point"]) == 3
    assert all(np.isfinite(seen["point"]))


@pytest.mark.peer("yarp")
def test_an_image_has_the_pixels_of_the_camera(seen: dict[str, Any]) -> None:
    image = np.reshape(seen["camera"], (20, 33, 4))
    assert np.array_equal(image[..., 3], np.full((20, 33), 255))
    # the sky is above the ground, and brighter in blue than in red; the picture has row 0 on top
    assert image[0, :, 2].mean() > image[0, :, 0].mean()
    assert image[-1, :, 2].mean() < image[-1, :, 0].mean()
    depth = np.asarray(seen["depth"])
    assert depth.shape == (20, 33)
    # the ground in front of a camera that looks ahead: the lower, the nearer
    assert 0.0 < depth[-1, 16] < depth[14, 16]
    assert np.shape(seen["ids"]) == (20, 33)


@pytest.mark.peer("yarp")
def test_services_are_called_and_answered(seen: dict[str, Any]) -> None:
    status, arrived, literal, unknown = seen["replies"]
    assert re.fullmatch(r"a1 SUCCESS (Arrived|Stop|Transit)", status)
    assert arrived == "a2 SUCCESS Arrived"
    assert seen["truth"]["x"] > 0.4
    assert literal.startswith("a3 FAILED the arguments are not a Python list")
    assert unknown.startswith("a4 FAILED The request gato has not been registered")
    assert "did you mean 'goto'" in unknown


@pytest.mark.peer("yarp")
def test_a_command_arrives_and_is_replied_to(seen: dict[str, Any]) -> None:
    assert seen["replied"] == [True, True]
    assert seen["truth"]["turret"] == 0.5


def test_the_name_server_forgets_the_ports_at_the_end(seen: dict[str, Any]) -> None:
    assert "/root" in seen["left"]
    assert "/morse" not in seen["left"]


def test_the_client_of_the_documentation(yarp: Yarp, load: Callable[..., Any], tmp_path: Path) -> None:
    scene, client = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert 'robot.add_default_interface("yarp")' in scene
    path = tmp_path / "client.py"
    path.write_text(client.replace("< 0.5", "< 1.5"))
    components = "motion = MotionVW(); robot.append(motion)\npose = Pose(); robot.append(pose)\n"
    sim = load(yarp.port, components + 'robot.add_default_interface("yarp")\n')
    ports = next(iter(sim.context.stream_managers.values())).ports
    end = time.monotonic() + LIMIT
    while len(ports._own_names) < 6 and time.monotonic() < end:
        sim.step()
    assert "\nx is 0.5 m\n" in finish(sim, yarp.python(str(path)))
    assert sim.robot.pose.get()["x"] > 1.4
