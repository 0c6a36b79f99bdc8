"""Tells pages which saved files have errors, and which wait for a restart."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from morse.viewer.feeds.log import printable
from morse.viewer.view_messages import FileMistake, SavedFiles

if TYPE_CHECKING:
    from morse.simulation.watching.edits import Edits
    from morse.viewer.server import ViewServer


class EditsFeed:
    """Sends the state of the files that were saved."""

    def __init__(self, edits: Edits, server: ViewServer) -> None:
        self._edits = edits
        self._server = server
        self._last_message = SavedFiles([], [])

    def update(self) -> None:
        """Send it if it has changed."""
        mistakes = [
            FileMistake(PurePath(one.path).name, one.line, printable(one.text)) for one in self._edits.mistakes.values()
        ]
        message = SavedFiles(mistakes, [PurePath(path).name for path in self._edits.waiting])
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)
