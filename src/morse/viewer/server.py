"""The interface of the simulation to the server of the live view."""

from __future__ import annotations

import logging
import socket
import threading
import time
from collections import deque
from typing import TYPE_CHECKING
from urllib.parse import quote

from morse.core.clients.web_access import Access, is_loopback
from morse.system import OF_MACHINE
from morse.viewer.describe import describe, world_key
from morse.viewer.hub import Hub, Wishes
from morse.viewer.page_messages import Drag, DragEnd
from morse.viewer.protocol import encode_json, encode_server_message
from morse.viewer.site import AssetStore, File
from morse.viewer.snapshot import pack_snapshot
from morse.viewer.view_messages import Answer, World

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence, Set

    from morse.core.clients.network import Network
    from morse.scene import Scene
    from morse.viewer.page_messages import ViewEvent
    from morse.viewer.snapshot import MovingNode, Snapshot
    from morse.viewer.view_messages import ServerMessage, Subject

logger = logging.getLogger("morse.viewer")

_SHORTEST_INTERVAL = 1.0 / 125.0
"""Minimum wall-clock seconds between two snapshots: no screen shows more."""
#: number of descriptions of the world that are kept, for pages that still fetch an earlier one
_DESCRIPTIONS = 8


class ViewServer:
    """Shows the simulation to any number of pages, and receives the requests of the driving page.

    The methods are called in the simulation thread and never wait for a page; all connections are in the network
    thread.
    """

    def __init__(
        self,
        network: Network,
        *,
        host: str = "127.0.0.1",
        port: int = 8765,
        token: str | None = None,
        title: str = "MORSE",
        origins: Sequence[str] = (),
    ) -> None:
        """Create the server without opening it; see `start`.

        Args:
            network: its thread.
            host: address to bind to.
            port: TCP port; if it is in use, the next free one; 0 for any.
            token: token that a page must present. One is generated if other machines can reach ``host``.
            title: title of the page.
            origins: origins of other web pages that may show the page in a frame, and drive; see
                `morse.core.clients.web_access.checked_origin`.
        """
        self._network = network
        self._host = host
        self._port = self._served_on = port
        self._hub = Hub(Access(host, token, origins=origins), title, network.arrivals)
        self._asset_store = AssetStore()
        self._revision = 0
        self._key: str | None = None
        self._moving = 0
        self._last_shown = 0.0
        self._last_status = ""
        self._dragging = False
        self._lock = threading.Lock()
        self._messages: deque[tuple[Subject | None, str | bytes, bool]] = deque()
        self._poses: bytes | None = None
        self._is_waiting = False

    def start(self) -> str:
        """Open the server and return the address to open in a browser, with the token if there is one.

        Raises:
            OSError: the address cannot be bound; the message suggests a solution.
        """
        try:
            port = self._served_on = self._network.call(self._hub.open(self._host, _ports(self._port)))
        except OSError as error:
            raise OSError(
                f"The live view cannot be served on {self._host}, port {self._port}: {error}. "
                "Choose others with --host and --view-port, or do without it with --view none."
            ) from error
        host = self._host if is_loopback(self._host) else _name_of_this_machine(self._host)
        address = f"[{host}]" if ":" in host else host
        token = self._hub.access.token
        if self._port not in (0, port):
            logger.warning("port %d is in use: the live view is served on port %d", self._port, port, extra=OF_MACHINE)
        return f"http://{address}:{port}/" + (f"?token={quote(token, safe='')}" if token else "")

    @property
    def address(self) -> tuple[int, str | None]:
        """TCP port, and the token that a page must present, if there is one."""
        return self._served_on, self._hub.access.token

    def stop(self) -> None:
        """Tell the pages that the simulation has ended, and close the server."""
        self._network.call(self._hub.close())

    # data for pages ------------------------------------------------------------------------------

    @property
    def watched(self) -> bool:
        """Whether any page is connected; without one, snapshots are not needed."""
        return self._hub.watched

    @property
    def drawn(self) -> bool:
        """Whether any page has drawn the world."""
        return self._hub.drawn

    @property
    def wishes(self) -> Wishes:
        """The data, overlays and images that the pages show now: nothing else need be sent."""
        return self._hub.wishes

    def set_scene(self, scene: Scene, moving: Sequence[MovingNode]) -> None:
        """Describe the world; call it again when nodes are added, removed or reparented.

        Args:
            scene: the present scene.
            moving: the nodes whose poses the snapshots contain, in that order.

        Raises:
            KeyError: a moving node is not in the scene.
        """
        self._revision += 1
        if self._key is None:  # the key contains the script's camera, which services may move
            self._key = world_key(scene)
        description = encode_json(describe(scene, moving, self._revision, self._asset_store, self._key))
        url = f"/worlds/{self._revision}.json"
        files = {path: File(mime, data, lasting=True) for path, (mime, data) in self._asset_store.take_new().items()}
        files[url] = File("application/json", description, lasting=False)
        self._moving = len(moving)
        self._network.post(self._hub.site.files.update, files)
        # each spawned object makes a new description
        self._network.post(self._hub.site.files.pop, f"/worlds/{self._revision - _DESCRIPTIONS}.json", None)
        self.send(World(self._revision, url))

    def offer(self, folder: str, mime: str, data: bytes) -> str:
        """Add a file for pages, and return its address.

        Args:
            folder: the first part of the address.
            mime: content type.
            data: content.
        """
        file = File(mime, data, lasting=True)
        digest = file.tag.strip('"')
        url = f"/{folder}/{digest}"
        self._network.post(self._hub.site.files.update, {url: file})
        return url

    def publish(self, snapshot: Snapshot) -> None:
        """Show a snapshot: each page receives the newest one as soon as it can.

        Raises:
            ValueError: it does not have one pose for each moving node.
        """
        if len(snapshot.poses) != self._moving:
            raise ValueError(f"the snapshot has {len(snapshot.poses)} poses, the scene {self._moving} moving nodes")
        now = time.monotonic()
        is_early = snapshot.status == "running" == self._last_status and now - self._last_shown < _SHORTEST_INTERVAL
        if is_early or not self._hub.watched:
            return
        self._last_shown, self._last_status = now, snapshot.status
        self._poses = pack_snapshot(snapshot, self._revision)
        self._post()

    def send(self, message: ServerMessage) -> None:
        """Send a message to the pages; a lasting message is also sent to pages that connect later.

        An answer is sent to the page of the request.
        """
        if isinstance(message, Answer):
            self._network.post(self._hub.answer, message)
        elif message.lasting or self._hub.watched:
            self._messages.append((message.subject(), encode_server_message(message), message.lasting))
            self._post()

    def forget(self, names: Set[str]) -> None:
        """Components exist no longer: pages that connect later hear nothing of them."""
        self._network.post(self._hub.forget, names)

    def _post(self) -> None:
        with self._lock:
            if self._is_waiting:
                return
            self._is_waiting = True
        self._network.post(self._flush)

    def _flush(self) -> None:
        with self._lock:
            self._is_waiting = False
        while self._messages:
            subject, frame, lasting = self._messages.popleft()
            self._hub.broadcast(subject, frame, lasting=lasting)
        poses, self._poses = self._poses, None
        if poses is not None:
            self._hub.show(poses)

    # requests of the driving page ----------------------------------------------------------------

    def take_events(self) -> list[ViewEvent]:
        """The requests of the driving page since the last call, oldest first; call it at the start of a tick."""
        self._hub.control_lock.begin_tick()
        events = []
        while self._hub.events:
            events.append(self._hub.events.popleft())
        for event in events:
            if isinstance(event, Drag | DragEnd):
                self._dragging = isinstance(event, Drag)
        if self._dragging and not self._hub.control_lock.alive:
            self._dragging = False
            events.append(DragEnd())
        return events

    def put_back(self, events: Sequence[ViewEvent]) -> None:
        """Return the last ones of the taken requests, because the tick has no more time for them."""
        self._hub.events.extendleft(reversed(events))

    def held_keys(self) -> frozenset[str]:
        """Pressed keys (``KeyboardEvent.code``) of the driving page; none if it is hidden, silent or disconnected.

        A key that was pressed and released between two ticks counts as pressed for one tick.
        """
        return self._hub.control_lock.held_keys()

    def gamepad(self) -> tuple[tuple[float, ...], tuple[bool, ...]]:
        """Axes (-1..1, right and down positive) and buttons of the driving page's gamepad; empty without one."""
        return self._hub.control_lock.gamepad()


def _ports(first: int) -> Iterator[int]:
    if first:
        yield from range(first, min(first + 100, 65536))
    yield 0


def _name_of_this_machine(host: str) -> str:
    return socket.gethostname() if host in ("0.0.0.0", "::", "") else host
