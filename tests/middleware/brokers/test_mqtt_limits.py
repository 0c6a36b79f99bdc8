"""What a broker may send (MQTT 3.1.1): packets of a limited size, and a limited number of messages with QoS 2."""

import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.middleware.mqtt.broker import PacketLimits
from tests.kit.effort import examples


def packet(first: int, body: bytes) -> bytes:
    size, count = bytearray(), len(body)
    while True:
        count, rest = divmod(count, 128)
        size.append(rest | (128 if count else 0))
        if not count:
            return bytes([first]) + bytes(size) + body


def publish(number: int, payload: bytes = b"{}", quality: int = 2) -> bytes:
    mid = struct.pack(">H", number) if quality else b""
    return packet(0x30 | quality << 1, b"\x00\x01t" + mid + payload)


def release(number: int) -> bytes:
    return packet(0x62, struct.pack(">H", number))


def feed(data: bytes, cuts: list[int]) -> None:
    limits, begin = PacketLimits(), 0
    for end in sorted({min(cut, len(data)) for cut in (*cuts, len(data))}):
        limits.pass_on(data[begin:end])
        begin = end


CUTS = st.lists(st.integers(0, 3000), max_size=20)


@settings(max_examples=examples(100))
@given(st.lists(st.tuples(st.integers(0, 0xFFFF), st.binary(max_size=300), st.integers(0, 2)), max_size=60), CUTS)
def test_ordinary_messages_pass_however_they_arrive(messages: list[tuple[int, bytes, int]], cuts: list[int]) -> None:
    feed(b"\x20\x02\x00\x00" + b"\xd0\x00".join(publish(*one) for one in messages), cuts)


@settings(max_examples=examples(50))
@given(CUTS, st.integers(0, 300))
def test_completed_messages_do_not_count(cuts: list[int], count: int) -> None:
    feed(b"".join(publish(number) + release(number) for number in range(1, count + 1)), cuts)


@settings(max_examples=examples(50))
@given(CUTS)
def test_incomplete_messages_are_limited(cuts: list[int]) -> None:
    feed(b"".join(publish(number) for number in range(1, 65)), cuts)
    with pytest.raises(ConnectionError, match="QoS 2"):
        feed(b"".join(publish(number) for number in range(1, 66)), cuts)
    large = bytes((4 << 20) - 100)
    with pytest.raises(ConnectionError, match="QoS 2"):
        feed(b"".join(publish(number, large) for number in range(1, 7)), cuts)


@pytest.mark.parametrize("count", [(4 << 20) + 1, 1 << 24, (1 << 28) - 1])
def test_a_huge_packet_is_refused_at_its_header(count: int) -> None:
    size = bytes((count >> 7 * place & 127) | (128 if place < 3 else 0) for place in range(4))
    limits = PacketLimits()
    limits.pass_on(b"\x30" + size[:3])
    with pytest.raises(ConnectionError, match=f"a packet of {count} bytes"):
        limits.pass_on(size[3:])
