"""The page "A middleware of your own": its files are written as they stand there, and its client commands the robot."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from doc_pages import DOCS

from tests.kit.programs import python

PAGE = (DOCS / "middleware.md").read_text()
_FILE = re.compile(r"^```(?:python|toml)\n# (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILES: dict[str, str] = dict(_FILE.findall(PAGE))
#: runs the scene until the client has had its packet, and sends some packets that are wrong
RUN = """
import socket, subprocess, sys, time
import morse
wrong = [b"robot.motion {", b'robot.motion {"v": "fast"}', b"nobody {}", b"\\xff\\xfe", b'robot.motion {"v": NaN}']
with morse.load("scene.py", sockets=True) as simulation:
    client = subprocess.Popen([sys.executable, "client.py"], stdout=subprocess.PIPE, text=True)
    motion = simulation.context.components["robot.motion"]
    limit = time.monotonic() + 60
    while motion.local_data["v"] != 1.0 or client.poll() is None:
        assert time.monotonic() < limit
        simulation.step()
        time.sleep(0.001)
    print(client.stdout.read().strip())
    before = simulation.context.robots["robot"].bge_object.worldPosition.x
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for packet in wrong:
        other.sendto(packet, ("127.0.0.1", 7100))
    simulation.step(12)
    print(motion.local_data["v"], simulation.context.robots["robot"].bge_object.worldPosition.x - before)
    simulation.step(60)
    print(motion.local_data["v"], len(simulation.context.stream_managers))
"""


def test_the_page_is_a_middleware(tmp_path: Path) -> None:
    entries = tomllib.loads(FILES["pyproject.toml"])["project"]["entry-points"]["morse.middlewares"]
    points = "".join(f"{name} = {value}\n" for name, value in entries.items())
    more = {
        "my_lab/__init__.py": "",
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": f"[morse.middlewares]\n{points}",
        "run.py": RUN,
    }
    for path, text in {**FILES, **more}.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    run = python("run.py", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    packet, driven, ended = run.stdout.splitlines()
    assert re.match(r'robot\.pose \{"timestamp": [0-9.]+, "x": ', packet)
    speed, way = map(float, driven.split())
    assert speed == 1.0, "wrong packets change nothing"
    assert abs(way - 12 / 60) < 0.02, "12 ticks at 1 m/s"
    assert ended == "0.0 1", "after its timeout the command has ended, and the middleware is still there"
    for text in ("cannot be read", "'v' is 'fast', expected", "'v' is nan, expected"):
        assert text in run.stderr


def test_its_test_passes_in_a_project(tmp_path: Path) -> None:
    files = {
        **{f"src/{name}": text for name, text in FILES.items() if name.startswith("my_lab/")},
        "src/my_lab/__init__.py": "",
        "tests/test_udp.py": FILES["tests/test_udp.py"],
        "conftest.py": 'pytest_plugins = ["morse.testing.fixtures"]\n',
        "pyproject.toml": FILES["pyproject.toml"] + '\n[tool.pytest.ini_options]\npythonpath = ["src"]\n',
    }
    for path, text in files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == 0, run.stdout
    assert "1 passed" in run.stdout


def test_it_is_short() -> None:
    code = [line for line in FILES["my_lab/udp.py"].splitlines() if line.strip()]
    assert len(code) + 1 <= 50
