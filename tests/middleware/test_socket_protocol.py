import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.middleware.socket.service_client import MalformedRequest, format_failure, format_reply, parse_request

words = st.text(st.characters(exclude_categories=("Z", "C")), min_size=1)
blanks = st.text(" \t\r\f\v", min_size=1)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


@given(words, words, words, st.lists(json_values), st.lists(blanks, min_size=5, max_size=5))
def test_blanks_of_any_kind_separate(
    request_id: str, component: str, service: str, arguments: list[object], gaps: list[str]
) -> None:
    line = "".join(
        gap + word for gap, word in zip(gaps, [request_id, component, service, json.dumps(arguments)], strict=False)
    )
    parsed = parse_request((line + gaps[4]).encode())
    assert parsed == (request_id, component, service, arguments)


def test_a_request_needs_no_arguments() -> None:
    assert parse_request(b"id1 simulation quit") == ("id1", "simulation", "quit", [])
    assert parse_request(b"id1 simulation quit []\r") == ("id1", "simulation", "quit", [])


def test_a_cancellation() -> None:
    assert parse_request(b"8 cancel") == ("8", "", None, [])
    assert parse_request(b"8 cancel x") == ("8", "cancel", "x", [])


@pytest.mark.parametrize("line", [b"", b"   ", b"\r", b"\t \r"])
def test_a_blank_line_asks_nothing(line: bytes) -> None:
    assert parse_request(line) is None


@pytest.mark.parametrize(
    ("line", "request_id", "message"),
    [
        (b"id", "id", "expected: id component service"),
        (b"id component", "id", "expected: id component service"),
        (b"id c s {", "id", "the arguments are no JSON"),
        (b"id c s 3", "id", "JSON list"),
        (b'id c s {"a": 1}', "id", "JSON list"),
        (b"id c s " + b"[" * 100_000, "id", "the arguments are no JSON"),
        (b"\xff c", "�", "expected: id component service"),
    ],
)
def test_a_malformed_request_says_what_is_wrong(line: bytes, request_id: str, message: str) -> None:
    with pytest.raises(MalformedRequest, match=message) as caught:
        parse_request(line)
    assert caught.value.request == request_id
    assert str(caught.value).startswith("Malformed request! ")


@given(st.binary())
def test_any_line_is_read_or_refused(line: bytes) -> None:
    try:
        parse_request(line)
    except MalformedRequest as error:
        reply = format_failure(error.request, str(error))
        assert reply.endswith(b"\n")
        assert reply.count(b"\n") == 1


@pytest.mark.parametrize("value", [None, False, 0, 0.0, -0.0, [], {}, "", ()])
def test_a_value_that_counts_as_false_is_left_out(value: object) -> None:
    assert format_reply("3", "SUCCESS", value) == b"3 SUCCESS\n"


@pytest.mark.parametrize(
    ("value", "text"), [(True, b"true"), ([0.0], b"[0.0]"), ("Arrived", b'"Arrived"'), ({"a": 0}, b'{"a": 0}')]
)
def test_any_other_value_is_there(value: object, text: bytes) -> None:
    assert format_reply("3", "SUCCESS", value) == b"3 SUCCESS " + text + b"\n"


def test_a_value_that_cannot_be_sent_is_a_failure() -> None:
    reply = format_reply("3", "SUCCESS", object())
    assert reply.startswith(b'3 FAILED "the result cannot be sent: ')
