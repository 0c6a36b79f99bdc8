"""The resources of one client are limited, and no other client has to wait for it."""

import contextlib
import gc
import json
import logging
import time
import uuid
import weakref
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from socket_bench import Bench, Peer

from morse.core import status
from morse.core.clients.acceptors import Descriptors
from morse.core.clients.complaints import Complaints
from morse.core.services import concurrent_service
from morse.middleware.socket.request_manager import Calls
from morse.middleware.socket.turns import Turns
from morse.wire import lines
from morse.wire import server as servers
from morse.wire.encoding import from_json, to_json
from morse.wire.lines import Inbox
from morse.wire.server import Budget, limits_of
from tests.kit.waiting import wait_until


class Caller:
    """The part of a client that turns and calls use."""

    def __init__(self) -> None:
        self.calls = 0


# -- turns -----------------------------------------------------------------------------------


def serve(turns: Turns, cost: Callable[[Caller], float], count: int) -> list[Caller]:
    served = []
    for _ in range(count):
        taken = turns.next()
        if taken is None:
            break
        turns.served(taken[0], cost(taken[0]))  # type: ignore[arg-type]
        served.append(taken[0])
    return served  # type: ignore[return-value]


@given(st.lists(st.integers(0, 4), max_size=60))
def test_cheap_requests_are_served_in_the_order_of_arrival(order: list[int]) -> None:
    callers = [Caller() for _ in range(5)]
    turns = Turns()
    for n in order:
        turns.extend([(callers[n], b"")])  # type: ignore[list-item]
    assert len(turns) == len(order)
    assert serve(turns, lambda _: 1e-6, 100) == [callers[n] for n in order]
    assert len(turns) == 0


def test_who_takes_much_time_waits_for_the_others() -> None:
    greedy, modest = Caller(), Caller()
    turns = Turns()
    turns.extend([(greedy, b"")] * 1000)  # type: ignore[list-item]
    serve(turns, lambda _: 0.05, 20)
    for _ in range(10):
        turns.extend([(modest, b"")])  # type: ignore[list-item]
        assert modest in serve(turns, lambda c: 0.05 if c is greedy else 1e-4, 2)


def test_many_who_take_much_time_get_equal_shares() -> None:
    callers = [Caller() for _ in range(10)]
    turns = Turns()
    for caller in callers:
        turns.extend([(caller, b"")] * 1000)  # type: ignore[list-item]
    served = serve(turns, lambda _: 0.01, 500)
    assert {served.count(caller) for caller in callers} == {50}


def test_a_client_that_has_gone_leaves_no_trace() -> None:
    turns, calls = Turns(), Calls()
    caller = Caller()
    gone = weakref.ref(caller)
    turns.extend([(caller, b"x")] * 10)  # type: ignore[list-item]
    serve(turns, lambda _: 1.0, 3)
    call = uuid.uuid4()
    calls.issued(caller, "1")  # type: ignore[arg-type]
    calls.add(call, caller, "1")  # type: ignore[arg-type]
    assert calls.forget(caller) == [call]  # type: ignore[arg-type]
    calls.remove(call)
    turns.forget(caller, with_requests=True)  # type: ignore[arg-type]
    assert len(turns) == 0
    assert turns.next() is None
    del caller
    gc.collect()
    assert gone() is None


def test_a_slow_request_does_not_hold_up_those_of_others(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench.arm, "echo", None, raising=False)
    served: list[str] = []
    bench.requests.register_service("robot1.motion", lambda: served.append("slow") or time.sleep(0.02), "slow")
    bench.requests.register_service("robot1.motion", lambda: served.append("quick"), "quick")
    greedy, modest = bench.connect(), bench.connect()
    greedy.send(b"1 robot1.motion slow\n" * 500)
    wait_until(lambda: len(bench.requests._inbox) == 500)
    for n in range(5):
        waiting = len(bench.requests._inbox)
        modest.send(b"2 robot1.motion quick\n")
        # no tick meanwhile: when the request arrives depends on the machine
        wait_until(lambda waiting=waiting: len(bench.requests._inbox) == waiting + 1)
        before = len(served)
        bench.tick_until(lambda n=n: served.count("quick") == n + 1)
        assert served[before:].count("slow") < 10
    greedy.close()
    modest.close()


def test_services_take_a_share_of_the_time_only(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [time.perf_counter()]

    def pass_time(seconds: float) -> None:
        clock[0] += seconds

    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", lambda: clock[0])
    bench.requests.register_service("robot1.motion", lambda: pass_time(0.005), "slow")
    greedy = bench.connect()
    greedy.send(b"1 robot1.motion slow\n" * 900)
    wait_until(lambda: len(bench.requests._inbox) == 900)
    bench.requests.main()
    begin, other = clock[0], 0.0
    while clock[0] < begin + 1.0:
        bench.tick()
        pass_time(0.005)  # other work of a tick
        other += 0.005
    assert 0.2 < clock[0] - begin - other < 0.6
    greedy.close()


# -- bytes -----------------------------------------------------------------------------------


def test_lines_that_never_end_have_a_limit_together(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    budget = Budget(1 << 20)
    monkeypatch.setattr(limits_of(bench.context.network), "held", budget)
    modest = bench.connect()
    modest.send(b"1 robot1.motion ")
    greedy = [bench.connect() for _ in range(6)]
    for peer in greedy:
        with contextlib.suppress(ConnectionError):  # it may be disconnected before all of it is sent
            peer.send(b"1 robot1.motion echo [" + b"1," * 120_000)
    wait_until(lambda: any(peer.has_ended() for peer in greedy))
    assert "are not yet processed" in caplog.text
    modest.send(b"nothing\n")
    bench.tick_until(lambda: modest.lines() == [b"1 SUCCESS"])
    for peer in (*greedy, modest):
        peer.close()
    server = bench.requests._server
    wait_until(lambda: bench.tick() or (server and not server.connected and budget.left == 1 << 20))


def test_requests_that_wait_have_a_limit(bench: Bench) -> None:
    budget = limits_of(bench.context.network).held
    peers = [bench.connect() for _ in range(3)]
    request = b'1 robot1.motion echo ["%b"]\n' % (b"x" * 500_000)
    for peer in peers:
        peer.send(request * 3)
    wait_until(lambda: len(bench.requests._inbox) == 9)
    assert servers.MAX_HELD - budget.left < 9 * 600_000
    bench.tick_until(lambda: all(len(peer.lines()) == 3 for peer in peers))
    wait_until(lambda: budget.left == servers.MAX_HELD)
    for peer in peers:
        peer.close()


def test_a_client_with_megabytes_of_requests_is_not_read_from(bench: Bench) -> None:
    peer = bench.connect()
    request = b'1 robot1.motion echo ["%b"]\n' % (b"x" * 900_000)
    for _ in range(2):
        peer.send(request)
    server = bench.requests._server
    assert server is not None
    (client,) = server.clients
    wait_until(lambda: client._held_back)
    bench.tick_until(lambda: len(peer.lines()) == 2)
    wait_until(lambda: not client._held_back)
    assert bench.call(peer, b"2 robot1.motion nothing\n") == b"2 SUCCESS\n"
    peer.close()


def test_messages_to_all_actuators_have_a_limit_together() -> None:
    budget = Budget(1000)
    inboxes = [Inbox() for _ in range(20)]
    for inbox in inboxes:
        inbox.budget = budget
        inbox.put(b"x" * 100)
    assert budget.left == 0
    assert [inbox.take() for inbox in inboxes] == [([b"x" * 100], 0)] * 10 + [([], 1)] * 10
    assert budget.left == 1000


def test_many_listeners_share_what_may_be_unsent(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    few = limits_of(bench.context.network).high_water()
    monkeypatch.setattr(servers.Limits, "connected", 10_000)
    many = limits_of(bench.context.network).high_water()
    assert few == 1 << 18
    assert 10_000 * many <= servers.MAX_UNSENT


def test_all_connections_together_have_a_limit(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.sensor(port=0)
    together = limits_of(bench.context.network)
    monkeypatch.setattr(Descriptors, "has_room", lambda self: self._clients < 20)
    peers = [bench.connect("robot1.pose") for _ in range(30)]
    wait_until(lambda: together.connected == 20)
    client = bench.connect()
    assert bench.call(client, b"1 robot1.motion nothing\n") == b"1 SUCCESS\n"
    for peer in (*peers, client):
        peer.close()


def test_a_listener_that_takes_its_messages_stays(bench: Bench) -> None:
    pose = bench.sensor(port=0)
    listener = bench.connect("robot1.pose")
    idle = [bench.connect("robot1.pose") for _ in range(servers.MAX_CLIENTS + 50)]
    for n in range(20):
        pose.local_data["temperature"] = float(n)
        bench.tick()
        idle.append(bench.connect("robot1.pose"))
    wait_until(lambda: len(listener.lines()) == 20)
    assert not listener.has_ended()
    for peer in (*idle, listener):
        peer.close()


def test_a_long_id_is_refused(bench: Bench, client: Peer) -> None:
    reply = bench.call(client, b"x" * 1_000_000 + b" robot1.motion nothing\n")
    assert b"FAILED" in reply
    assert len(reply) < 500


@pytest.mark.parametrize(
    "request_line",
    [
        b"1 nobody " + b"x" * 900_000,
        b"1 " + b"x" * 900_000 + b" nothing",
        b"1 robot1.motion " + b"x" * 900_000,
        b'1 robot1.motion add ["' + b"x" * 900_000 + b'"]',
        b"1 robot1.motion add [" + b"[1]," * 220_000 + b"1]",
        b'1 simulation get_stream_port ["' + b"x" * 900_000 + b'"]',
        b"1 robot1.motion echo {" + b"x" * 900_000,
    ],
)
def test_a_name_of_megabytes_is_refused_in_few_words(bench: Bench, client: Peer, request_line: bytes) -> None:
    short = bench.call(client, b"1 nobody nothing\n")
    reply = bench.call(client, request_line + b"\n")
    assert reply.startswith(b"1 FAILED ")
    assert len(reply) < len(short) + 1000


def test_the_calls_of_one_client_have_a_limit(bench: Bench, client: Peer) -> None:
    bench.requests.register_async_service("robot1.motion", concurrent_service(lambda ended: None), "wait")
    client.send(b"1 robot1.motion wait\n" * 1030)
    bench.tick_until(lambda: len(client.lines()) == 6)
    assert b"calls of this client are active" in client.lines()[0]
    other = bench.connect()
    bench.call(other, b"2 robot1.motion wait\n3 robot1.motion nothing\n")
    other.close()


# -- calls -----------------------------------------------------------------------------------


@given(st.lists(st.tuples(st.sampled_from("acr"), st.integers(0, 2), st.sampled_from("123")), max_size=60))
def test_calls_are_found_as_by_looking_through_all(steps: list[tuple[str, int, str]]) -> None:
    callers = [Caller() for _ in range(3)]
    calls = Calls()
    model: list[tuple[uuid.UUID, Caller, str]] = []
    used: set[tuple[Caller, str]] = set()
    for what, number, request in steps:
        caller = callers[number]
        if what == "a":
            call = uuid.uuid4()
            calls.issued(caller, request)  # type: ignore[arg-type]
            calls.add(call, caller, request)  # type: ignore[arg-type]
            used.add((caller, request))
            model.append((call, caller, request))
        elif what == "r" and model:
            call, caller, request = model.pop(0)
            assert calls.remove(call) == (caller, request)
        own = [call for call, c, r in model if (c, r) == (caller, request)]
        others = [] if (caller, request) in used else [call for call, _, r in model if r == request]
        expected = (own or others or [None])[-1]
        assert calls.find(caller, request) == expected  # type: ignore[arg-type]
    assert [caller.calls for caller in callers] == [sum(c is caller for _, c, _ in model) for caller in callers]


def test_cancelling_takes_no_longer_if_many_calls_go_on() -> None:
    def cancel_all(count: int) -> float:
        caller, calls = Caller(), Calls()
        for n in range(count):
            calls.add(uuid.UUID(int=n), caller, str(n % 10))  # type: ignore[arg-type]
        begin = time.thread_time()
        for n in range(count):
            call = calls.find(caller, str(n % 10))  # type: ignore[arg-type]
            assert call is not None
            calls.remove(call)
        return time.thread_time() - begin

    few, many = min(cancel_all(1000) for _ in range(5)), min(cancel_all(30_000) for _ in range(2))
    assert many < 30 * few * 5


def test_what_was_done_for_a_client_alone_ends_with_it(bench: Bench, client: Peer) -> None:
    running: list[object] = []

    @concurrent_service
    def wait(ended: Callable[[object], None]) -> Callable[[], None]:
        running.append(ended)
        return lambda: running.remove(ended)

    bench.requests.register_async_service("robot1.motion", wait, "wait")
    gone = bench.connect()
    gone.send(b"1 robot1.motion wait\n" * 100 + b"2 robot1.motion goto [1, 2, 3]\n")
    client.send(b"3 robot1.motion wait\n")
    bench.tick_until(lambda: len(running) == 101 and bench.arm.running_service)
    gone.close()
    bench.tick_until(lambda: len(running) == 1)
    assert bench.arm.running_service == "goto", "what a robot does goes on, as it always did"
    bench.arm.completed(status.SUCCESS)
    client.send(b"3 cancel\n")
    bench.tick_until(lambda: client.lines() == [b"3 PREEMPTED"])
    assert running == []


# -- the log ---------------------------------------------------------------------------------


def test_complaints_of_many_kinds_are_counted_too(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.core.clients.complaints._PERIOD", 10.0)  # as it is without conftest.py
    now = [0.0]
    complaints = Complaints(logging.getLogger("morse.test"), lambda: now[0])
    for n in range(100_000):
        complaints.warn(f"field {n}", f"field {n} hurts")
    assert len(caplog.records) < 50
    now[0] = 11.0
    complaints.warn("another", "it hurts")
    assert "warnings of other kinds were suppressed" in caplog.records[-1].getMessage()
    assert len(complaints._last) < 50


def test_a_service_that_breaks_down_again_and_again_is_logged_once(
    bench: Bench, client: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    client.send(b"1 robot1.motion break_down\n" * 300)
    bench.tick_until(lambda: len(client.lines()) == 300)
    assert caplog.text.count("the service break_down of robot1.motion failed") == 1


@pytest.mark.parametrize("evil", ["\n[ERROR][MORSE] forged", "\x1b[2J", "\r[ERROR][MORSE] forged", "\u2028", "\ud800"])
def test_nothing_that_clients_send_gets_into_the_log_raw(
    bench: Bench, client: Peer, evil: str, caplog: pytest.LogCaptureFixture
) -> None:
    from morse.core.reports.log import MorseFormatter

    def fail(value: object) -> None:
        raise ValueError(f"the user's code repeats {value}")

    bench.requests.register_service("robot1.motion", fail, "fail")
    caplog.set_level(logging.DEBUG, "morse")
    text = json.dumps(evil).encode()
    raw = evil.replace("\n", "").encode("utf-8", "surrogatepass")
    bench.actuator(port=0)
    stream = bench.connect("robot1.motion")
    for line in (
        b"{%b: 1}" % text,
        b'{"mode": 1, %b: %b}' % (text, text),
        b'{"v": %b}' % text,
        b'{"v": "%b' % raw,
        raw,
    ):
        stream.send(line + b"\n")
        bench.tick()
    requests = [b"1 %b %b" % (raw, raw), b"%b robot1.motion nothing" % raw, b"2 robot1.motion fail [%b]" % text]
    requests += [b"3 robot1.motion add [%b]" % text, b"4 simulation get_stream_port [%b]" % text, b"5 a b " + raw]
    for request in requests:
        bench.call(client, request + b"\n")
    stream.send(b"unfinished " + raw)
    stream.close()
    client.send(b"unfinished " + raw)
    client.close()
    wait_until(lambda: caplog.text.count("left in the middle") == 2)
    formatter = MorseFormatter()
    for record in caplog.records:
        written = formatter.format(record).split("\n")
        assert all(line.isprintable() for line in written)
        assert not any(line.startswith("[ERROR]") for line in written)


# -- invalid characters ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "value"),
    [
        (b'"\\ud800"', "\ufffd"),
        (b'{"\\udfff": ["\\uD800x"]}', {"\ufffd": ["\ufffdx"]}),
        (b'"\\ude00\\ud83d"', "\ufffd\ufffd"),
        (b'"\\ud83d\\ude00"', "\U0001f600"),
        (b'["\\\\ud800", NaN]', None),
        (b'"\xed\xa0\x80"', None),
    ],
)
def test_half_a_character_is_replaced(text: bytes, value: object) -> None:
    read = from_json(text)
    json.dumps(read, ensure_ascii=False).encode()
    if value is not None:
        assert read == value


@given(st.text(st.characters(categories=("Cs", "L", "N"))))
def test_values_with_half_characters_can_be_sent(text: str) -> None:
    assert json.loads(to_json({text: [text, 1.5]})) == {text: [text, 1.5]}
    to_json(text).decode("ascii") if not text.isprintable() else None


def test_a_backslash_is_no_half_character() -> None:
    assert from_json(b'["\\\\ud800", NaN]')[0] == "\\ud800"


def test_requests_with_half_characters_are_answered(bench: Bench, client: Peer) -> None:
    for request in (
        b'1 robot1.motion echo ["\\ud800"]',
        b'1 robot1.motion echo [{"\\ud800": "\\udfff"}]',
        b'1 robot1.motion add ["\\ud800"]',
        b'1 simulation get_stream_port ["\\ud800"]',
        b"1 \xed\xa0\x80 nothing",
    ):
        assert bench.call(client, request + b"\n").startswith(b"1 ")
    assert lines.MAX_LINE < 1 << 24


@pytest.mark.parametrize(
    "text",
    [b"[" + b"[]," * 120_000 + b"1]", b"[" + b"{}," * 120_000 + b"NaN]", b'{"x": [' + b"[1],[2]," * 60_000 + b"1]}"],
)
def test_a_text_with_very_many_parts_is_refused_before_they_are_made(text: bytes) -> None:
    with pytest.raises(ValueError, match="more than 100000 lists and objects"):
        from_json(text)
    assert len(from_json(b"[" + b"1," * 400_000 + b"1]")) == 400_001


def test_of_a_flood_of_messages_only_the_last_ones_are_looked_at() -> None:
    inbox = Inbox()
    inbox.put_all([b"%d" % number for number in range(50_000)])
    assert inbox.take() == ([b"%d" % number for number in range(49_936, 50_000)], 49_936)
    inbox.put_all([b"a", b"b"])
    assert inbox.take() == ([b"a", b"b"], 0)
