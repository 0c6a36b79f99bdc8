"""Test cases with a MOOS database."""

from __future__ import annotations

from morse.testing.process import Daemon
from morse.testing.testcase import MorseTestCase


class MOOSTestCase(MorseTestCase):
    """Runs ``MOOSDB`` during each test, unless a database already runs on this machine.

    Attributes:
        moos_port: port of the database.
    """

    moos_port = 9000

    def setUpMw(self) -> None:  # noqa: N802
        """Start ``MOOSDB``, and wait until it listens.

        Raises:
            MorseTestingError: ``MOOSDB`` is not installed, or does not start.
        """
        daemon = Daemon(
            ["MOOSDB", f"--moos_port={self.moos_port}"],
            self.moos_port,
            "install MOOS (core-moos) and put its programs on the PATH before you run the test",
        )
        self.addCleanup(daemon.stop)
