"""Names and quality of service of topics from a file: what it changes, and what is wrong with it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from morse.core.exceptions import MorseMiddlewareError
from morse.rosmsgs.remap import Remaps
from morse.rosmsgs.table import Qos

FILE = """---
# names of another stack
/robot/scan: /front/scan   # a short form
"/robot/pose":
  topic: 'truth'
  reliability: best_effort
  depth: 3
/robot/cmd_vel: /diff_drive/cmd_vel
/clock:
    durability: transient_local
"""
PARTS = "robot.append(Hokuyo('scan')); robot.append(Pose('pose')); robot.append(MotionVW('motion'))"


def test_a_file_changes_names_and_quality(start: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "remap.yaml").write_text(FILE)
    sim, desk = start(PARTS, "env.configure_stream_manager('ros2', remap='remap.yaml')")
    sim.step(12)
    assert {"/front/scan", "/truth", "/clock", "/tf"} <= desk.publishers.keys()
    assert not {"/robot/scan", "/robot/pose"} & desk.publishers.keys()
    assert desk.publishers["/truth"][1] == Qos(3, reliable=False)
    assert desk.publishers["/clock"][1].latched
    vector = desk.store.types["geometry_msgs/msg/Vector3"]
    desk.send("/diff_drive/cmd_vel", linear=vector(1.0, 0.0, 0.0), angular=vector(0.0, 0.0, 0.0))
    sim.step(60)
    assert desk.last("/truth").pose.position.x == pytest.approx(2.0, abs=0.05)


def test_a_script_does_the_same_with_a_dictionary(start: Callable[..., Any]) -> None:
    remap = {"/robot/pose": {"topic": "/a", "depth": 2}, "/robot/scan": "/robot/pose"}
    sim, desk = start(PARTS, f"env.configure_stream_manager('ros2', remap={remap})")
    sim.step(12)
    assert desk.publishers["/robot/pose"][0] == "sensor_msgs/msg/LaserScan"
    assert desk.publishers["/a"][:2] == ("geometry_msgs/msg/PoseStamped", Qos(2))


def test_a_name_that_no_topic_has(start: Callable[..., Any], tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "remap.yaml").write_text("\n/robot/scna: /scan\n")
    sim, _ = start(PARTS, "env.configure_stream_manager('ros2', remap='remap.yaml')")
    sim.step(2)
    assert "remap.yaml, line 2: there is no topic '/robot/scna'; did you mean '/robot/scan'?" in caplog.text
    assert caplog.text.count("there is no topic") == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/a: /b\n/a: /c", "line 2: the topic '/a' is there twice"),
        ("/a:\n  relaibility: reliable", "line 2: there is no 'relaibility'; did you mean 'reliability'"),
        ("/a:\n  reliability: best", "line 2: reliability is 'best', expected reliable or best_effort"),
        ("/a:\n  depth: 0", "line 2: depth is '0', expected a number from 1 to 10000"),
        ("/a:\n  depth: 1\n  depth: 2", "line 3: 'depth' is there twice"),
        ("/a:\n  depth: 1\n    topic: /b", "line 3: the indentation of 'topic'"),
        ("  depth: 1", "line 1: the indentation"),
        ("/a: /b\n  depth: 1", "line 2: the indentation"),
        ("- /a", "line 1: '- /a', expected 'name: value'"),
        ("/a:\n\tdepth: 1", "line 2: .*expected 'name: value', indented by spaces"),
        ("/a: {depth: 1}", "line 1: the topic is '{depth: 1}', expected words"),
        ("/a:", "line 1: expected a new name, or topic, reliability"),
        ("/a b: /c", "line 1: the topic is '/a b', expected words"),
        ("/a: 1st", "line 1: the topic is '1st', expected words"),
    ],
)
def test_what_is_wrong_and_where(tmp_path: Path, text: str, expected: str) -> None:
    (tmp_path / "wrong.yaml").write_text(text)
    with pytest.raises(MorseMiddlewareError, match=f"wrong.yaml, {expected}"):
        Remaps("wrong.yaml", [str(tmp_path)])


def test_a_missing_file_and_a_wrong_dictionary(tmp_path: Path) -> None:
    with pytest.raises(MorseMiddlewareError, match=f"no file 'gone.yaml' in .*{tmp_path}"):
        Remaps("gone.yaml", [str(tmp_path)])
    with pytest.raises(MorseMiddlewareError, match="option 'remap', '/a': there is no 'deep'; did you mean 'depth'"):
        Remaps({"/a": {"deep": 1}})
    with pytest.raises(MorseMiddlewareError, match="option 'remap', '/a': 3, expected the name of a topic"):
        Remaps({"/a": 3})
