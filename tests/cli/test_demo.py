"""``morse demo``."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

import morse
from morse.cli.app import execute
from morse.cli.demo import examples

START = "import sys; from morse.cli import main; sys.exit(main())"


def test_examples_are_listed(capsys):
    assert execute(["demo"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:-1]] == list(examples())


@pytest.mark.parametrize("name", examples())
def test_the_scene_of_an_example_has_no_warnings(name):
    with morse.load(examples()[name].scene, on_warning="raise") as simulation:
        simulation.step(2)


def test_an_example_runs_with_its_client():
    environment = {**os.environ, "MORSE_SOCKET_PORT": "0", "PYTHONPATH": str(Path(morse.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, "-c", START, "demo", "repeatable", "--headless", "--speed", "max"],
        env=environment,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "The same seed: the same. Another seed: different." in done.stdout


def test_an_example_is_copied(tmp_path, capsys):
    assert execute(["demo", "drive", "--copy", str(tmp_path)]) == 0
    assert {path.name for path in (tmp_path / "drive").iterdir()} == {"scene.py", "client.py"}
    assert str(tmp_path / "drive" / "scene.py") in capsys.readouterr().out
    assert execute(["demo", "drive", "--copy", str(tmp_path)]) == 1
    assert "choose another folder" in capsys.readouterr().err


def test_an_interrupted_command_says_so(capsys, monkeypatch):
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("morse.cli.demo._list", interrupted)
    assert execute(["demo"]) == 130
    assert capsys.readouterr().err == "* Interrupted.\n"


def test_mistakes_are_said_in_a_line(capsys):
    for words, status, answer in ((["drvie"], 1, "Did you mean 'drive'?"), (["--headless"], 2, "Which example?")):
        assert execute(["demo", *words]) == status
        error = capsys.readouterr().err
        assert answer in error
        assert len(error.splitlines()) == 1


def test_the_arrow_keys_drive_the_robot_of_the_first_steps():
    with morse.load(examples()["laser"].scene, sockets=False) as simulation:
        simulation.set_controls(frozenset(["ArrowUp"]))
        simulation.sleep(1.0)
        simulation.measure()
        data = simulation.robot.pose.data
        # the keys drive 1 m/s, and the robot looks to 1.2 rad
        assert math.hypot(data["x"], data["y"]) == pytest.approx(1.0, abs=0.03)
        assert math.atan2(data["y"], data["x"]) == pytest.approx(1.2, abs=0.01)
