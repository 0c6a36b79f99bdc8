"""The models that the page offers, with their pictures, which another process draws."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import json
import logging
import queue
import subprocess
import threading
from typing import IO, TYPE_CHECKING, Any

import msgspec

from morse.assets.cache import Cache
from morse.core.clients.complaints import Complaints
from morse.core.reports.quoting import short
from morse.system.workers import command
from morse.version import __version__
from morse.viewer.view_messages import Model, ModelPicture, Models, Refused

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.viewer.server import ViewServer

_PROGRAM = "morse.launch.model_pictures"
#: maximum number of bytes of a line that classes of the project print
_LONGEST_LINE = 400
#: largest list of models in the cache, bytes
_LARGEST_LIST = 4 << 20

#: the last list of each project: the process needs seconds for a new one, and longer on a busy machine
_cache = Cache("models", 50)

logger = logging.getLogger("morse.viewer")


class Catalog:
    """Lists models when a page asks for them first: at once as they were the last time, then as they are.

    What the classes of the project print in the other process is logged.

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
        self._printed = ""
        self._complaints = Complaints(logger)
        self.groups: dict[str, str] = {}
        self._listed: list[Model] = []
        self._is_complete = False
        self._key = hashlib.sha256(f"{__version__} {self._arguments}".encode()).hexdigest()
        self._uploaded: list[Model] = []

    def open(self) -> None:
        """Start to list the models, unless that has been done.

        Raises:
            OSError: the process cannot be started.
        """
        if self._process is not None and (self._is_complete or self._process.poll() is None):
            return
        with contextlib.suppress(msgspec.MsgspecError):
            if kept := _cache.get(self._key, _LARGEST_LIST):
                self._list(msgspec.json.decode(kept, type=list[Model]))
        self._process = process = subprocess.Popen(
            command(_PROGRAM, *self._arguments),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert process.stdout is not None
        assert process.stderr is not None
        for name, read in (("models", self._read), ("what models print", self._log)):
            stream = process.stdout if read == self._read else process.stderr
            threading.Thread(target=read, args=[process, stream], name=name, daemon=True).start()

    def _read(self, process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
        for line in stream:
            self._lines.put(line)
        if process.wait() > 0:
            self._lines.put(b"")

    def _log(self, process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
        while line := stream.readline(_LONGEST_LINE):
            if text := short(line.decode(errors="replace").rstrip(), _LONGEST_LINE):
                self._printed = text
                self._complaints.log(logging.INFO, text, f"the list of models: {text}")

    def update(self) -> None:
        """Send the pages what has been drawn."""
        while not self._lines.empty():
            line = self._lines.get()
            if line:
                content = json.loads(line)
                self._take(content)
                if isinstance(content, list):
                    _cache.put(self._key, msgspec.json.encode(self._listed))
            else:
                text = f"The list of models is not complete: its process has failed. {self._printed}".rstrip()
                self._complaints.warn("failed", text)
                self._server.send(Refused("list_models", text))

    def _take(self, content: Any) -> None:
        if isinstance(content, list):
            self._is_complete = True
            self._list([Model(**one) for one in content])
        elif "first" in content:
            if not self._listed:
                self._list([Model(**one) for one in content["first"]])
        else:
            url = self._server.offer("pictures", "image/webp", base64.b64decode(content["picture"]))
            self._server.send(ModelPicture(content["kind"], url))

    def _list(self, models: list[Model]) -> None:
        if models != self._listed:
            self._listed = models
            self._tell()

    def add(self, models: Sequence[Model]) -> None:
        """Add models that a page has sent."""
        self._uploaded += [model for model in models if model not in self._uploaded]
        self._tell()

    def _tell(self) -> None:
        models = [*self._uploaded, *self._listed]
        self.groups = {model.kind: model.group for model in models}
        self._server.send(Models(models))

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()
