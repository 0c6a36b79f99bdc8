"""Services of components as services of ROS 2, called by a real node in another process."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from other_side import DOMAIN, PYTHON, has, lent, need, talk

import morse
from morse.core.services import service
from morse.rosmsgs.services import SET_BOOL, SET_PARAMETERS, TRIGGER, Call

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(Waypoint("goal"))
robot.append(Pose("pose"))
env = Environment("empty", fastmode=True)
env.add_default_interface("ros2")
env.configure_stream_manager("ros2", domain_id={domain}, backend="{backend}")
"""
HERE = has(sys.executable, "rclpy")


class Things:
    @service
    def none(self) -> int:
        return 1

    @service
    def switch(self, on: bool) -> None:
        pass

    @service
    def move(self, x: float, label: str = "a", points: list[Any] | None = None) -> None:
        pass


def value(kind: int, **fields: Any) -> dict[str, Any]:
    return {"type": kind, **fields}


def test_types_by_arguments() -> None:
    things = Things()
    assert [Call(method).type for method in (things.none, things.switch, things.move)] == [
        TRIGGER,
        SET_BOOL,
        SET_PARAMETERS,
    ]


def test_arguments_by_name() -> None:
    call = Call(Things().move)
    x = {"name": "x", "value": value(3, double_value=2.0)}
    points = {"name": "points", "value": value(4, string_value="[[1, 2], [3, 4]]")}
    label = {"name": "label", "value": value(4, string_value="[1]")}
    assert call.arguments({"parameters": [x]}) == [2.0]
    assert call.arguments({"parameters": [points, x]}) == [2.0, "a", [[1, 2], [3, 4]]]
    assert call.arguments({"parameters": [label, x]}) == [2.0, "[1]"], "a string stays a string where one is expected"
    for wrong, said in (
        ([], "'x' is missing"),
        ([x, x], "given twice"),
        ([x, {"name": "lable", "value": x["value"]}], "did you mean 'label'"),
    ):
        with pytest.raises(Exception, match=said):
            call.arguments({"parameters": wrong})


def test_answers() -> None:
    call = Call(Things().none)
    assert call.answer("SUCCESS", [1, {"a": 2.5}]) == {"success": True, "message": '[1,{"a":2.5}]'}
    assert call.answer("PREEMPTED", None) == {"success": False, "message": "PREEMPTED"}
    assert Call(Things().move).answer("FAILED", "no") == {"result": {"successful": False, "reason": "FAILED: no"}}


def test_a_backend_without_services_says_so(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    need("cyclonedds")
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE.format(domain=DOMAIN, backend="cyclonedds"))
    with morse.load(scene, sockets=True) as sim:
        sim.step(2)
    assert "cyclonedds has topics, but no services, actions and parameters" in caplog.text


if HERE:  # otherwise the Python with rclpy runs it, see below

    def test_a_node_calls_services(tmp_path: Path) -> None:
        scene = tmp_path / "scene.py"
        scene.write_text(SCENE.format(domain=DOMAIN, backend="rclpy"))
        with morse.load(scene, sockets=True) as sim:
            said = talk("service_peer.py", sim.step)
            assert sim.context.robots["robot"].position_3d.x == pytest.approx(5.0, abs=0.01)
        assert json.loads(said["robots"][1]) == ["robot"]
        assert said["status"] == [True, '"Stop"'] or said["status"][0] is True
        assert said["arrived"] == [True, '"Arrived"']
        assert said["missing"][0] is False
        assert "'y' is missing" in said["missing"][1]
        assert "did you mean 'y'" in said["unknown"][1]
        assert said["wrong"][1].startswith("FAILED: goto: 'x' is")
        assert said["put"][0] is True

else:

    @pytest.mark.timeout(200)
    @pytest.mark.peer("ros-jazzy-rclpy", does="a node calls services")
    def test_by_the_python_that_has_rclpy() -> None:
        need("rclpy", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", "-k", "a_node_calls", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=180, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert "1 passed" in done.stdout
