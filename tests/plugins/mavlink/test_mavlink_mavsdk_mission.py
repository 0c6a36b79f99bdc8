"""The page on MAVLink with MAVSDK and its default settings: it arms, takes off, flies a square, returns and lands."""

import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

import morse

DOCS = Path(__file__).parents[3] / "docs"
LIMIT = 240.0

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("mavsdk") is None, reason="there is no mavsdk, which has 109 MB: pip install mavsdk"),
]


def blocks() -> list[str]:
    page = (DOCS / "mavlink.md").read_text(encoding="utf-8")
    return [block.partition("```")[0] for block in page.split("```python\n")[1:]]


@pytest.mark.parametrize("robot", ["Quadrotor", "ATRV"])
@pytest.mark.peer("mavsdk", does="arms, takes off, flies a square mission, returns and lands; drives one on wheels")
def test_the_program_of_the_page(robot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    scene = next(block for block in blocks() if f"{robot}()" in block)
    program = next(block for block in blocks() if "from mavsdk" in block)
    if robot == "ATRV":
        # without takeoff, and disarmed when it is at home
        program = program.replace("action.takeoff()\n", "").replace(
            "relative_altitude_m < 2.0", "absolute_altitude_m < 0.0"
        )
        program = program.replace("while telemetry.armed():", "while not mission.is_mission_finished():")
    (tmp_path / "default.py").write_text(scene)
    (tmp_path / "client.py").write_text(program)
    with (
        morse.load(tmp_path / "default.py", sockets=True) as sim,
        tempfile.TemporaryFile("w+") as said,
        subprocess.Popen([sys.executable, str(tmp_path / "client.py")], stdout=said, stderr=said) as other,
    ):
        end = time.monotonic() + LIMIT
        track = []
        while other.poll() is None and time.monotonic() < end:
            sim.step()
            track.append(tuple(map(float, next(iter(sim.context.robots.values())).bge_object.world_pose()[0])))
            time.sleep(0.004)
        other.kill()
        said.seek(0)
        text = said.read()
    assert "landed" in text, text[-2000:]
    # the world points north along X: a square of 8 m to the north and to the east, 5 m above home
    assert max(x for x, _, _ in track) == pytest.approx(8.0, abs=1.5)
    assert min(y for _, y, _ in track) == pytest.approx(-8.0, abs=1.5)
    assert max(z for _, _, z in track) < 12.0
    if robot == "Quadrotor":
        assert max(z for _, _, z in track) > 4.5
        assert track[-1] == pytest.approx((0.0, 0.0, 0.2), abs=0.6)
