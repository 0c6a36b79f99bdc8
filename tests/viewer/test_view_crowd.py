"""Pages and strangers in large numbers: connections, messages, requests without an answer."""

import socket
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from view_pages import Client, fetch, port_of

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.services import concurrent_service
from morse.scene import Scene
from morse.viewer import hub as hubs
from morse.viewer.page import MOST_REQUESTS, PageLeft
from morse.viewer.page_inputs import ServiceCalls
from morse.viewer.page_messages import CallService, Pause
from morse.viewer.view_messages import Answer
from tests.kit.waiting import wait_until


def test_silent_connections_do_not_keep_pages_out(served, monkeypatch, caplog) -> None:
    server, url = served
    monkeypatch.setattr(server._hub._acceptor, "_most", 4)
    with Client(url) as page:
        page.expect("welcome")
        silent = [socket.create_connection(("127.0.0.1", port_of(url)), timeout=60.0) for _ in range(8)]
        assert silent[0].recv(1) == b"", "the oldest one is closed"
        assert fetch(url)[0] == 200
        with Client(url) as other:
            other.expect("welcome")
            page.expect("seat", pages=2)
        assert len(server._hub._acceptor.connections) <= 4
        for one in silent:
            one.close()
    assert "to make room" in caplog.text


def test_pages_beyond_the_limit_are_told_why(served, monkeypatch) -> None:
    _, url = served
    monkeypatch.setattr(hubs, "MOST_PAGES", 1)
    with Client(url) as page:
        page.expect("welcome")
        with pytest.raises(Exception, match="503"):
            Client(url)
        assert fetch(url)[0] == 200


def test_a_page_that_asks_again_and_again_is_told_once(served) -> None:
    server, url = served
    with Client(url) as driver, Client(url) as other:
        driver.expect("seat", pages=2)
        driver.send("alive")
        for _ in range(200):
            other.send("ask_to_drive")
        other.send("pause")
        other.expect("refused")
        server.set_scene(Scene("s"), [])
        driver.expect("world")
        asked = [message for message in driver.messages if message["type"] == "seat"]
        assert len(asked) <= 1


def test_requests_without_an_answer_are_limited_and_end_with_their_page(served) -> None:
    server, url = served
    with Client(url) as page:
        for number in range(MOST_REQUESTS + 1):
            page.send("call_service", request=number, component="time", service="sleep", arguments=[1e9])
        answer = page.expect("answer", request=MOST_REQUESTS)
        assert "256 requests of this page are active" in answer["error"]
        calls = [event for event in server.take_events() if isinstance(event, CallService)]
        assert len(calls) == MOST_REQUESTS
        page.send("cancel_service", request=0)
        wait_until(server.take_events)
        server.send(Answer(calls[0].request, ok=False, error="PREEMPTED"))
        page.expect("answer", request=0)
        page.send("call_service", request=1000, component="time", service="sleep", arguments=[1e9])
        (last,) = wait_until(server.take_events)
    events = wait_until(server.take_events)
    assert events == [PageLeft([call.request for call in (*calls[1:], last)])]


class Sleeper(AbstractObject):
    """Counts the sleeps that have not ended."""

    def __init__(self) -> None:
        super().__init__()
        self.asleep = 0

    def name(self) -> str:
        return "bed"

    @concurrent_service(changes=False)
    def sleep(self, ended: Callable[[Any], object]) -> Any:
        """Sleep until it is cancelled."""
        self.asleep += 1

        def wake() -> None:
            self.asleep -= 1
            ended((status.PREEMPTED, None))

        return wake


def test_services_of_a_page_end_with_it(served) -> None:
    server, _ = served
    bed = Sleeper()
    context: Any = SimpleNamespace(service_objects=[bed], robots={}, components={})
    services = ServiceCalls(context, server, SimpleNamespace())  # type: ignore[arg-type]
    for number in (1, 2, 3):
        services.call(CallService(number, "bed", "sleep"))
    services.forget(PageLeft([1, 3]))
    assert bed.asleep == 1
    services.update()


def test_requests_that_take_long_are_spread_over_ticks(served) -> None:
    server, _ = served
    server._hub.events.extend([Pause()] * 5)
    events = server.take_events()
    server._hub.events.append(PageLeft([]))
    server.put_back(events[2:])
    assert server.take_events() == [Pause()] * 3 + [PageLeft([])]


def test_descriptions_of_earlier_worlds_are_forgotten(served) -> None:
    server, url = served
    with Client(url) as page:
        for _ in range(30):
            server.set_scene(Scene("s"), [])
        page.expect("world", revision=30)
    assert fetch(f"{url}worlds/30.json")[0] == 200
    assert len([path for path in server._hub.site.files if path.startswith("/worlds/")]) <= 8


def test_a_path_that_is_none_is_refused(served) -> None:
    _, url = served
    with socket.create_connection(("127.0.0.1", port_of(url)), timeout=60.0) as stranger:
        stranger.sendall(b"GET //[ HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert stranger.recv(100).startswith(b"HTTP/1.1 400")
