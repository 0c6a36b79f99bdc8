"""The connections of the live view, in the network thread."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from websockets.asyncio.server import broadcast
from websockets.exceptions import ConnectionClosed

from morse.core.clients.acceptors import StreamAcceptor
from morse.core.clients.budgets import ENTRY, PARSED, OverBudget
from morse.core.clients.complaints import Complaints
from morse.core.clients.web_connection import NO_PLACE, sender_of, serve_on
from morse.core.reports.faults import describe
from morse.viewer import page_messages as pm
from morse.viewer.page import MOST_REQUESTS, ControlLock, Page, PageLeft, Requests
from morse.viewer.protocol import MAX_MESSAGE, VERSION, Close, NotUnderstood, decode_page_message, encode_server_message
from morse.viewer.site import Site, refuse
from morse.viewer.view_messages import OF_COMPONENTS, Answer, Refused, Welcome

if TYPE_CHECKING:
    from collections.abc import Iterable, Set

    from websockets.asyncio.server import Server, ServerConnection
    from websockets.http11 import Request, Response

    from morse.core.clients.budgets import Arrivals
    from morse.core.clients.web_access import Access
    from morse.viewer.view_messages import ServerMessage, Subject

MOST_EVENTS = 1000
"""Maximum number of events that wait for the simulation."""

MOST_PAGES = 128
"""Maximum number of connected pages."""

#: maximum number of connections, also those that fetch files or have not sent a request
_MOST_CONNECTIONS = 256
#: seconds between two evaluations of what all pages show together
_INTERVAL = 0.02
_PATIENCE = 300.0  # s: time for a large scene over a slow connection
_FIRST_MESSAGE = 10.0  # s
_GREETING = "/ws"


logger = logging.getLogger("morse.viewer")


@dataclass(frozen=True, slots=True)
class Wishes:
    """What all pages show together.

    Attributes:
        values: components whose data are shown.
        overlays: components whose rays, cones or other overlays are shown, and ``contacts``.
        images: cameras whose images are shown.
    """

    values: frozenset[str] = frozenset()
    overlays: frozenset[str] = frozenset()
    images: frozenset[str] = frozenset()


class Hub:
    """All pages of one simulation.

    Attributes:
        seat: determines the page that drives.
        events: requests of the driving page, oldest first.
        wishes: what all pages show together.
        site: the files for HTTP requests.
    """

    def __init__(self, access: Access, title: str, arrivals: Arrivals) -> None:
        self.access = access
        self.control_lock = ControlLock()
        self.events: deque[pm.ViewEvent] = deque()
        self.wishes = Wishes()
        self.site = Site(origins=access.origins)
        self._title = title
        self._pages: dict[int, Page] = {}
        self._numbers = 0
        self._dragging: int | None = None
        self._requests = Requests()
        self._lasting: dict[Subject, str | bytes] = {}
        self._server: Server | None = None
        self._cookie = ""
        self._seat_told = ""
        self._evaluation: asyncio.TimerHandle | None = None
        self._wishes_waiting = False
        self._complaints = Complaints(logger)
        self._acceptor = StreamAcceptor(
            "live view", most=_MOST_CONNECTIONS, complaints=self._complaints, refusal=NO_PLACE
        )
        self._arrivals = arrivals
        self._quiet = logging.Logger("morse.viewer.connections", logging.CRITICAL + 1)  # no log of invalid requests

    @property
    def watched(self) -> bool:
        """Whether any page is connected."""
        return bool(self._pages)

    @property
    def drawn(self) -> bool:
        """Whether any page has drawn the world."""
        return any(page.drawn for page in list(self._pages.values()))

    async def open(self, host: str, ports: Iterable[int]) -> int:
        """Bind to the first free port, and return it.

        Raises:
            OSError: no port is free.
        """
        self._server, port = await serve_on(
            self._serve,
            host,
            ports,
            self._arrivals,
            self._acceptor,
            process_request=self._answer,
            max_size=MAX_MESSAGE,
            open_timeout=_PATIENCE,
            close_timeout=_PATIENCE,
            logger=self._quiet,
        )
        self._cookie = f"morse_view_{port}"
        return port

    async def close(self) -> None:
        """Tell the pages that the simulation has ended, and close the connections."""
        if self._server is None:
            return
        self._server.close(reason="The simulation has ended")
        try:
            async with asyncio.timeout(1.0):
                await self._server.wait_closed()
        except TimeoutError:
            for page in self._pages.values():
                page.connection.transport.abort()

    def broadcast(self, message_subject: Subject | None, frame: str | bytes, *, lasting: bool) -> None:
        """Send a message to all pages; a lasting message also to pages that connect later."""
        if lasting and message_subject is not None:
            self._lasting.pop(message_subject, None)
            self._lasting[message_subject] = frame
        for page in list(self._pages.values()):
            page.tell(message_subject, frame)
            if page.hopeless:
                page.connection.transport.abort()

    def forget(self, names: Set[str]) -> None:
        """Drop the lasting messages about components that exist no longer, and about what was below them.

        Clients spawn and delete any number of them.
        """
        of_components = [subject for subject in self._lasting if subject[0] in OF_COMPONENTS]
        gone = [one for one in of_components if not names.isdisjoint((one[1], one[1].partition(".")[0]))]
        for subject in gone:
            del self._lasting[subject]

    def show(self, poses: bytes) -> None:
        """Send the newest poses to all pages. A page that is not ready gets these or newer poses later."""
        broadcast([page.connection for page in self._pages.values() if page.show(poses)], poses)

    # requests ------------------------------------------------------------------------------------

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        try:
            path = urlsplit(request.path).path
        except ValueError:
            return refuse(HTTPStatus.BAD_REQUEST, "The path is not valid.")
        try:
            secret = path == _GREETING or self.site.is_secret(path)
            refusal = self.access.refusal(request.path, request.headers, secret=secret, cookie=self._cookie)
        except LookupError:
            return refuse(HTTPStatus.BAD_REQUEST, "A header that must be unique is repeated.")
        if refusal is not None:
            return refuse(HTTPStatus.FORBIDDEN, refusal)
        if path == _GREETING:
            if len(self._pages) < MOST_PAGES:
                return None
            self._complaints.warn("full", f"live view: a page is refused: there are {MOST_PAGES} pages")
            return refuse(HTTPStatus.SERVICE_UNAVAILABLE, f"There are {MOST_PAGES} pages already: close some.")
        return self.site.respond(path, request.headers, self.access.cookie(request.path, self._cookie))

    async def _serve(self, connection: ServerConnection) -> None:
        page: Page | None = None
        sending: asyncio.Task[None] | None = None
        sender = sender_of(connection)
        reason = b""
        try:
            page = await self._accepted(connection)
            if page is None:
                return
            sending = asyncio.create_task(page.send_forever())
            async for frame in connection:
                with sender.measured():
                    self._receive(page, decode_page_message(frame), len(frame))
                await sender.rest()
        except NotUnderstood as error:
            reason = f"Not understood: {error}".encode(errors="replace")[:120]  # RFC 6455: 123
        except ConnectionClosed:
            pass  # a closed tab sends no close frame
        except Exception as error:
            who = "a page" if page is None else f"page {page.number}"
            self._complaints.log(logging.ERROR, "page", f"live view: {who} is disconnected: {describe(error)}")
            reason = b"The simulator could not process a message of this page: see its log"
        finally:
            if sending is not None:
                sending.cancel()
            if page is not None:
                self._leave(page)
        if reason:
            await connection.close(Close.NOT_UNDERSTOOD, reason.decode(errors="ignore"))

    async def _accepted(self, connection: ServerConnection) -> Page | None:
        try:
            async with asyncio.timeout(_FIRST_MESSAGE):
                hello = decode_page_message(await connection.recv())
        except TimeoutError:
            raise NotUnderstood("the first message, hello, was not received") from None
        if not isinstance(hello, pm.Hello):
            raise NotUnderstood("the first message must be hello")
        if hello.version != VERSION:
            reason = f"This page has version {hello.version} of the protocol, the simulator {VERSION}: reload the page"
            await connection.close(Close.OTHER_VERSION, reason)
            return None
        if len(self._pages) >= MOST_PAGES:  # others have said hello since this one was let in
            await connection.close(Close.FULL, f"There are {MOST_PAGES} pages already: close some")
            return None
        self._numbers += 1
        page = Page(self._numbers, connection)
        self._pages[page.number] = page
        self.control_lock.enter(page.number)
        self._tell(page, Welcome(VERSION, page.number, self._title))
        page.begin(self._lasting)
        self._seat_changed()
        return page

    def _leave(self, page: Page) -> None:
        del self._pages[page.number]
        self._drop_drag(page)
        if numbers := self._requests.forget(page.number):
            self.events.append(PageLeft(numbers))
        self.control_lock.leave(page.number, list(self._pages))
        self._seat_changed()
        self._wishes_changed()

    # messages ------------------------------------------------------------------------------------

    def _receive(self, page: Page, message: pm.PageMessage, size: int) -> None:
        drives = self.control_lock.driver == page.number
        match message:
            case pm.Alive():
                self.control_lock.hear(page.number)
            case pm.Taken():
                page.took(message.count)
            case pm.Shown():
                page.drawn = True
            case pm.Keys():
                self.control_lock.hold(page.number, frozenset(message.held))
            case pm.Gamepad():
                self.control_lock.steer(page.number, tuple(message.axes), tuple(message.buttons))
            case pm.Watch():
                page.watch = message
                self._wishes_changed()
            case pm.AskToDrive():
                self.control_lock.ask(page.number)
                self._seat_changed()
            case pm.HandOver():
                if self.control_lock.hand_over(page.number, message.to, list(self._pages)):
                    self._drop_drag(page)
                else:
                    self._refuse(page, message, "only the page that drives can hand over, and only to a connected page")
                self._seat_changed()
            case pm.KeepDriving():
                self.control_lock.keep(page.number)
                self._seat_changed()
            case pm.ViewEvent() if not drives:
                self._refuse(page, message, "another page drives: request control first")
            case pm.ViewEvent() if len(self.events) >= MOST_EVENTS:
                self._refuse(page, message, "the simulation is busy with earlier requests")
            case pm.ViewEvent() if self._requests.is_full(page.number, message):
                self._refuse(page, message, f"{MOST_REQUESTS} requests of this page are active: wait until they end")
            case pm.ViewEvent():
                self._request(page, message, PARSED * size + ENTRY)
            case _:
                raise NotUnderstood(f"{type(message).__name__} is only allowed as the first message")

    def _request(self, page: Page, message: pm.ViewEvent, size: int) -> None:
        """Pass a request on to the simulation, which may answer much later."""
        if isinstance(message, pm.Drag | pm.DragEnd):
            self._dragging = page.number if isinstance(message, pm.Drag) else None
        if getattr(message, "request", None) is not None and not isinstance(message, pm.CancelService):
            try:
                page.memory.charge(size, "a request")
            except OverBudget as error:
                self._complaints.warn("memory", f"live view: page {page.number}: {error}")
                self._refuse(page, message, str(error))
                return
        self.events.append(self._requests.number(page.number, message, size))

    def _drop_drag(self, page: Page) -> None:
        if self._dragging == page.number:
            self._dragging = None
            self.events.append(pm.DragEnd())

    def answer(self, answer: Answer) -> None:
        """Send an answer to the page that sent the request."""
        number, own, size = self._requests.take(answer)
        page = self._pages.get(number)
        if page is not None:
            page.memory.give(size)
            self._tell(page, own)

    def _refuse(self, page: Page, message: pm.PageMessage, why: str) -> None:
        request = getattr(message, "request", None)
        if request is None:
            self._tell(page, Refused(str(type(message).__struct_config__.tag), why))
        else:
            self._tell(page, Answer(request, ok=False, error=why))

    def _tell(self, page: Page, message: ServerMessage) -> None:
        page.tell(message.subject(), encode_server_message(message))
        if page.hopeless:
            page.connection.transport.abort()

    def _seat_changed(self) -> None:
        message = self.control_lock.message(len(self._pages))
        frame = str(encode_server_message(message))
        if frame != self._seat_told:
            self._seat_told = frame
            self.broadcast(message.subject(), frame, lasting=False)

    def _wishes_changed(self) -> None:
        """Evaluate the wishes now, or soon if a page changes them again and again."""
        if self._evaluation is None:
            self._evaluate()
            self._evaluation = asyncio.get_running_loop().call_later(_INTERVAL, self._evaluate_again)
        else:
            self._wishes_waiting = True

    def _evaluate_again(self) -> None:
        self._evaluation = None
        if self._wishes_waiting:
            self._wishes_changed()

    def _evaluate(self) -> None:
        self._wishes_waiting = False
        watches = [page.watch for page in self._pages.values() if page.watch is not None]
        self.wishes = Wishes(
            values=frozenset(name for watch in watches for name in watch.values),
            overlays=frozenset(name for watch in watches for name in watch.overlays),
            images=frozenset(name for watch in watches for name in watch.images),
        )
