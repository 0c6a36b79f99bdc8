"""MOOS: variables with the names of 1.4, and a database that comes late, goes, or sends nonsense."""

import math
import re
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from moos_database import Database

import morse
from morse.core.exceptions import MorseError

DOCS = Path(__file__).resolve().parents[3] / "docs"
LIMIT = 60.0
SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(1.0, 2.0, 0.5)
{components}
robot.add_default_interface("moos")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("moos", moos_port={port}, rate=200.0)
"""
ALL = """
for component in (Pose("pose"), Gyroscope("gyro"), IMU("imu"), GPS("gps"), Sick("scan"), Battery("battery"),
                  MotionVW("motion"), Teleport("teleport"), Light("light"), Gripper("gripper")):
    robot.append(component)
"""
#: a packet whose only message has no size: it was read again and again
_MESSAGE = struct.pack("<iiBB", 0, 1, 78, 68) + bytes(16) + struct.pack("<3d", 1.0, 2.0, 0.0) + bytes(4)
ENDLESS = struct.pack("<iiB", len(_MESSAGE) + 9, 10_000, 0) + _MESSAGE
POSE = "pose = Pose(); robot.append(pose)\nmotion = MotionXYW(); robot.append(motion)\n"


@pytest.fixture(autouse=True)
def _needs_pymoos2() -> None:
    if find_spec("pymoos2") is None:
        pytest.skip("there is no pymoos2: pip install pymoos2")


@pytest.fixture
def database() -> Iterator[Database]:
    made = Database()
    yield made
    made.close()


@pytest.fixture
def load(tmp_path: Path, database: Database) -> Callable[..., Any]:
    def made(components: str, world: str = "empty") -> Any:
        script = tmp_path / "scene.py"
        script.write_text(SCENE.format(components=components, port=database.port).replace('"empty"', f'"{world}"'))
        return morse.load(script, sockets=True)

    return made


def step_until(sim: Any, holds: Callable[[], bool]) -> None:
    end = time.monotonic() + LIMIT
    while not holds():
        assert time.monotonic() < end, "it never came true"
        sim.step()


def number(database: Database, key: str) -> float:
    return database.values[key].number if key in database.values else math.nan


def test_sensors_publish_the_variables_of_1_4(load: Callable[..., Any], database: Database) -> None:
    with load(ALL) as sim:
        step_until(
            sim, lambda: "MORSE_LIDAR_DIST" in database.values and "MORSE_ROBOT_BATTERY_CHARGE" in database.values
        )
        values = dict(database.values)
        for key, wanted in (("SIM_X", 1.0), ("SIM_Y", 2.0), ("SIM_Z", 0.5), ("GPS_E_X", 1.0), ("GPS_N_Y", 2.0)):
            assert values[f"MORSE_{key}"].number == pytest.approx(wanted, abs=1e-6), key
        assert values["MORSE_GPS_ALT_Z"].number == pytest.approx(0.5, abs=1e-6)
        assert values["MORSE_TIME"].number > 0.0
        for key in ("SIM_YAW", "SIM_PITCH", "SIM_ROLL", "GYRO_YAW", "GYRO_PITCH", "GYRO_ROLL", "IMU_GYRO_X"):
            assert values[f"MORSE_{key}"].number == pytest.approx(0.0, abs=1e-9), key
        assert values["MORSE_IMU_ACCEL_Z"].number == pytest.approx(9.81, abs=0.05)
        assert [values[f"MORSE_LIDAR_{key}"].number for key in ("SCANANGLE", "SCANRESOLUTION", "SCANRANGE")] == [
            180.0,
            1.0,
            30.0,
        ]
        scan = re.fullmatch(rb"\[1x181\]\{(.*)\}", values["MORSE_LIDAR_DIST"].text)
        assert scan is not None
        assert [float(word) for word in scan[1].split(b",")] == [30.0] * 181
        assert values["MORSE_ROBOT_BATTERY_STATUS"].text
        assert {note.source for note in values.values()} == {"iMorse"}


def test_variables_command_actuators(load: Callable[..., Any], database: Database) -> None:
    with load(ALL) as sim:
        step_until(sim, lambda: any("MORSE_SET_YAW" in client.registered for client in database.clients))
        data = {name: sim.context.components[f"robot.{name}"].local_data for name in ("motion", "teleport", "light")}
        database.publish("MORSE_LIGHT", "off")
        database.publish("MORSE_MOTION_VELOCITY", 0.25)
        database.publish("MORSE_MOTION_YAWRATE", "-0.5")
        step_until(sim, lambda: data["motion"]["w"] == -0.5 and data["light"]["emit"] is False)
        assert data["motion"]["v"] == 0.25
        database.publish("MORSE_LIGHT", 1.0)
        step_until(sim, lambda: data["light"]["emit"] is True)
        for word in ("soon", "NaN", "[1", '{"v": 1}'):
            database.publish("MORSE_MOTION_VELOCITY", word)
            database.publish("MORSE_LIGHT", word)
        database.publish("MORSE_MOTION_YAWRATE", 0.125)
        step_until(sim, lambda: data["motion"]["w"] == 0.125)
        assert data["motion"]["v"] == 0.25
        assert data["light"]["emit"] is True


def test_an_actuator_that_1_4_does_not_know_has_variables_of_its_own(
    load: Callable[..., Any], database: Database
) -> None:
    with load(POSE) as sim:
        step_until(sim, lambda: any("MORSE_ROBOT_MOTION_X" in client.registered for client in database.clients))
        before = number(database, "MORSE_SIM_X")
        database.publish("MORSE_ROBOT_MOTION_X", 1.0)
        step_until(sim, lambda: number(database, "MORSE_SIM_X") > 1.2)
        assert not before > 1.01


def test_a_stream_may_have_a_database_of_its_own(load: Callable[..., Any], database: Database) -> None:
    # 1.4 takes the address from the options of the stream
    own = Database()
    options = f"moos_host='127.0.0.1', moos_port={own.port}, moos_name='second'"
    try:
        with load(POSE + f"pose.add_stream('moos', {options})\n") as sim:
            step_until(sim, lambda: "MORSE_SIM_X" in own.values)
            step_until(sim, lambda: any("MORSE_ROBOT_MOTION_X" in client.registered for client in database.clients))
            assert own.values["MORSE_SIM_X"].source == "second"
            assert "MORSE_SIM_X" not in database.values
    finally:
        own.close()


def test_a_database_that_sends_nonsense_is_left_and_found_again(
    load: Callable[..., Any], database: Database, caplog: pytest.LogCaptureFixture
) -> None:
    with load(POSE) as sim:
        step_until(sim, lambda: "MORSE_SIM_X" in database.values)
        for wrong in (
            struct.pack("<i", 2**31 - 1),
            struct.pack("<i", -5),
            struct.pack("<iiB", 13, 7, 0) + b"abcd",
            ENDLESS,
        ):
            clients = len(database.clients)
            database.wrong = wrong
            step_until(sim, lambda clients=clients: len(database.clients) > clients)
        database.wrong = b""
        database.values.clear()
        step_until(sim, lambda: "MORSE_SIM_X" in database.values)
        # variables are registered again
        step_until(sim, lambda: any("MORSE_ROBOT_MOTION_X" in one.registered for one in database.clients[-1:]))


def test_of_many_values_of_a_variable_the_last_ones_are_read(load: Callable[..., Any], database: Database) -> None:
    from pymoos2.core import constants
    from pymoos2.core.MOOSMsg import MOOSMsg

    with load(POSE) as sim:
        step_until(sim, lambda: "MORSE_SIM_X" in database.values)
        (manager,) = (one for one in sim.context.stream_managers.values() if hasattr(one, "database_of"))
        (connected,) = manager._databases.values()
        read: list[float | str] = []
        for key in list(manager._takers):
            manager._takers[key] = [lambda *what: read.append(what[1])]
        # 19,000 values that are refused took 0.1 s of a tick, or a second of a loaded machine
        wrong = [MOOSMsg(constants.MSG_NOTIFY, "MORSE_ROBOT_MOTION_X", sval="[1,2") for _ in range(19_000)]
        connected._exchange._incoming += [*wrong, MOOSMsg(constants.MSG_NOTIFY, "MORSE_ROBOT_MOTION_X", val=0.5)]
        manager.action()
        assert len(read) < 50
        assert read[-1] == 0.5


def test_a_database_that_breaks_every_connection_is_named(
    load: Callable[..., Any], database: Database, caplog: pytest.LogCaptureFixture
) -> None:
    database.wrong = struct.pack("<i", -5)
    with load(POSE) as sim:
        step_until(sim, lambda: len(database.clients) > 1 and "a packet of -5 bytes" in caplog.text)
    assert len([line for line in caplog.messages if "-5 bytes" in line]) == 1


def test_a_simulation_that_is_refused_leaves_no_connection(load: Callable[..., Any]) -> None:
    before = set(threading.enumerate())
    with pytest.raises(MorseError):
        load(POSE + 'pose.add_stream("moos", prefix="")\n')
    assert not [thread.name for thread in set(threading.enumerate()) - before if "_comms_loop" in thread.name]


def test_the_simulation_runs_without_a_database(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(components=POSE, port=1))
    with morse.load(script, sockets=True) as sim:
        sim.step(30)
        assert sim.ticks == 30


def test_a_prefix_is_part_of_a_name(load: Callable[..., Any]) -> None:
    with pytest.raises(MorseError, match="the prefix is 'a b', expected a part of a name"):
        load(POSE + 'pose.add_stream("moos", prefix="a b")\n')


def test_what_is_missing_is_named_with_the_line_that_installs_it(
    load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith("pymoos2")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pymoos2", None)
    with pytest.raises(MorseError, match=r'pip install "pymoos2>=0.1,<0.2"'):
        load(POSE)


def test_the_client_of_the_documentation(load: Callable[..., Any], database: Database, tmp_path: Path) -> None:
    _, client = re.findall(r"```python\n(.*?)```", (DOCS / "moos.md").read_text(), re.DOTALL)
    path = tmp_path / "client.py"
    path.write_text(client.replace("9000", str(database.port)).replace("x < 0.5", "x < 1.5"))
    with load("motion = MotionVW(); robot.append(motion)\npose = Pose(); robot.append(pose)\n") as sim:
        process = subprocess.Popen([sys.executable, str(path)], stdout=subprocess.PIPE, text=True)
        try:
            step_until(sim, lambda: process.poll() is not None)
            assert process.communicate()[0] == "x is 0.5 m\n"
        finally:
            process.kill()
            process.wait()
        assert number(database, "MORSE_SIM_X") >= 1.5
