"""Commands, ticks and data in one call."""

import json
import socket
from pathlib import Path

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW, PassiveObject, Pose, Sick
from morse.core.exceptions import MorseRPCInvokationError
from morse.services.foreign_models import check_model
from morse.services.population_services import PopulationServices
from morse.testing.process import SimulationProcess
from pymorse import Morse, MorseServiceFailed


def scene() -> None:
    robot = ATRV("robot")
    for part in (Pose("pose"), MotionVW("motion"), Sick("scan")):
        robot.append(part)
    robot.add_default_interface("socket")
    Environment("empty", fastmode=True)


def test_commands_act_in_the_ticks_and_data_are_those_of_the_last_one(simu: Morse) -> None:
    robot = simu.robot
    before = simu.exchange(read=[robot.pose])[robot.pose]
    after = simu.exchange({robot.motion: {"v": 1.0, "w": 0.0}}, [robot.pose, "robot.scan"], n=30)
    assert after[robot.pose]["timestamp"] - before["timestamp"] == pytest.approx(0.5)
    assert after[robot.pose]["x"] - before["x"] == pytest.approx(0.5, abs=1e-6)
    assert len(after["robot.scan"]["range_list"]) == 181
    assert simu.time() == pytest.approx(after[robot.pose]["timestamp"])


def test_nothing_has_to_be_read_or_commanded(simu: Morse) -> None:
    begin = simu.time()
    assert simu.exchange(n=6) == {}
    assert simu.time() - begin == pytest.approx(0.1)


def test_the_command_stays_until_the_next_one(simu: Morse) -> None:
    pose = simu.robot.pose
    simu.exchange({simu.robot.motion: {"v": 1.0}})
    first = simu.exchange(read=[pose])[pose]["x"]
    assert simu.exchange(read=[pose], n=60)[pose]["x"] - first == pytest.approx(1.0, abs=1e-6)
    simu.exchange({simu.robot.motion: {"v": 0.0}})
    first = simu.exchange(read=[pose])[pose]["x"]
    assert simu.exchange(read=[pose], n=60)[pose]["x"] == pytest.approx(first, abs=1e-6)


@pytest.mark.parametrize(
    ("commands", "read", "said"),
    [
        ({"robot.motio": {"v": 1.0}}, [], "robot.motion"),
        ({"robot.pose": {"x": 1.0}}, [], "not an actuator"),
        ({"robot.motion": {"v": "fast"}}, [], "'v' is 'fast', expected a number"),
        ({"robot.motion": {"speed": 1.0}}, [], "speed"),
        ({"robot.motion": 5}, [], "expected"),
        ({"robot.motion": {"v": 1.0}}, ["robot.posee"], "robot.pose"),
        ([1], [], "'commands' is an object"),
        ({}, [3], "no component 3"),
        ({}, [["robot.pose"]], "no component"),
    ],
)
def test_what_does_not_fit_is_refused_and_no_time_passes(
    simu: Morse, commands: object, read: list[object], said: str
) -> None:
    begin = simu.time()
    with pytest.raises((MorseServiceFailed, TypeError), match=said):
        simu.rpc("simulation", "exchange", commands, read)
    assert simu.time() == begin
    assert simu.rpc("simulation", "exchange", {}, ["robot.motion"])["robot.motion"]["v"] == 0.0


def test_any_client_can_do_it_in_one_line(process: SimulationProcess, simu: Morse) -> None:
    with socket.create_connection(("127.0.0.1", process.port), timeout=60) as wire, wire.makefile("rb") as lines:
        wire.sendall(b'1 simulation exchange [{"robot.motion": {"v": 0.0}}, ["robot.pose", "robot.motion"]]\n')
        number, status, value = lines.readline().split(b" ", 2)
    assert (number, status) == (b"1", b"SUCCESS")
    assert list(json.loads(value)) == ["robot.pose", "robot.motion"]


# -- clients cannot make the simulation read any file of the disk ----------------------------------


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("here", "project", "listed", "elsewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "m.obj").write_text("v 0 0 0\n")
    (tmp_path / "project" / "link.obj").symlink_to(tmp_path / "elsewhere" / "m.obj")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path


@pytest.mark.parametrize("kind", ["ATRV", "props/crates", "m.obj", "robots/atrv.blend"])
def test_names_are_looked_up_in_the_usual_folders(kind: str) -> None:
    check_model(kind, [])


def test_full_paths_lead_into_the_folders_of_the_user(folders: Path) -> None:
    for name in ("here", "project", "listed"):
        check_model(str(folders / name / "m.obj"), [str(folders / "project"), folders / "listed"])


@pytest.mark.parametrize(
    "kind",
    ["{0}/elsewhere/m.obj", "{0}/project/link.obj", "{0}/project/../elsewhere/m.obj", "../elsewhere/m.obj", "~/m.obj",
     "//server/share/m.obj", "\\\\server\\share\\m.obj", "C:\\m.obj", "file:///m.obj", "http://localhost/m.obj",
     "/dev/stdin.obj", "/m\0.obj"],
)  # fmt: skip
def test_other_files_are_not_read(folders: Path, kind: str) -> None:
    class Simulation:
        def spawn(self, *_: object) -> None:
            raise AssertionError("it must not be read")

        def delete(self, name: str) -> None:
            raise AssertionError

    services = PopulationServices(Simulation(), lambda: [str(folders / "project")])
    with pytest.raises(MorseRPCInvokationError, match="add its folder to MORSE_RESOURCE_PATH"):
        services.spawn("x", kind.format(folders))


def test_a_running_simulation_knows_the_folders_of_the_user(folders: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n"
    for name in ("listed", "elsewhere"):
        (folders / name / "m.obj").write_text(triangle)
    (folders / "scene.py").write_text("from morse.builder import *\nenv = Environment('empty')\n")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(folders / "listed"))
    with morse.load(folders / "scene.py") as sim:
        assert sim.rpc("simulation", "spawn", "one", str(folders / "listed" / "m.obj")) == "one"
        with pytest.raises(MorseServiceFailed, match="MORSE_RESOURCE_PATH"):
            sim.rpc("simulation", "spawn", "two", str(folders / "elsewhere" / "m.obj"))


def test_only_the_script_searches_the_folders_around_it(folders: Path) -> None:
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n"
    (folders / "near.obj").write_text(triangle)
    (folders / "scene.py").write_text(
        "from morse.builder import *\nthing = PassiveObject('near.obj')\nenv = Environment('empty')\n"
    )
    with morse.load(folders / "scene.py") as sim:
        for name in ("near.obj", str(folders / "near.obj")):
            with pytest.raises(MorseServiceFailed):
                sim.rpc("simulation", "spawn", "two", name)
        sim.spawn("two", lambda: PassiveObject("near.obj"))
