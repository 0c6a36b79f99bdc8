"""Layouts of Foxglove, by the classes of its SDK."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from morse.cli.export import write_layout
from morse.middleware.foxglove.layout import layout_of

SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW(); robot.append(motion)
odometry = Odometry(); robot.append(odometry)
scan = Hokuyo(); scan.translate(x=0.3, z=0.6); robot.append(scan)
eye = VideoCamera(); eye.translate(x=0.3, z=0.8); robot.append(eye)
env = Environment("empty")
env.configure_stream_manager("foxglove", port=0)
"""


def panels(content: dict[str, Any]) -> Iterator[dict[str, Any]]:
    if content["type"] == "panel":
        yield content
    for item in (*content.get("items", ()), *content.get("tabs", ())):
        yield from panels(item["content"])


@pytest.fixture
def layout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    (tmp_path / "scene.py").write_text(SCENE)
    assert write_layout(str(tmp_path / "scene.py"), tmp_path / "layout.json") == 0
    made: dict[str, Any] = json.loads((tmp_path / "layout.json").read_text())
    return made


def test_each_panel_has_the_topics_of_the_scene(layout: dict[str, Any]) -> None:
    by_kind = {one["panelType"]: one["config"] for one in panels(layout["content"])}
    assert {"/robot/scan", "/robot/robot_description"} <= by_kind["ThreeDee"]["topics"].keys()
    assert by_kind["Image"]["imageMode"] == {
        "imageTopic": "/robot/eye/image",
        "calibrationTopic": "/robot/eye/camera_info",
    }
    assert by_kind["Teleop"]["topic"] == "/robot/cmd_vel"
    assert by_kind["Plot"]["paths"][0]["value"] == "/robot/odometry.twist.twist.linear.x"
    assert {"Parameters", "TopicGraph", "Log"} <= by_kind.keys()


def test_a_recording_takes_no_commands() -> None:
    layout = layout_of({"/robot/odometry": "nav_msgs/msg/Odometry", "/rosout": "rcl_interfaces/msg/Log"})
    assert {one["panelType"] for one in panels(layout["content"])} == {"ThreeDee", "Plot", "DataSourceInfo", "Log"}


@pytest.mark.peer("foxglove-sdk", does="has the panels and settings of layouts")
def test_the_sdk_has_these_panels_and_settings(layout: dict[str, Any]) -> None:
    layouts = pytest.importorskip("foxglove.layouts", reason="see .ci/foxglove")
    classes = {
        name.removesuffix("Panel"): getattr(layouts, name.removesuffix("Panel") + "Config", None)
        for name in dir(layouts)
        if name.endswith("Panel")
    }
    for panel in panels(layout["content"]):
        assert panel["panelType"] in classes
        config = classes[panel["panelType"]]
        if config is not None:
            assert panel["config"].keys() <= config()._to_dict().keys()
    whole = layouts.Layout(content=layouts.ParametersPanel())._to_dict()
    assert layout.keys() <= whole.keys()
    assert layout["version"] == whole["version"]
