"""MAVLink with MAVSDK, an implementation independent of pymavlink."""

import json
import math
import socket
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

import morse

HERE = Path(__file__).parent
LIMIT = 90.0
SCENE = """
from morse.builder import *
robot = Quadrotor(); robot.translate(1.0, 2.0, 5.0); robot.rotate(z=0.5)
attitude = Attitude(); robot.append(attitude)
odometry = Odometry(); robot.append(odometry)
battery = Battery(); robot.append(battery)
gps = GPS(); gps.level("raw"); robot.append(gps)
robot.add_default_interface("mavlink")
env = Environment("empty")
env.properties(longitude=1.4, latitude=43.6, altitude=135.0)
env.configure_stream_manager("mavlink", device="udpout:127.0.0.1:{port}", vehicle=2, world="enu")
"""


@pytest.mark.slow
@pytest.mark.skipif(find_spec("mavsdk") is None, reason="there is no mavsdk, which has 109 MB: pip install mavsdk")
@pytest.mark.peer("mavsdk", does="connects and reads attitude, positions, battery and fix")
def test_mavsdk_knows_the_vehicle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    (tmp_path / "scene.py").write_text(SCENE.format(port=port))
    with (
        morse.load(tmp_path / "scene.py", sockets=True) as sim,
        tempfile.TemporaryFile("w+") as said,
        tempfile.TemporaryFile("w+") as complaints,
        subprocess.Popen(
            [sys.executable, str(HERE / "mavsdk_peer.py"), str(port)], stdout=said, stderr=complaints
        ) as other,
    ):
        end = time.monotonic() + LIMIT
        while other.poll() is None and time.monotonic() < end:
            sim.step()
            time.sleep(0.005)
        other.kill()
        said.seek(0)
        complaints.seek(0)
        assert other.returncode == 0, complaints.read()
        seen = json.loads(said.read().splitlines()[-1])
    # X points east: half a radian to the left of it is 61.35 degrees from north
    assert seen["yaw"] == pytest.approx(90.0 - math.degrees(0.5), abs=0.5)
    assert seen["down"] > 0.0, "it falls: it has no actuator"
    assert seen["gps"][:2] == pytest.approx([43.6 + 2.0 / 111_100.0, 1.4 + 1.0 / 80_700.0], abs=2e-6)
    assert 135.0 <= seen["gps"][2] <= 141.0
    assert 0.0 < seen["battery"] <= 100.0
