"""``morse view``: a model in a real browser, with sliders for its actuators."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import morse
from morse.cli.app import execute
from morse.cli.messages import CommandError
from morse.cli.view import script_of
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

MODEL = """<mujoco model="cart"><worldbody><geom type="box" size=".1 .1 .5" pos="0 2 .5"/>
<body name="base" pos="0 0 .5"><geom type="box" size=".3 .3 .1" mass="50"/>
<body name="sled" pos="0 0 .2"><joint name="push" type="slide" axis="1 0 0" range="0 1"/>
<geom type="box" size=".1 .1 .1" mass="1"/>
<body name="flag" pos="0 0 .2"><joint name="wave" axis="0 1 0"/><geom type="capsule" size=".02 .1" mass=".1"/></body>
</body></body></worldbody>
<actuator><position name="p" joint="push" kp="400" kv="40" ctrlrange="0 1"/><motor joint="wave" gear="1"/></actuator>
<keyframe><key name="home" qpos="0.3 0"/><key name="far" qpos="0.7 0"/></keyframe></mujoco>"""
START = "import sys; from morse.cli import main; sys.exit(main())"


@pytest.mark.browser
def test_a_slider_moves_the_joint(tmp_path: Path, open_page: Any) -> None:
    (tmp_path / "cart.xml").write_text(MODEL)
    log = tmp_path / "log.txt"
    command = [sys.executable, "-u", "-c", START, "view", "cart.xml", "--no-browser", "--port", "0"]
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    with log.open("w") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, cwd=tmp_path, env=environment)
    try:
        wait_until(lambda: "live view is at" in log.read_text() or process.poll() is not None, limit=60)
        found = re.search(r"http://\S+", log.read_text())
        assert found is not None, log.read_text()
        page = open_page(found.group(0), width=1200, height=700)
        slider = page.get_by_role("slider", name="push, 0 to 1")
        slider.wait_for()
        # the motor without a range of its own has none
        assert page.get_by_role("slider", name=re.compile("wave")).count() == 0
        before = page.evaluate("morse.world.value.find('sled').frame.position.x")
        slider.evaluate("e => { e.value = '0.9'; e.dispatchEvent(new Event('input')); }")
        wait_until(
            lambda: page.evaluate("morse.world.value.find('sled').frame.position.x") - before > 0.5,
            "moved",
        )
        assert float(page.get_by_role("textbox", name="push").input_value()) == pytest.approx(0.9)
        # a text moves the slider
        field = page.get_by_role("textbox", name="push")
        field.fill("0.2")
        field.press("Enter")
        wait_until(lambda: float(slider.input_value()) == pytest.approx(0.2), "the slider follows")
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(60)
        finally:
            process.kill()


def test_pages_get_the_poses_of_their_nodes(tmp_path: Path) -> None:
    """Of a body that is fixed in the file between those that move, pages got the pose for the next one."""
    (tmp_path / "cart.xml").write_text(MODEL)
    (tmp_path / "scene.py").write_text(script_of(tmp_path / "cart.xml", None))
    with morse.load(str(tmp_path / "scene.py")) as simulation:
        simulation.robot.joints.publish({"push": 0.9})
        simulation.step(120)
        world = simulation.context.world
        nodes, poses = world.moving_nodes(), world.poses()
        assert {node.name for node, _ in nodes} == {"robot", "sled", "flag"}
        for (node, _), pose in zip(nodes, poses, strict=True):
            assert pose[:3] == pytest.approx(np.array(world.find_object(node).worldPosition), abs=1e-6), node.name
        sled = [node.name for node, _ in nodes].index("sled")
        assert poses[sled, 0] == pytest.approx(0.9, abs=1e-3)


def test_the_scene_has_the_joints_and_the_key_frame(tmp_path: Path) -> None:
    path = tmp_path / "it's a cart.xml"
    path.write_text(MODEL)
    text = script_of(path, None)
    assert f"Robot({str(path)!r}, keyframe='home')" in text
    assert "Armature('joints', armature_name='cart_joints')" in text
    assert "keyframe='far'" in script_of(path, "far")
    path.write_text('<mujoco><worldbody><geom type="box" size="1 1 1"/></worldbody></mujoco>')
    assert "Armature" not in script_of(path, None).split("\n", 1)[1]


_URDF = """<robot name="arm"><link name="base"><inertial><mass value="5"/>{inertia}</inertial>
<collision><geometry><box size=".4 .4 .1"/></geometry></collision></link>
<link name="upper"><inertial><mass value=".5"/>{inertia}</inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="20" velocity="2"/></joint></robot>""".format(
    inertia='<inertia ixx=".02" iyy=".02" izz=".02" ixy="0" ixz="0" iyz="0"/>'
)
_SDF = """<sdf version="1.9"><model name="arm"><link name="base"><inertial><mass>5</mass></inertial>
<collision name="c"><geometry><box><size>.4 .4 .1</size></box></geometry></collision></link>
<link name="upper"><inertial><mass>.5</mass></inertial></link>
<joint name="shoulder" type="revolute"><parent>base</parent><child>upper</child>
<axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>20</effort></limit></axis></joint>
</model></sdf>"""


@pytest.mark.parametrize(("name", "content"), [("arm.urdf", _URDF), ("arm.sdf", _SDF)])
def test_joints_of_other_formats_are_moved(tmp_path: Path, name: str, content: str) -> None:
    (tmp_path / name).write_text(content)
    (tmp_path / "scene.py").write_text(script_of(tmp_path / name, None))
    with morse.load(str(tmp_path / "scene.py")) as simulation:
        simulation.robot.joints.publish({"shoulder": 0.6})
        simulation.step(180)
        world = simulation.context.world
        upper = next(node for node, _ in world.moving_nodes() if node.name == "upper")
        turned = world.find_object(upper).worldOrientation
        assert np.arctan2(turned[1][0], turned[0][0]) == pytest.approx(0.6, abs=0.1)


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("none.xml", None, "There is no file"),
        ("cart.dae", MODEL, "shows MJCF, URDF and SDF files"),
        ("bad.xml", "<mujoco><worldbody><geom type='boxx'/></worldbody></mujoco>", "boxx"),
        ("cut.xml", MODEL[:200], "cannot be read"),
        ("empty.xml", "", "cannot be read"),
        ("nothing.xml", "<mujoco/>", "has no bodies"),
        ("bytes.xml", "\x00\x01", "cannot be read"),
    ],
)
def test_files_that_are_wrong_are_told_in_a_line(tmp_path: Path, name: str, content: str | None, told: str) -> None:
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(CommandError) as raised:
        script_of(tmp_path / name, None)
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_key_frame_that_does_not_exist_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cart.xml").write_text(MODEL)
    assert execute(["view", str(tmp_path / "cart.xml"), "--key", "hom"]) == 2
    assert "did you mean 'home'" in capsys.readouterr().err.lower()
