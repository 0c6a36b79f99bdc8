"""An autopilot in the loop, as PX4 reads its messages: what it takes as a measurement, its clock, lockstep."""

import math
import socket
import threading
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.kit.programs import free_port

pytest.importorskip("pymavlink")

from hil_controller import Controller
from pymavlink.dialects.v20 import common

import morse

pytestmark = pytest.mark.long

#: bits of fields_updated that PX4 wants together
ACCELERATION, RATES, FIELD, PRESSURE = 0b111, 0b111000, 0b111000000, 0b1101000000000
SCENE = """
from morse.builder import *
robot = Quadrotor(); robot.translate(z=0.2)
imu = IMU(); robot.append(imu)
baro = Barometer(); robot.append(baro)
gps = GPS(); gps.level("raw"); robot.append(gps)
motors = QuadrotorDynamicControl(); robot.append(motors)
for part in (imu, baro, gps):
    part.add_stream("mavlink")
    part.frequency(250)
motors.add_stream("mavlink", full=800.0)
env = Environment("empty", fastmode=True)
env.simulator_frequency(250)
env.properties(longitude=8.5456, latitude=47.3977, altitude=0.0)
env.configure_stream_manager("mavlink", device="tcpin:127.0.0.1:{port}", hil=True, world="enu")
"""


#: in the order of the bits of fields_updated
FIELDS = ("xacc", "yacc", "zacc", "xgyro", "ygyro", "zgyro", "xmag", "ymag", "zmag", "abs_pressure")


class Autopilot(threading.Thread):
    """Answers each HIL_SENSOR with controls, as PX4 does in lockstep, until it has enough."""

    def __init__(self, port: int, count: int, flags: int = 1) -> None:
        super().__init__()
        self.mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.sensors: list[Any] = []
        self.fixes: list[Any] = []
        self._count, self._flags = count, flags

    def run(self) -> None:
        self.send(0)
        while len(self.sensors) < self._count and (data := self.socket.recv(1 << 16)):
            for message in self.mav.parse_buffer(bytearray(data)) or ():
                if message.get_type() == "HIL_SENSOR":
                    self.sensors.append(message)
                    self.send(message.time_usec)
                elif message.get_type() == "HIL_GPS":
                    self.fixes.append(message)
        self.socket.close()

    def send(self, time_usec: int) -> None:
        controls = self.mav.hil_actuator_controls_encode(time_usec, [0.1] * 4 + [0.0] * 12, 129, self._flags)
        self.socket.sendall(controls.pack(self.mav))


@pytest.mark.peer("pymavlink", does="lockstep of an autopilot in the loop, by the rules of PX4")
def test_px4_takes_every_measurement_and_is_kept_in_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    port = free_port()
    (tmp_path / "scene.py").write_text(SCENE.format(port=port))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        autopilot = Autopilot(port, 500)
        autopilot.start()
        while not autopilot.sensors:
            sim.step()
        first = len(autopilot.sensors)
        sim.step(300)
        received = len(autopilot.sensors)
        assert received - first >= 299, "no tick went on without an answer"
        # it stops to answer: the simulation goes on
        while autopilot.is_alive():
            sim.step()
        before = sim.clock.tick
        sim.step(5)
        assert sim.clock.tick == before + 5
        autopilot.join()
    times = [one.time_usec for one in autopilot.sensors]
    assert all(b - a == 4000 for a, b in pairwise(times[5:])), "250 Hz, the clock of PX4"
    for wanted in (ACCELERATION, RATES, FIELD, PRESSURE):
        assert all(one.fields_updated & wanted == wanted for one in autopilot.sensors[5:])
    last = autopilot.sensors[-1]
    # at the level of the sea in the standard atmosphere
    assert last.abs_pressure == pytest.approx(1013.25, abs=2.0)
    assert last.pressure_alt == pytest.approx(0.0, abs=10.0)
    assert last.temperature == pytest.approx(15.0, abs=1.0)
    fix = autopilot.fixes[-1]
    assert fix.fix_type == 3
    assert fix.eph < 300, "PX4 waits for less than 3 (EKF2_REQ_EPH)"
    assert fix.satellites_visible >= 6, "EKF2_REQ_NSATS"


FLIGHT = """
from morse.builder import *
robot = Quadrotor(); robot.translate(z=0.2)
imu = IMU(); robot.append(imu)
baro = Barometer(); robot.append(baro)
gps = GPS(); gps.level("raw"); robot.append(gps)
motors = QuadrotorDynamicControl(); motors.properties(Configuration="x"); robot.append(motors)
for part, rate in ((imu, 250), (baro, 50), (gps, 10)):
    part.add_stream("mavlink")
    part.frequency(rate)
motors.add_stream("mavlink", full=1200.0)
env = Environment("empty", fastmode=True)
env.simulator_frequency(250)
env.properties(longitude=8.5456, latitude=47.3977, altitude=488.0)
env.configure_stream_manager("mavlink", device="tcpin:127.0.0.1:{port}", hil=True, world="enu")
"""


@pytest.mark.peer("pymavlink", does="an estimator and a controller fly a quadrotor by HIL messages only")
def test_a_quadrotor_is_flown_by_what_hil_messages_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    port = free_port()
    (tmp_path / "scene.py").write_text(FLIGHT.format(port=port))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        body = sim.world.game_object("robot")
        start = [float(v) for v in body.world_pose()[0]]
        pilot = Controller(port, height=2.0, count=12 * 250)
        pilot.start()
        track = []
        while pilot.is_alive():
            sim.step()
            track.append([float(v) for v in body.world_pose()[0]])
        pilot.join()
    for x, y, z in track[9 * 250 :]:
        assert math.hypot(x - start[0], y - start[1]) < 0.5
        assert z - start[2] == pytest.approx(2.0, abs=0.25)
    # PX4 takes a sensor for broken whose values do not change by 1e-6 for 100 measurements, also on the ground
    for names in (("xacc", "yacc", "zacc"), ("xgyro", "ygyro", "zgyro"), ("xmag", "ymag", "zmag"), ("abs_pressure",)):
        bit = 1 << FIELDS.index(names[0])
        values = [[getattr(one, name) for name in names] for one in pilot.sensors if one.fields_updated & bit]
        same = [all(abs(p - q) < 1e-6 for p, q in zip(a, b, strict=True)) for a, b in pairwise(values)]
        assert not any(all(same[k : k + 3]) for k in range(len(same) - 3)), names
    # the truth that it has asked for, in the first tick of 4 ms that is 5 ms after the last one
    truth = pilot.states[-1]
    assert {b.time_usec - a.time_usec for a, b in pairwise(pilot.states)} == {8000}
    height = truth.alt * 1e-3 - pilot.states[0].alt * 1e-3
    # the simulation may go on for some ticks after the last message
    assert min(abs(height - (z - start[2])) for _, _, z in track[-250:]) < 0.02
    assert math.hypot(*truth.attitude_quaternion) == pytest.approx(1.0, abs=1e-5)
    acks = [one for one in pilot.others if one.get_type() == "COMMAND_ACK"]
    assert [(one.command, one.result) for one in acks] == [(511, 0)]


def test_a_motor_without_control_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    port = free_port()
    (tmp_path / "scene.py").write_text(SCENE.format(port=port))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
        motors = sim.context.component("robot.motors").local_data
        with socket.create_connection(("127.0.0.1", port)) as other:
            for control, speed in ((0.5, 400.0), (math.nan, 0.0)):
                other.sendall(mav.hil_actuator_controls_encode(0, [control] * 16, 129, 0).pack(mav))
                end = time.monotonic() + 60.0
                while motors["engines"] != [speed] * 4:
                    assert time.monotonic() < end
                    sim.step()
