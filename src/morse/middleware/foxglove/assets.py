"""Files that descriptions of robots refer to, for clients without these packages."""

from __future__ import annotations

import asyncio
import os
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from morse.core.reports.quoting import short
from morse.middleware.foxglove import frames
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.middleware.web.client import WebClient
    from morse.scene.articulation import Articulation

#: what meshes refer to
_BESIDE = frozenset((".bin", ".bmp", ".jpeg", ".jpg", ".mtl", ".png", ".tga", ".tif", ".tiff", ".webp"))
LARGEST = 16 << 20
"""Maximum size of a file, bytes: what a client may leave behind is limited."""
#: between two looks at what a client has read, s
_PAUSE = 0.02


class Assets:
    """Sends files to a client, one after the other: one that waits for many must not exceed its memory.

    All functions run in the network thread; another thread reads the files.
    """

    def __init__(self, client: WebClient) -> None:
        self._client = client
        self._requests: deque[tuple[str, int, Sequence[Articulation]]] = deque()
        self._task: asyncio.Task[None] | None = None

    def fetch(self, uri: str, request: int, robots: Sequence[Articulation]) -> None:
        """Send the file of a mesh or a texture, or the reason why there is none.

        Raises:
            OverBudget: the client waits for too many.
        """
        self._client.keep(len(uri), "a request for a file")
        self._requests.append((uri, request, robots))
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._send())

    def close(self) -> None:
        """Send nothing more."""
        self._requests.clear()
        if self._task is not None:
            self._task.cancel()

    async def _send(self) -> None:
        while self._requests:
            uri, request, robots = self._requests.popleft()
            try:
                data, error = await asyncio.to_thread(read_asset, uri, robots), ""
            except ValueError as failure:
                data, error = b"", str(failure)
            self._client.release(len(uri))
            while self._client.is_behind and self._client.memory.left < len(data):
                await asyncio.sleep(_PAUSE)
            self._client.tell(frames.asset(request, error, data))


def read_asset(uri: str, robots: Iterable[Articulation]) -> bytes:
    """The content of a file: a mesh in the description of a robot, or a texture in the package of such a mesh.

    Args:
        uri: ``package://...`` or ``file://...``.
        robots: with the files of their meshes.

    Raises:
        ValueError: no description refers to it, or it cannot be read.
    """
    for robot in robots:
        for mesh, file in robot.meshes:
            path = file if uri == mesh else _beside(uri, mesh, file)
            if path:
                return _read(uri, Path(path))
    raise ValueError(f"no robot_description refers to {short(uri)}")


def _read(uri: str, path: Path) -> bytes:
    try:
        return read_regular(path, LARGEST)
    except OSError as error:
        raise ValueError(f"{short(uri)}: {error.strerror}") from None


def _beside(uri: str, mesh: str, file: str) -> str:
    """The file of a texture in the package or the folder of a mesh; empty if it is elsewhere."""
    is_package = mesh.startswith("package://")
    root = "/".join(mesh.split("/", 3)[:3]) + "/" if is_package else mesh.rpartition("/")[0] + "/"
    folder = file.removesuffix(mesh[len(root) :])
    if uri[uri.rfind(".") :].lower() not in _BESIDE or not uri.startswith(root) or folder == file:
        return ""
    path = os.path.realpath(os.path.join(folder, unquote(uri[len(root) :])))
    return path if path.startswith(os.path.realpath(folder) + os.sep) else ""
