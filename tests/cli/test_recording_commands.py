"""run --record: recordings, and refused options."""

import os
import signal
import subprocess
import sys
import threading

import pytest

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *

robot = ATRV()
motion, pose = MotionVW(), Pose()
robot.append(motion)
robot.append(pose)
Environment("empty")
"""


HALF_A_SECOND = ("run", "--headless", "--speed", "max", "--duration", "0.5")


def run(folder, *words, expected=0):
    """Run the scene of a folder in a process."""
    command = [sys.executable, "-m", "morse", *HALF_A_SECOND, *words, "scene.py"]
    environment = {**os.environ, "MORSE_SOCKET_PORT": "0"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=100)
    assert done.returncode == expected, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A folder with a scene, its recording, and what the run has said."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "scene.py").write_text(SCENE)
    return folder, run(folder, "--record", "run.mcap")


@pytest.fixture
def here(recorded, morse, monkeypatch):
    """The folder with the recording, in which commands are given with `morse`."""
    folder, _ = recorded
    monkeypatch.chdir(folder)
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    yield folder
    (folder / "scene.py").write_text(SCENE)


@pytest.fixture
def told(morse):
    """Give a command; its output and its messages."""

    def command(*words, expected=0):
        answer = morse(*words)
        assert answer.status == expected, answer.out + answer.err
        return answer.out, answer.err

    return command


def test_a_run_is_recorded(recorded):
    folder, out = recorded
    assert f"the run is recorded in {folder / 'run.mcap'}" in out
    from morse.recording.mcap.reader import McapFile

    with McapFile(folder / "run.mcap") as file:
        assert file.complete
        assert file.metadata["morse end"]["tick"] == "30"
        topics = {channel.topic: number for number, channel in file.channels.items()}
        assert sum(1 for _ in file.messages([topics["/robot/pose"]])) == 30


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--record", "scene.py"], "already exists"),
        (["--record", "nowhere/run.mcap"], "an existing folder"),
        (["--record", "."], "takes the path of a file"),
        (["--record-only", "robot.pose"], "give both"),
    ],
)
def test_mistakes_on_the_command_line_are_told_at_once(here, told, words, said):
    _, error = told(*HALF_A_SECOND, *words, "scene.py", expected=2)
    assert said in error
    assert (here / "scene.py").read_text() == SCENE


def test_a_sensor_that_is_not_there_is_named_with_the_nearest(tmp_path):
    (tmp_path / "scene.py").write_text(SCENE)
    out = run(tmp_path, "--record", "run.mcap", "--record-only", "robot.pos", expected=1)
    assert "there is no sensor 'robot.pos' to record; did you mean 'robot.pose'?" in out
    assert not (tmp_path / "run.mcap").exists()


def test_a_recording_is_simulated_again_and_exported(here, told):
    out, _ = told("replay", "run.mcap", "--resimulate", "--scene", "scene.py")
    assert "Equal to the bit" in out
    assert "30 ticks" in out
    (here / "other.py").write_text(SCENE.replace("MotionVW()", "MotionXYW()").replace("ATRV()", "Morsy()"))
    _, error = told("replay", "run.mcap", "--resimulate", "--scene", "other.py", expected=1)
    assert "differs from the recording from tick 1 on" in error
    out, _ = told("export", "run.mcap", "--csv", "--topics", "/robot/pose")
    assert "30 rows of /robot/pose" in out
    assert len((here / "run" / "robot.pose.csv").read_text().splitlines()) == 31
    told("export", "run.mcap", "--csv", "-o", "tables")
    assert (here / "tables" / "robot.pose.csv").is_file()
    out, _ = told("export", "run.mcap", "--mcap")
    assert "run-complete.mcap" in out
    out, _ = told("replay", "run-complete.mcap", "--resimulate", "--scene", "scene.py")
    assert "Equal to the bit" in out
    _, error = told("export", "run.mcap", "--mcap", expected=1)
    assert "run-complete.mcap exists" in error


@pytest.mark.parametrize(
    ("words", "said", "status"),
    [
        (["replay", "scene.py", "--resimulate"], "this is not a recording", 1),
        (["replay", "missing.mcap", "--resimulate"], "missing.mcap", 1),
        (["export", "scene.py", "--csv"], "this is not a recording", 1),
        (["replay", "scene.py"], "this is not a recording", 1),
        (["replay", "scene.py", "--record", "new.mcap"], "--record belongs to --resimulate", 2),
        (["export", "scene.py"], "--csv, --parquet or --as FORM", 2),
        (["export", "scene.py", "--csv", "--parquet"], "--csv, --parquet or --as FORM", 2),
    ],
)
def test_files_that_are_no_recordings(here, told, words, said, status):
    _, error = told(*words, expected=status)
    assert said in error
    assert "Traceback" not in error


@pytest.mark.usefixtures("here")
def test_a_replay_is_shown_until_ctrl_c():
    command = [sys.executable, "-m", "morse", "replay", "run.mcap", "--view-port", "0", "--no-browser"]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment) as child:
        watchdog = threading.Timer(100.0, child.kill)
        watchdog.start()
        lines = []
        for line in child.stdout:
            lines.append(line)
            if "the live view is at http://127.0.0.1:" in line:
                child.send_signal(signal.SIGINT)
        assert child.wait() == 0, "".join(lines) + child.stderr.read()
        watchdog.cancel()
    assert any("the live view is at" in line for line in lines)


def test_a_changed_script_is_executed_from_the_recording_only_if_it_is_trusted(here, told):
    (here / "scene.py").write_text(SCENE + "\n# edited")
    _, error = told("replay", "run.mcap", "--resimulate", expected=1)
    assert "--trust" in error
    assert "--scene PATH" in error
    out, _ = told("replay", "run.mcap", "--resimulate", "--trust")
    assert "Equal to the bit" in out


def test_inputs_alone_are_enough_to_record_everything_afterwards(here, told):
    run(here, "--record", "lean.mcap", "--record-only", "none")
    out, _ = told("replay", "lean.mcap", "--resimulate", "--scene", "scene.py", "--record", "all.mcap")
    assert "Equal to the bit: the state at the end of 30 ticks" in out
    told("export", "all.mcap", "--csv")
    assert len((here / "all" / "robot.pose.csv").read_text().splitlines()) == 31
