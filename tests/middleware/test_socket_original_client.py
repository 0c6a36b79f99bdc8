"""The original client of MORSE 1.4 from PyPI with this server."""

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from socket_bench import Bench
from test_socket_pymorse import DETAILS

pytestmark = pytest.mark.soak

SESSION = """
import sys, warnings
warnings.simplefilter("ignore")
import pymorse
simu = pymorse.Morse("127.0.0.1", int(sys.argv[1]))
try:
    assert simu.robots == ["robot1"]
    assert simu.streams() == ["robot1.pose", "robot1.motion"]
    assert simu.robot1.pose.get(timeout=60)["temperature"] == 20.5
    seen = []
    simu.robot1.pose.subscribe(seen.append)
    simu.robot1.motion.publish({"v": 1.5})
    assert simu.robot1.motion.echo("a").result() == "a"
    assert simu.robot1.motion.nothing().result() is None
    going = simu.robot1.motion.goto(1, 2, 3)
    # it sends the request from another thread, and the cancellation at once
    while simu.rpc("robot1.motion", "running") != "goto":
        pass
    going.cancel()
    try:
        going.result(60)
        raise AssertionError("not cancelled")
    except pymorse.MorseServicePreempted:
        pass
    try:
        simu.robot1.motion.goto(1).result()
        raise AssertionError("one argument is too few")
    except TypeError:
        pass
    try:
        simu.rpc("robot1.motion", "refuse")
        raise AssertionError("not refused")
    except pymorse.MorseServiceFailed:
        pass
    simu.robot1.pose.get(timeout=60)
    assert seen
finally:
    simu.close(wait_publishers=False)  # its close() fails on Python 3.8 and later
print("done")
"""


@pytest.fixture
def original(tmp_path: Path) -> Path:
    target = tmp_path / "original"
    packages = ["pymorse==1.4", *(["pyasyncore", "pyasynchat"] if sys.version_info >= (3, 12) else [])]
    install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(target), *packages]
    done = subprocess.run(install, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"PyPI cannot be reached: {done.stderr.strip()[-200:]}")
    return target


@pytest.fixture
def ticking() -> Iterator[Bench]:
    bench = Bench()
    bench.sensor("robot1.pose", port=0)
    bench.actuator("robot1.motion", port=0)
    bench.requests.register_service("simulation", lambda: DETAILS, "details")
    bench.requests.register_service("robot1.motion", lambda: bench.arm.running_service, "running")
    pause = threading.Event()

    def run() -> None:
        while not bench.stopping:
            bench.tick()
            pause.wait(0.005)

    thread = threading.Thread(target=run)
    thread.start()
    yield bench
    bench.stopping = True
    thread.join(60)
    bench.close()


@pytest.mark.peer("pymorse==1.4", does="the client of MORSE 1.4: sensors, commands, services, cancelled calls")
def test_a_session(original: Path, ticking: Bench) -> None:
    words = [sys.executable, "-c", SESSION, str(ticking.requests.port)]
    environment = {**os.environ, "PYTHONPATH": str(original)}
    ran = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=30, check=False)
    assert (ran.returncode, ran.stdout) == (0, "done\n"), ran.stderr
    assert ticking.components[1].local_data["v"] == 1.5
