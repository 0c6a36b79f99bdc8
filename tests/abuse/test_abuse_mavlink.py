"""Floods of a MAVLink link: the time of a tick stays bounded, and the messages of other senders still arrive."""

import socket

from morse.plugins.mavlink.datastream import Intake
from morse.plugins.mavlink.framing import Framer
from morse.plugins.mavlink.links import UdpLink

WANTED = 76  # COMMAND_LONG
#: an empty message of version 1 of that type, with a wrong checksum
EMPTY = bytes([0xFE, 0, 0, 1, 1, WANTED, 0, 0])


def test_a_tick_takes_a_bounded_number_of_messages_from_a_flood() -> None:
    flood = EMPTY * 7_500  # the size of the largest packet of UDP
    intake, framer = Intake(), Framer({WANTED})
    taken = sum(1 for _ in range(64) for _ in intake.frames("flood", framer, flood))
    assert 0 < taken <= 256
    assert intake.lost
    # noise without a single message is not searched either
    noisy, noise = Intake(), Framer({WANTED})
    assert sum(1 for _ in range(64) for _ in noisy.frames("noise", noise, b"\xfe" * 60_000)) == 0
    assert noisy.lost


def test_a_flood_takes_no_room_of_another_sender() -> None:
    intake = Intake()
    list(intake.frames("flood", Framer({WANTED}), EMPTY * 7_500))
    taken = [frame.data for frame in intake.frames("pilot", Framer({WANTED}), EMPTY * 20)]
    assert taken == [EMPTY] * 20


def test_what_an_autopilot_sends_is_taken_as_a_whole() -> None:
    intake, framer = Intake(), Framer({WANTED})
    taken = sum(1 for _ in range(20) for _ in intake.frames("pilot", framer, EMPTY))
    assert taken == 20
    assert not intake.lost


def test_strangers_do_not_displace_a_peer_that_speaks() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    link = UdpLink("udpin", address, socket.AF_INET, listens=True)
    strangers = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(30)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as pilot:
        pilot.settimeout(60.0)
        try:
            for stranger in strangers:
                pilot.sendto(b"x", address)
                stranger.sendto(b"x", address)
                received = 0
                while received < 2:
                    received += sum(1 for _ in link.receive())
            link.send(b"telemetry")
            assert pilot.recv(100) == b"telemetry"
        finally:
            link.close()
            for stranger in strangers:
                stranger.close()
