"""A master that is started again knows the topics of a running simulation."""

import subprocess
import sys
from pathlib import Path

from master import environment, master, need_ros

from tests.kit.programs import free_port


def test_a_new_master_knows_the_topics() -> None:
    need_ros()
    port = free_port()
    with master(port) as uri:
        peer = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("node_peer.py"))],
            env=environment(uri), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert peer.stdout is not None
        assert peer.stdout.readline() == "ready\n"
    with peer, master(port):
        try:
            out, log = peer.communicate("go\n", timeout=100.0)
        finally:
            peer.kill()
    assert out == "True True\n", log
    assert "was started again" in log
