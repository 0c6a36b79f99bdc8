"""Two simulations in one domain, which share topics and commands."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from other_side import DOMAIN, SETTINGS, need

from tests.kit.waiting import wait_until

LIMIT = 60.0
SCENE = """
from morse.builder import *
robot = ATRV()
pose = Pose()
robot.append(pose)
robot.add_default_interface("ros2")
env = Environment("empty")
env.configure_stream_manager("ros2", domain_id={domain}, backend="cyclonedds")
"""


@pytest.fixture
def participants(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Any]]:
    need("cyclonedds")
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    made: list[Any] = []
    yield made
    for one in made:
        one.close()


def test_a_simulation_sees_others_by_the_name_of_their_node(participants: list[Any]) -> None:
    from morse.middleware.ros2.backends.cyclone import CycloneBackend

    options = {"domain_id": DOMAIN, "interface": "lo"}
    first, other = CycloneBackend(options), CycloneBackend(options, "morse_messages")
    participants += [first, other]
    matched = other.graph._writer.get_publication_matched_status
    assert wait_until(lambda: matched().current_count == 2)
    assert other.graph._writer.wait_for_acks(10**9 * int(LIMIT))
    assert not first.has_namesake(), "neither itself, nor another node"
    assert not other.has_namesake()
    participants.append(CycloneBackend(options))
    assert wait_until(participants[-1].has_namesake), "the second one"
    assert wait_until(first.has_namesake), "and the first one"


def test_both_simulations_are_told(participants: list[Any], tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    import morse

    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
    with morse.load(tmp_path / "scene.py", sockets=True) as first:
        first.step(60)
        assert "another simulation" not in caplog.text
        with morse.load(tmp_path / "scene.py", sockets=True) as second:
            for one in (first, second):
                caplog.clear()
                end = time.monotonic() + LIMIT
                while "another simulation" not in caplog.text and time.monotonic() < end:
                    one.step()
                assert "domain_id" in caplog.text
                assert f"domain {DOMAIN}" in caplog.text
