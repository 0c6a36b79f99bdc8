"""The models that the page offers, with their pictures, which another process draws."""

from __future__ import annotations

import base64
import json
import queue
import subprocess
import threading
from typing import TYPE_CHECKING, Any

from morse.system.own_programs import command
from morse.viewer.view_messages import Model, ModelPicture, Models

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.viewer.server import ViewServer

_PROGRAM = "morse.launch.model_pictures"


class Catalog:
    """Lists models when a page asks for them first.

    Args:
        folders: of the models of the project.
        sources: folders of its packages.

    Attributes:
        groups: the group of each kind: ``robots``, ``sensors``, or another one for objects.
    """

    def __init__(self, server: ViewServer, folders: Sequence[str], sources: Sequence[str] = ()) -> None:
        self._server = server
        self._arguments = [json.dumps([*paths]) for paths in (folders, sources)]
        self._process: subprocess.Popen[bytes] | None = None
        self._lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self.groups: dict[str, str] = {}

    def open(self) -> None:
        """Start to list the models."""
        if self._process is not None:
            return
        self._process = subprocess.Popen(
            command(_PROGRAM, *self._arguments),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        threading.Thread(target=self._read, name="model pictures", daemon=True).start()

    def _read(self) -> None:
        assert self._process is not None
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line)
        self._process.wait()

    def update(self) -> None:
        """Send the pages what has been drawn."""
        while not self._lines.empty():
            self._take(json.loads(self._lines.get()))

    def _take(self, content: Any) -> None:
        if isinstance(content, list):
            models = [Model(one["kind"], one["name"], one["group"]) for one in content]
            self.groups = {model.kind: model.group for model in models}
            self._server.send(Models(models))
        else:
            url = self._server.offer("pictures", "image/webp", base64.b64decode(content["picture"]))
            self._server.send(ModelPicture(content["kind"], url))

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()
