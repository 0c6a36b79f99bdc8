"""Files of the user are not damaged: several commands at once, closed streams, full disks."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from morse.simulation.ticks.profile import Profile

pytestmark = pytest.mark.long

FULL = Path("/dev/full")
RUN = f"{sys.executable} -m morse run --headless --speed max --duration 0.1"
SCENE = "from morse.builder import *\nrobot = FakeRobot()\nenv = Environment('empty', fastmode=True)\n"
#: what is buffered is written at the end of the process
BOTH = pytest.mark.parametrize("buffered", [{}, {"PYTHONUNBUFFERED": "1"}], ids=["buffered", "unbuffered"])


@pytest.fixture
def shell(tmp_path):
    """Runs a line of shell in a folder with a scene."""
    (tmp_path / "scene.py").write_text(SCENE)
    environment = {**os.environ, "HOME": str(tmp_path), "MORSE_SOCKET_PORT": "0"}

    def run(line, **variables):
        return subprocess.run(
            ["sh", "-c", line],
            cwd=tmp_path,
            env={**environment, **variables},
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )

    return run


def test_environments_made_at_the_same_time_are_all_registered(tmp_path):
    environment = {**os.environ, "HOME": str(tmp_path)}
    names = [f"sim_{letter}" for letter in "abcdefgh"]
    started = [
        subprocess.Popen([sys.executable, "-m", "morse", "create", name], cwd=tmp_path, env=environment,
                         stdout=subprocess.DEVNULL)
        for name in names
    ]  # fmt: skip
    assert [process.wait(timeout=100) for process in started] == [0] * len(names)
    config = (tmp_path / ".morse" / "config").read_text()
    assert sorted(re.findall(r"^sim_\w", config, re.MULTILINE)) == names
    assert sorted(path.name for path in (tmp_path / ".morse").iterdir()) == ["config", "config.lock"]


@pytest.mark.parametrize("redirection", [">&-", ">&- 2>&-", "<&-", "<&- >&- 2>&-"])
def test_closed_streams_stop_no_run(shell, redirection):
    done = shell(f"{RUN} scene.py {redirection}")
    assert done.returncode == 0, done.stdout + done.stderr
    if redirection == ">&-":
        assert done.stderr == "* The standard output is closed: the log of the simulation is lost.\n"


@pytest.mark.skipif(not FULL.exists(), reason="the disk that is always full is Linux'")
@BOTH
def test_a_full_disk_for_the_log_is_said_once(shell, buffered):
    done = shell(f"{RUN} scene.py > {FULL}", **buffered)
    assert done.returncode == 0
    assert done.stderr == "* the log can no longer be written: No space left on device\n"


@pytest.mark.skipif(not FULL.exists(), reason="the disk that is always full is Linux'")
@BOTH
def test_a_list_that_cannot_be_written_is_an_error(shell, buffered):
    done = shell(f"{sys.executable} -m morse demo > {FULL}", **buffered)
    assert done.returncode == 1
    assert "No space left on device" in done.stderr
    assert "Exception" not in done.stderr
    assert "Traceback" not in done.stderr


@BOTH
def test_a_reader_that_leaves_is_no_error(shell, buffered):
    done = shell(f"{RUN} scene.py | head -1", **buffered)
    assert done.stderr == ""


def test_a_profile_that_cannot_be_written_is_a_message_after_a_good_run(shell, tmp_path):
    # a folder in place of the file cannot be written even by root
    (tmp_path / "morse-profile.json").mkdir()
    done = shell(f"{RUN} --profile scene.py")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    assert f"the profile cannot be written to {tmp_path / 'morse-profile.json'}" in done.stdout
    assert sorted(path.name for path in tmp_path.iterdir() if "profile" in path.name) == ["morse-profile.json"]


@pytest.mark.skipif(sys.platform == "win32", reason="there is no limit of the size of files")
def test_a_profile_is_whole_or_not_there(tmp_path):
    import resource

    path = tmp_path / "trace.json"
    path.write_text("before")
    profile = Profile(trace=True)
    profile.begin()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, limits[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            profile.write_trace(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert [(found.name, found.read_text()) for found in tmp_path.iterdir()] == [("trace.json", "before")]
    profile.write_trace(path)
    assert json.loads(path.read_text())["traceEvents"]
