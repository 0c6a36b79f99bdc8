"""GPS receivers that send NMEA 0183, and clients that do not read it."""

import contextlib
import math
import os
import select
import socket
import sys
import time

import pytest

from morse.plugins.nmea.datastream import angle, sentence, sentences
from tests.kit.waiting import wait_until

SCENE = """
robot = ATRV()
motion = MotionVW('motion')
robot.append(motion)
gps = GPS('gps')
gps.level({level!r})
gps.add_stream('nmea', {options})
robot.append(gps)
env = Environment('empty', fastmode=True)
env.properties(longitude=-1.4, latitude=43.6, altitude=100.0)
env.set_start_date('2026-03-01 23:59:58')
env.configure_stream_manager('nmea', port=0)
"""


@pytest.fixture
def load(load):
    return lambda script: load(script, sockets=True)


@pytest.fixture
def gps(load):
    def start(options="", level="extended"):
        simulation = load(SCENE.format(level=level, options=options))
        (manager,) = (one for one in simulation.context.stream_managers.values() if hasattr(one, "receivers"))
        return simulation, manager.receivers["robot.gps"]

    return start


def fields_of(line: bytes) -> list[str]:
    """The fields of a sentence whose checksum is right: the exclusive or of what is between $ and *."""
    body, _, given = line.decode("ascii").strip().removeprefix("$").partition("*")
    checksum = 0
    for character in body:
        checksum ^= ord(character)
    assert given == f"{checksum:02X}"
    assert len(line) <= 82  # the limit of NMEA 0183
    return body.split(",")


def test_a_reader_with_nothing_to_say_reads_on(gps):
    simulation, receiver = gps()
    with socket.create_connection(("127.0.0.1", receiver.port), 60.0) as client:
        client.shutdown(socket.SHUT_WR)
        wait_until(lambda: receiver.is_read)
        client.setblocking(False)
        read = b""
        end = time.monotonic() + 60.0
        while read.count(b"\r\n") < 30:  # many measurements after the end of its own data
            simulation.step(1)
            with contextlib.suppress(BlockingIOError):
                more = client.recv(1 << 16)
                assert more, "the connection was closed"
                read += more
            assert time.monotonic() < end
    # it has left: the next writes fail, and nobody is read any more
    end = time.monotonic() + 60.0
    while receiver.is_read:
        simulation.step(1)
        time.sleep(0.001)
        assert time.monotonic() < end


def test_the_checksum_is_that_of_the_standard() -> None:
    # the example of the specification of GGA
    assert sentence("GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,").endswith(b"*47\r\n")


@pytest.mark.parametrize(
    ("degrees", "letters", "text"),
    [
        (48.1173, "NS", "4807.03800,N"),
        (-11.516667, "EW", "01131.00002,W"),
        (59.99999999999, "NS", "6000.00000,N"),
        (-0.0, "EW", "00000.00000,E"),
        (-180.0, "EW", "18000.00000,W"),
    ],
)
def test_angles_are_degrees_and_minutes(degrees, letters, text) -> None:
    assert angle(degrees, letters) == text


def test_time_is_rounded_to_the_next_day_as_a_whole() -> None:
    gga, rmc, _ = sentences("GP", 86399.999, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0)).splitlines(True)
    assert fields_of(gga)[1] == "000000.00"
    assert fields_of(rmc)[9] == "020170"


def test_a_client_gets_position_time_speed_and_course(gps) -> None:
    simulation, receiver = gps()
    simulation.robot.motion.publish({"v": 2.0, "w": 0.0})
    with socket.create_connection(("127.0.0.1", receiver.port)) as client:
        wait_until(lambda: receiver.is_read)
        simulation.step(150)
        client.settimeout(60.0)
        stream = client.makefile("rb")
        lines = [fields_of(stream.readline()) for _ in range(3 * 140)]
    seen = {line[0] for line in lines}
    assert seen == {"GPGGA", "GPRMC", "GPVTG"}
    gga = [line for line in lines if line[0] == "GPGGA"][-1]
    rmc = [line for line in lines if line[0] == "GPRMC"][-1]
    # eastward, as the X axis of the world
    assert gga[2:6] == ["4336.00000", "N", rmc[5], "W"]
    assert float(rmc[5]) < 124.0  # 1.4 degrees west are 1 degree and 24 minutes
    assert gga[6] == "1"
    assert float(gga[9]) == pytest.approx(100.0, abs=0.6)
    assert float(rmc[7]) == pytest.approx(2.0 * 3600.0 / 1852.0, rel=1e-3)
    assert float(rmc[8]) == pytest.approx(90.0, abs=0.1)
    # 2.5 s after two seconds to midnight
    assert rmc[9] == "020326"
    assert rmc[1].startswith("000000.")


def test_the_default_level_has_positions_alone(gps) -> None:
    simulation, receiver = gps(level="simple", options="talker='GN'")
    with socket.create_connection(("127.0.0.1", receiver.port)) as client:
        wait_until(lambda: receiver.is_read)
        simulation.step(3)
        client.settimeout(60.0)
        assert fields_of(client.makefile("rb").readline())[0] == "GNGGA"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")
def test_a_pseudo_terminal_is_a_serial_line(gps) -> None:
    simulation, receiver = gps(options="device='pty', baud=38400")
    line = os.open(receiver.path, os.O_RDONLY | os.O_NOCTTY)
    try:
        simulation.step(2)
        assert select.select([line], [], [], 60.0)[0]
        assert fields_of(os.read(line, 4096).splitlines(True)[0])[0] == "GPGGA"
    finally:
        os.close(line)
    simulation.step(600)  # more than fits into the line: nobody reads it any more
    assert simulation.failures == ()
    line = os.open(receiver.path, os.O_RDONLY | os.O_NOCTTY)
    try:
        wait_until(lambda: select.select([line], [], [], 1.0)[0])
        # the first sentence may have lost its beginning
        clock = fields_of(os.read(line, 4096).splitlines(True)[3])[1]
    finally:
        os.close(line)
    # 10 s after the start, at 23:59:58: positions of long ago would be taken for those of now
    assert clock > "000006.00"
    assert clock < "000009.00"


def test_silent_connections_do_not_take_the_place_of_who_reads(gps) -> None:
    simulation, receiver = gps()
    with contextlib.ExitStack() as stack:

        def connected() -> socket.socket:
            return stack.enter_context(socket.create_connection(("127.0.0.1", receiver.port), timeout=60.0))

        reader = connected()
        wait_until(lambda: receiver.is_read)
        reader.sendall(b"\xb5\x62\x06\x08" * 400_000)  # settings for a receiver, without the end of a line
        for _ in range(300):
            connected()
        wait_until(lambda: receiver._server.connected >= 255)
        simulation.step(1)
        assert reader.recv(6) == b"$GPGGA"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no serial lines of this kind")
@pytest.mark.parametrize("device", ["/dev/null", "/no/such/device", __file__])
def test_what_is_no_serial_line_is_named(gps, device) -> None:
    before = os.path.getsize(__file__)
    with pytest.raises(Exception, match=r"not a serial line|cannot be opened"):
        gps(options=f"device={device!r}")
    assert os.path.getsize(__file__) == before


def test_a_component_without_a_place_on_the_earth_is_refused(load) -> None:
    script = SCENE.format(level="simple", options="").replace("env.properties(longitude", "env.properties(x")
    with pytest.raises(Exception, match="has no position on the earth"):
        load(script)


def test_clients_that_never_read_and_many_of_them_cost_the_simulation_nothing(gps) -> None:
    """Each keeps at most what the system and its connection hold; the others get all sentences."""
    simulation, receiver = gps()
    with contextlib.ExitStack() as stack:

        def connected():
            client = socket.socket()
            # a small window: its sentences pile up soon
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            stack.enter_context(contextlib.closing(client))
            client.connect(("127.0.0.1", receiver.port))
            return client

        for number in range(120):
            client = connected()
            with contextlib.suppress(OSError):
                client.sendall([b"", b"GET / HTTP/1.1\r\n\r\n", b"\x00" * 5000, b"$PMTK000*32\r\n"][number % 4])
        wait_until(lambda: receiver.is_read)
        simulation.step(600)
        reader = connected()
        reader.setblocking(False)
        got, end = b"", time.monotonic() + 60.0
        while got.count(b"\r\n") < 10:
            assert time.monotonic() < end
            simulation.step(1)
            with contextlib.suppress(BlockingIOError):
                got += reader.recv(65536)
        assert fields_of(got.splitlines(True)[0])[0].startswith("GP")
        held = [client.transport.get_write_buffer_size() for client in receiver._server.clients]
        assert max(held, default=0) < 1 << 17
    simulation.step(5)
    assert simulation.failures == ()
    assert math.isfinite(simulation.time())
