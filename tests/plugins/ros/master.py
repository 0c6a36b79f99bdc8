"""A master of ROS 1, and other processes."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import urllib.request
import xmlrpc.client
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.kit.programs import free_port
from tests.kit.waiting import wait_until

#: directory of rospy in Debian
DEBIAN = "/usr/lib/python3/dist-packages"
_LIMIT = 60.0


def need_ros() -> None:
    """Skip the test if ROS 1 is not installed; in CI the test fails."""
    if shutil.which("rosmaster") is None or not Path(DEBIAN, "rospy").is_dir():
        reason = "ROS 1 is not installed: apt install python3-rospy python3-rosmaster"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(reason)


def environment(uri: str, *folders: Path) -> dict[str, str]:
    """Environment variables that append the packages of Debian, and other folders, to the path of this Python."""
    import morse

    paths = [*map(str, folders), str(Path(morse.__file__).parents[1]), sysconfig.get_path("purelib"), DEBIAN]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
        "ROS_MASTER_URI": uri,
        "ROS_IP": "127.0.0.1",
        "ROS_HOSTNAME": "127.0.0.1",
        "MORSE_SOCKET_PORT": "0",
    }


def _answers(uri: str) -> bool:
    call = xmlrpc.client.dumps(("test",), "getPid").encode()
    try:
        with urllib.request.urlopen(urllib.request.Request(uri, call), timeout=20.0) as reply:
            return reply.status == 200  # type: ignore[no-any-return]
    except OSError:
        return False


@contextmanager
def master(port: int | None = None) -> Iterator[str]:
    """Its address; on any free port, if none is given."""
    uri = f"http://127.0.0.1:{(port := port or free_port())}/"
    with tempfile.TemporaryDirectory() as home:
        variables = {**os.environ, "ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1", "ROS_LOG_DIR": home}
        variables.pop("PYTHONPATH", None)
        command = ["rosmaster", "--core", "-p", str(port)]
        quiet: Any = subprocess.DEVNULL
        with subprocess.Popen(command, env=variables, stdout=quiet, stderr=quiet) as process:
            try:
                end = time.monotonic() + _LIMIT
                while not _answers(uri):
                    assert process.poll() is None, "rosmaster has ended"
                    assert time.monotonic() < end, "rosmaster does not answer"
                    time.sleep(0.05)
                yield uri
            finally:
                process.terminate()


def run(script: Path, uri: str, *arguments: str, limit: float = 100.0, folders: tuple[Path, ...] = ()) -> str:
    """The last line of the output of a script."""
    done = subprocess.run(
        [sys.executable, str(script), *arguments],
        env=environment(uri, *folders), capture_output=True, text=True, timeout=limit, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout.splitlines()[-1]


@contextmanager
def simulation(scene: Path, uri: str, *options: str, folders: tuple[Path, ...] = ()) -> Iterator[Path]:
    """``morse run`` in a separate process; the path of its log file."""
    log = scene.with_suffix(".log")
    with log.open("w") as file:
        command = [sys.executable, "-m", "morse", "run", "--headless", *options, str(scene)]
        with subprocess.Popen(
            command, env=environment(uri, *folders), stdout=file, stderr=subprocess.STDOUT, cwd=scene.parent
        ) as process:
            try:
                wait_until(lambda: process.poll() is not None or "SCENE INITIALIZED" in log.read_text())
                assert process.poll() is None, log.read_text()
                yield log
                assert process.poll() is None, log.read_text()
            finally:
                process.terminate()
