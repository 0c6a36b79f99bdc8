"""The seconds before a failure are saved, and can be simulated again."""

import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from recorded import SCRIPT, read_by_rosbags

import morse
from morse.recording.recording import Recording
from morse.simulation.recordings.recorders import FlightRecorder
from morse.verification.resimulation import resimulate

BROKEN = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data


class Broken(Sensor):
    _name = "Broken"
    add_data("count", 0, "int", "Measurements")

    def default_action(self):
        self.local_data["count"] += 1
        if self.local_data["count"] == 100:
            raise ValueError("a hundred is too much")
"""
SCENE = SCRIPT.replace(
    'Environment("empty")', 'from broken import Broken\nbad = Broken("bad")\nrobot.append(bad)\nEnvironment("empty")'
)


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "broken.py").write_text(BROKEN)
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    return path


@pytest.fixture
def lines() -> Iterator[list[str]]:
    found: list[str] = []
    listener = logging.Handler()
    listener.emit = lambda record: found.append(record.getMessage())  # type: ignore[method-assign]
    logging.getLogger("morse").addHandler(listener)
    yield found
    logging.getLogger("morse").removeHandler(listener)


def test_a_component_that_fails_leaves_a_file_that_shows_it_again(
    script: Path, tmp_path: Path, lines: list[str]
) -> None:
    with morse.load(script, seed=2) as sim:
        sim.observers.append(FlightRecorder(sim, 0.5))
        sim.step(20)
        sim.robot.motion.publish({"v": 1.0, "w": 0.2})
        sim.step(60)
        sim.robot.motion.publish({"v": -0.5})
        sim.step(20)
        wanted = sim.robot.pose.data
        sim.step(20)
    (path,) = tmp_path.glob("morse-failure-*.mcap")
    (named,) = [line for line in lines if str(path) in line]
    assert f"morse replay {path} --resimulate" in named
    lines.clear()
    with Recording(path) as recording:
        assert recording.end["failure"] == "robot.bad failed"
        assert recording.last_tick() == 100
        first = recording.number("tick")
        assert 100 - first >= 30  # half a second
        assert first > 0
        outcome = resimulate(recording, trust=True, record=str(tmp_path / "again.mcap"))
    assert outcome.ticks == 100 - first
    assert any("a hundred is too much" in line for line in lines)
    _, last = read_by_rosbags(tmp_path / "again.mcap")["/robot/pose"][-1]
    position = last.pose.pose.position
    assert (position.x, position.y, position.z) == (wanted["x"], wanted["y"], wanted["z"])


def test_a_restart_and_a_restored_state_begin_anew(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim:
        recorder = FlightRecorder(sim, 0.5)
        sim.observers.append(recorder)
        sim.step(30)
        before = sim.save()
        sim.step(30)
        sim.restore(before)
        sim.step(5)
        path = recorder.write("somebody says so", sim.ticks)
        assert path is not None
        with Recording(path) as recording:
            assert (recording.number("tick"), recording.last_tick()) == (30, 35)
        sim.restart(9)
        sim.step(4)
        path = recorder.write("somebody says so", sim.ticks)
        assert path is not None
        with Recording(path) as recording:
            assert (recording.number("tick"), recording.number("seed"), recording.last_tick()) == (0, 9, 4)
            assert resimulate(recording, trust=True).ticks == 4


def test_no_run_leaves_more_than_three_files(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim:
        recorder = FlightRecorder(sim, 1.0)
        assert [recorder.write("again", 1) is None for _ in range(5)] == [False, False, False, True, True]
    assert len(list(tmp_path.glob("morse-failure-*.mcap"))) == 3


def test_a_new_file_replaces_the_oldest_one_of_the_user(script: Path, tmp_path: Path) -> None:
    old = [tmp_path / f"morse-failure-{number}.mcap" for number in range(11)]
    for number, path in enumerate(old):
        path.touch()
        os.utime(path, (number, number))
    aside = tmp_path / "kept.mcap"
    aside.touch()
    link = tmp_path / "morse-failure-link.mcap"
    link.symlink_to(aside)
    with morse.load(script) as sim:
        path = FlightRecorder(sim, 1.0).write("somebody says so", 1)
    assert path is not None
    assert sorted(tmp_path.glob("*.mcap")) == sorted([*old[2:], Path(path), aside, link])


@pytest.mark.parametrize(
    ("ticks", "wanted"),
    [(1, "the tick of the failure is in"), (30, "the last 30 ticks before the failure are in"), (90, "the last 2 s ")],
)
def test_the_log_tells_how_much_was_kept(script: Path, lines: list[str], ticks: int, wanted: str) -> None:
    with morse.load(script) as sim:
        FlightRecorder(sim, 1.0).write("somebody says so", ticks)
    (line,) = [line for line in lines if "morse replay" in line]
    assert wanted in line


def test_morse_run_keeps_it_unless_told_otherwise(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    words = [sys.executable, "-m", "morse", "run", "--headless", "--speed", "max", "--duration", "2"]
    done = subprocess.run([*words, script], capture_output=True, text=True, timeout=100)
    assert "a hundred is too much" in done.stdout
    (path,) = tmp_path.glob("morse-failure-*.mcap")
    assert str(path) in done.stdout
    path.unlink()
    done = subprocess.run([*words, "--keep-last", "0", script], capture_output=True, text=True, timeout=100)
    assert "a hundred is too much" in done.stdout
    assert list(tmp_path.glob("morse-failure-*.mcap")) == []
