"""Test cases with a ROS 1 master."""

from __future__ import annotations

import os
from urllib.parse import urlsplit

from morse.testing.process import Daemon
from morse.testing.testcase import MorseTestCase

_PORT = 11311


class RosTestCase(MorseTestCase):
    """Runs ``roscore`` during each test, unless a master already runs on this machine.

    The port of the master is taken from the environment variable ``ROS_MASTER_URI``; the default is 11311.
    """

    def setUpMw(self) -> None:  # noqa: N802
        """Start ``roscore``, and wait until it listens.

        Raises:
            MorseTestingError: ``roscore`` is not installed, or does not start.
        """
        port = urlsplit(os.environ.get("ROS_MASTER_URI", "")).port or _PORT
        daemon = Daemon(
            ["roscore", "-p", str(port)], port, "install ROS 1 and source its setup.bash before you run the test"
        )
        self.addCleanup(daemon.stop)
