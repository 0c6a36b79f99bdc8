"""Every plugin of MAVSDK that asks a vehicle for something: it works, or it is refused by its code and at once."""

import json
import socket
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

pytest.importorskip("pymavlink")

import morse
from tests.kit.programs import free_port

PEER = Path(__file__).with_name("mavsdk_plugins_peer.py")
LIMIT = 280.0
REFUSED = {
    "action.reboot": "UNSUPPORTED", "action.shutdown": "UNSUPPORTED", "action.set_actuator": "UNSUPPORTED",
    "action.transition_to_fixedwing": "NO_VTOL_TRANSITION_SUPPORT", "action.do_orbit": "UNSUPPORTED",
    "calibration.gyro": "UNSUPPORTED", "calibration.accelerometer": "UNSUPPORTED",
    "calibration.magnetometer": "UNSUPPORTED", "calibration.level_horizon": "UNSUPPORTED",
    "calibration.gimbal_accelerometer": "UNSUPPORTED", "camera.start_video": "ACTION_UNSUPPORTED",
    "camera.start_video_streaming": "ACTION_UNSUPPORTED", "camera.zoom_in_start": "ACTION_UNSUPPORTED",
    "camera.track_point": "ACTION_UNSUPPORTED", "camera.focus_auto": "ACTION_UNSUPPORTED",
    "camera.reset_settings": "ACTION_UNSUPPORTED", "ftp.list_directory, none": "FILE_DOES_NOT_EXIST",
    "ftp.create_directory": "FILE_PROTECTED", "ftp.remove_file": "FILE_PROTECTED", "ftp.rename": "FILE_PROTECTED",
    "ftp.upload": "FILE_PROTECTED", "log_files.get_entries": "NO_LOGFILES", "log_streaming.start": "UNSUPPORTED",
    "failure.inject": "UNSUPPORTED", "winch.hold": "UNSUPPORTED", "gripper.grab": "UNSUPPORTED",
    # MAVSDK has no other code for a rate that is refused
    "transponder.set_rate": "UNKNOWN", "param.get_param_float, none": "DOES_NOT_EXIST",
    "mission_raw.upload_rally_points": "UNSUPPORTED", "telemetry.set_rate_distance_sensor": "UNSUPPORTED",
    # it waits for the place that it has asked for, and that of the scene stays
    "action.set_gps_global_origin": "TIMEOUT",
    "photo, burst False": "ffd8ff", "photo, burst True": "ffd8ff", "shell": "SAID",
    "param.set_param_float, too large": "VALUE_OUT_OF_RANGE",
}  # fmt: skip

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("mavsdk") is None, reason="there is no mavsdk, which has 109 MB: pip install mavsdk"),
]


@pytest.mark.peer("mavsdk", does="calls of 20 plugins work or are refused by their codes; takes and downloads photos")
def test_each_plugin_has_an_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    port = free_port(socket.SOCK_DGRAM)
    (tmp_path / "default.py").write_text(
        "from morse.builder import *\nrobot = Quadrotor()\nrobot.translate(z=0.2)\n"
        "goal = RotorcraftWaypoint()\nrobot.append(goal)\n"
        "eye = VideoCamera()\neye.properties(cam_width=64, cam_height=48)\nrobot.append(eye)\n"
        "head = PTU()\nrobot.append(head)\nrobot.add_default_interface('mavlink')\nenv = Environment('empty')\n"
        f"env.configure_stream_manager('mavlink', device='udpout:127.0.0.1:{port}')\n"
    )
    with (
        morse.load(tmp_path / "default.py", sockets=True) as sim,
        tempfile.TemporaryFile("w+") as said,
        subprocess.Popen([sys.executable, str(PEER), str(port)], stdout=said, stderr=said) as other,
    ):
        end = time.monotonic() + LIMIT
        while other.poll() is None and time.monotonic() < end:
            sim.step()
            time.sleep(0.004)
        other.kill()
        said.seek(0)
        text = said.read()
    lines = [line for line in text.splitlines() if line.startswith("{")]
    assert lines, text[-3000:]
    results = json.loads(lines[-1])
    unlike = {name: code for name, (code, _) in results.items() if code != REFUSED.get(name, "SUCCESS")}
    assert not unlike, (unlike, text[-6000:])
    assert results.keys() >= REFUSED.keys()
