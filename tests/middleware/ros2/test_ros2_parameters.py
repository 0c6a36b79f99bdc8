"""The parameters of the node, read and set by the parameter client of rclpy in another process."""

import subprocess
import sys
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, has, lent, need, talk

import morse

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(Waypoint("goal"))
robot.append(VideoCamera("eye"))
env = Environment("empty", fastmode=True)
env.add_default_interface("ros2")
env.configure_stream_manager("ros2", domain_id={domain}, backend="rclpy")
"""
HERE = has(sys.executable, "rclpy")
BOOL, DOUBLE, STRING = 1, 3, 4

if HERE:

    @pytest.mark.peer("ros-jazzy-rclpy", does="a node lists, describes, gets and sets parameters")
    def test_properties_are_parameters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        for name in SETTINGS:
            monkeypatch.delenv(name, raising=False)
        (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
        with morse.load(tmp_path / "scene.py", sockets=True) as sim:
            said = talk("parameters_peer.py", sim.step)
            assert sim.context.component("robot.goal")._speed == 3.0
        assert said["before"] == [True, 1.0, "Velocity", None]
        speed, kind, misspelt, time = said["answers"]
        assert speed == kind == [True, ""]
        assert not misspelt[0]
        assert "did you mean 'robot.goal.Speed'" in misspelt[1]
        assert not time[0]
        assert "always true" in time[1]
        (fast, why_fast), (jump, why_jump), (same, _) = said["wrong"]
        assert not fast
        assert "the value is a string, expected a double" in why_fast
        assert not jump
        assert "'Jump', expected" in why_jump
        assert same
        assert not said["together"][0]
        assert said["after"] == [2.5, "Velocity"], "of parameters that are set together, none changes"
        assert said["whole"] == [[True, ""]], "a whole number is a number"
        assert said["types"] == [BOOL, DOUBLE, STRING]
        assert said["described"]["robot.goal.Speed"][0] == DOUBLE
        assert "m/s" in said["described"]["robot.goal.Speed"][1]
        assert "Velocity" in said["described"]["robot.goal.ControlType"][2]
        assert said["described"]["use_sim_time"][3]
        assert {"use_sim_time", "robot.goal.Speed", "robot.eye.cam_width"} <= set(said["all"])
        assert all(name.startswith("robot.goal.") for name in said["of_goal"])
        assert said["parents"] == ["robot.goal"]
        assert said["top"] == ["use_sim_time"]

else:

    @pytest.mark.timeout(300)
    @pytest.mark.peer("ros-jazzy-rclpy", does="a node lists, describes, gets and sets parameters")
    def test_properties_are_parameters() -> None:
        need("rclpy", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=280, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert " passed" in done.stdout
