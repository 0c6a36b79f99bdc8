"""SECURITY.md promises what tests prove."""

import ast
import ipaddress
import os
import re
import socket
import struct
import sys
from pathlib import Path

import pytest
from doc_pages import ROOT

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose

PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
PROMISES = [
    [cell.strip() for cell in row.strip("|").split(" | ")]
    for row in PAGE.partition("## What MORSE promises")[2].partition("\n## ")[0].splitlines()
    if row.startswith("| ") and not row.startswith("| promise")
]


@pytest.mark.parametrize(("promise", "tests"), PROMISES, ids=[promise[:50] for promise, _ in PROMISES])
def test_each_promise_names_tests_that_exist(promise: str, tests: str):
    names = re.findall(r"`([\w/]+\.py)::(\w+)`", tests)
    assert names, promise
    assert re.sub(r"`[^`]*`|[, ]", "", tests) == "", "nothing but tests"
    for file, name in names:
        tree = ast.parse((ROOT / "tests" / file).read_text(encoding="utf-8"))
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}
        assert name in functions, f"there is no {file}::{name}"
        marks = ast.unparse(ast.List(functions[name].decorator_list, ast.Load()))
        assert not re.search(r"mark\.(skip\b|xfail)", marks), f"{file}::{name} proves nothing"


def test_what_is_not_covered_is_said():
    section = PAGE.partition("## What is not covered\n")[2].partition("\n## ")[0]
    assert section.count("\n- ") >= 5


def listening() -> list[tuple[str, int]]:
    """The addresses on which this process accepts connections."""
    own = set(map(_link, Path("/proc/self/fd").iterdir()))
    found = []
    for name in ("tcp", "tcp6"):
        for line in Path(f"/proc/self/net/{name}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in own:
                address, port = words[1].split(":")
                found.append((_address(address), int(port, 16)))
    return found


def _link(path: Path) -> str:
    try:
        return os.readlink(path)
    except OSError:
        return ""  # it has been closed


def _address(text: str) -> str:
    numbers = struct.pack(f"={len(text) // 8}I", *(int(text[at : at + 8], 16) for at in range(0, len(text), 8)))
    return socket.inet_ntop(socket.AF_INET if len(numbers) == 4 else socket.AF_INET6, numbers)


def _scene() -> None:
    robot = ATRV("robot")
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    for name in ("socket", "rosbridge", "foxglove"):
        robot.add_default_interface(name)
    env = Environment("empty", fastmode=True)
    env.configure_stream_manager("rosbridge", port=0)
    env.configure_stream_manager("foxglove", port=0)


@pytest.mark.skipif(sys.platform != "linux", reason="reads the tables of Linux")
def test_all_servers_listen_on_the_loopback_interface(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    before = listening()
    with morse.load(_scene, sockets=True) as simulation:
        simulation.step(1)
        opened = [address for address in listening() if address not in before]
    assert len(opened) >= 5, "services, two streams of the socket, rosbridge and Foxglove"
    assert all(ipaddress.ip_address(address).is_loopback for address, _ in opened), opened
