"""Foxglove's own client library (npm: @foxglove/ws-protocol), with the settings of its application."""

import base64
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from peers import talk
from PIL import Image

import morse
from morse.middleware.foxglove.datastream import FoxgloveHub
from morse.middleware.web.hub import hub_of

#: where .ci/foxglove has installed the library
LIBRARY = Path(os.environ.get("MORSE_TEST_FOXGLOVE") or Path(__file__).parents[3] / ".foxglove")

URDF = """<robot name="rover">
  <link name="base_link">
    <inertial><mass value="10"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://rover_description/meshes/hull.stl"/></geometry></visual>
    <collision><geometry><box size="1 0.6 0.4"/></geometry></collision>
  </link>
</robot>"""
SCENE = """
from morse.builder import *
rover = Robot({urdf!r}, name="rover")
rover.translate(z=0.3)
motion = MotionVW(); rover.append(motion)
odometry = Odometry(); rover.append(odometry)
rover.add_default_interface("foxglove")
env = Environment("empty")
env.configure_stream_manager("foxglove", port=0)
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "ws" / "rover_description"
    for name in ("meshes", "textures", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>rover_description</name></package>")
    trimesh.creation.box((1.0, 0.6, 0.4)).export(folder / "meshes/hull.stl")
    Image.fromarray(np.full((2, 2, 3), (200, 0, 0), dtype=np.uint8)).save(folder / "textures/red.png")
    (folder / "urdf/rover.urdf").write_text(URDF)
    shutil.copy(folder / "textures/red.png", tmp_path / "outside.png")
    return folder


@pytest.mark.skipif(shutil.which("node") is None or not (LIBRARY / "node_modules").is_dir(), reason="see .ci/foxglove")
@pytest.mark.peer(
    "@foxglove/ws-protocol", does="description with its meshes and textures, parameters, connection graph"
)
def test_description_meshes_parameters_and_graph(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    (tmp_path / "scene.py").write_text(SCENE.format(urdf=str(package / "urdf/rover.urdf")))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        port = hub_of(sim.context, FoxgloveHub).server.port
        seen = talk("foxglove_own.mjs", sim.step, port, LIBRARY)
        assert sim.context.component("rover.motion")._type == "Position"

    assert {"parameters", "parametersSubscribe", "connectionGraph", "assets"} <= set(seen["capabilities"])
    assert seen["mesh"] == "package://rover_description/meshes/hull.stl"
    assert base64.b64decode(seen["assets"]["mesh"]) == (package / "meshes/hull.stl").read_bytes()
    assert base64.b64decode(seen["assets"]["texture"]) == (package / "textures/red.png").read_bytes()
    assert "no robot_description" in seen["assets"]["secret"]["error"]
    assert seen["assets"]["outside"]["error"]

    values = {one["name"]: one["value"] for one in seen["all"]}
    assert values["rover.motion.ControlType"] == "Velocity"
    assert {one["name"]: one["value"] for one in seen["set"]} == {"rover.motion.ControlType": "Position"}
    assert seen["changed"][0]["name"] == "rover.motion.ControlType"
    assert any("ControlType" in text for level, text in seen["statuses"] if level == 2)

    assert seen["graph"]["publishedTopics"]["/rover/odometry"] == ["morse"]
    assert "morse" in seen["graph"]["subscribedTopics"]["/rover/cmd_vel"]
    assert seen["graph"]["advertisedServices"]["/rover/motion/set_speed"] == ["morse"]
