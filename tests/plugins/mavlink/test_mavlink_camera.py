"""The camera protocol and MAVLink FTP, by pymavlink: photos are taken and downloaded, nothing is written."""

import io
import math
import struct
import zlib
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from PIL import Image
from test_mavlink_flight import ACCEPTED, ARM, DENIED, NAN, TAKEOFF, UNSUPPORTED, station

__all__ = ["station"]

pytestmark = pytest.mark.long

CAMERA, AUTOPILOT = 100, 1
#: MAV_RESULT_TEMPORARILY_REJECTED
BUSY = 1
REQUEST, START, STOP, BY_DISTANCE, FORMAT, MODE = 512, 2000, 2001, 206, 526, 530
INFORMATION, SETTINGS, STORAGE, STATUS, CAPTURED, STREAM = 259, 260, 261, 262, 263, 269
#: of MAVLink FTP
LIST, OPEN, READ, CREATE, WRITE, REMOVE, CRC, BURST, ACK, NAK = 3, 4, 5, 6, 7, 8, 14, 15, 128, 129
END, UNKNOWN, PROTECTED, NOT_FOUND, NO_SESSION = 6, 7, 9, 10, 4
BODY = (
    "robot = Quadrotor(); robot.translate(z=0.2)\ngoal = RotorcraftWaypoint(); robot.append(goal)\n"
    "eye = VideoCamera(); eye.properties(cam_width=64, cam_height=48); robot.append(eye)\n"
    "depth = DepthCamera(); depth.properties(cam_width=16, cam_height=16); robot.append(depth)\n"
    "robot.add_default_interface('mavlink')"
)


class Ftp:
    """A client of MAVLink FTP."""

    def __init__(self, ground: Any) -> None:
        self.ground, self.number = ground, 7

    def send(self, operation: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int = -1) -> None:
        self.number += 1
        length = len(data) if size < 0 else size
        head = struct.pack("<HBBBBBxI", self.number, session, operation, length, 0, 0, offset)
        self.ground.send("file_transfer_protocol", 0, 1, 1, list((head + data).ljust(251, b"\0")))

    def ask(self, operation: int, data: bytes = b"", **options: int) -> Any:
        """Code, session, data of the answer."""
        self.send(operation, data, **options)
        payload = bytes(self.ground.last("FILE_TRANSFER_PROTOCOL").payload)
        number, at, code, length, asked, *_ = struct.unpack("<HBBBBBxI", payload[:12])
        assert (number, asked) == (self.number + 1, operation)
        return code, at, payload[12 : 12 + length]


@pytest.fixture
def ground(station: Callable[..., Any]) -> Any:
    one = station(BODY, fastmode=False)
    # the second heartbeat comes from the camera
    one.until(lambda: any(m.get_srcComponent() == CAMERA for m in one.heard))
    one.step(60)
    return one


def ask(ground: Any, number: int) -> Any:
    assert ground.command(REQUEST, number, component=CAMERA) == ACCEPTED
    return ground.last_of(number)


@pytest.mark.peer("pymavlink", does="a photo is taken, described, downloaded and deleted")
def test_a_photo(ground: Any) -> None:
    beats = [m for m in ground.heard if m.get_type() == "HEARTBEAT" and m.get_srcComponent() != AUTOPILOT]
    assert {(m.get_srcComponent(), m.type, m.autopilot) for m in beats} == {(CAMERA, 30, 8)}, "one with colours"
    senders = [m.get_srcComponent() for m in ground.heard if m.get_type() == "HEARTBEAT"]
    assert senders[-4:] == [CAMERA, AUTOPILOT] * 2, "the heartbeat of the vehicle is the last one"
    information = ask(ground, INFORMATION)
    assert bytes(information.vendor_name).rstrip(b"\0") == b"MORSE"
    assert (information.resolution_h, information.resolution_v) == (64, 48)
    assert information.sensor_size_h / information.sensor_size_v == pytest.approx(64 / 48)
    assert information.flags == 2, "it takes images, and nothing else"
    assert ask(ground, SETTINGS).mode_id == 0
    assert ask(ground, STATUS).image_count == 0
    assert ground.command(START, 0.0, 0.0, 1.0, component=CAMERA) == ACCEPTED
    photo = ground.seen.get((1, "CAMERA_IMAGE_CAPTURED")) or ground.last("CAMERA_IMAGE_CAPTURED")
    assert (photo.image_index, photo.capture_result) == (0, 1)
    assert photo.lat == pytest.approx(47.397742e7, abs=100)
    assert abs(photo.q[0]) == pytest.approx(1.0, abs=0.01), "it looks north"
    assert ask(ground, STATUS).image_count == 1
    assert ask(ground, STORAGE).used_capacity > 0.0
    # the file
    ftp = Ftp(ground)
    path = photo.file_url.removeprefix("mftp://").encode()
    code, session, data = ftp.ask(OPEN, path)
    assert code == ACK
    (size,) = struct.unpack("<I", data)
    content = b""
    while (answer := ftp.ask(READ, session=session, offset=len(content), size=239))[0] == ACK:
        content += answer[2]
    assert (answer[0], answer[2]) == (NAK, bytes((END,)))
    assert len(content) == size
    assert Image.open(io.BytesIO(content)).size == (64, 48)
    assert ftp.ask(CRC, path)[2] == struct.pack("<I", zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF)
    assert ftp.ask(LIST, b"/")[2] == b"DDCIM\0"
    folder, _, name = path.rpartition(b"/")
    assert ftp.ask(LIST, folder)[2] == b"F%s\t%d\0" % (name, size)
    ground.heard.clear()
    ftp.send(BURST, session=session, size=239)
    ground.step(3)
    parts = [bytes(m.payload) for m in ground.heard if m.get_type() == "FILE_TRANSFER_PROTOCOL"]
    assert b"".join(p[12 : 12 + p[4]] for p in parts if p[3] == ACK) == content[: 32 * 239]
    # it is listed again, and deleted
    assert ground.command(REQUEST, CAPTURED, 0.0, component=CAMERA) == ACCEPTED
    assert ground.command(REQUEST, CAPTURED, 1.0, component=CAMERA) == DENIED
    assert ground.command(FORMAT, 1.0, 1.0, component=CAMERA) == ACCEPTED
    assert ftp.ask(OPEN, path)[::2] == (NAK, bytes((NOT_FOUND,)))


def test_a_camera_takes_one_sequence_of_photos_at_a_time(ground: Any) -> None:
    def photos() -> int:
        return sum(m.get_type() == "CAMERA_IMAGE_CAPTURED" for m in ground.heard)

    ground.heard.clear()
    assert ground.command(START, 0.0, 0.5, 4.0, component=CAMERA) == ACCEPTED
    answers = {ground.command(START, *rest, component=CAMERA) for rest in ((0.0, 0.5, 4.0), (0.0, 0.0, 1.0, 5.0)) * 5}
    assert answers == {BUSY}
    ground.step(180)
    assert photos() == 4, "the sequence went on, and nothing was added"
    # a single photo whose command is sent again, because its answer was lost
    ground.heard.clear()
    assert {ground.command(START, 0.0, 0.0, 1.0, 7.0, component=CAMERA) for _ in range(5)} == {ACCEPTED}
    ground.step(30)
    assert photos() == 1
    # single photos as fast as they are asked for: at most ten a second
    ground.heard.clear()
    begin = ground.sim.clock.time
    answers = {ground.command(START, 0.0, 0.0, 1.0, 0.0, component=CAMERA) for _ in range(60)}
    assert answers == {ACCEPTED, BUSY}
    ground.step(30)
    assert 1 <= photos() <= 1 + (ground.sim.clock.time - begin) / 0.1
    # what the end of a sequence leaves is not in the way of the next one
    assert ground.command(START, 0.0, 1000.0, 2.0, component=CAMERA) == ACCEPTED
    assert ground.command(STOP, component=CAMERA) == ACCEPTED
    ground.heard.clear()
    ground.step(30)
    assert ground.command(START, 0.0, 0.0, 1.0, 8.0, component=CAMERA) == ACCEPTED
    ground.step(30)
    assert photos() == 1


def test_photos_at_intervals_and_by_distance(ground: Any) -> None:
    ground.heard.clear()
    begin = ground.sim.clock.time
    assert ground.command(START, 0.0, 0.5, 4.0, component=CAMERA) == ACCEPTED
    ground.step(180)
    photos = [m for m in ground.heard if m.get_type() == "CAMERA_IMAGE_CAPTURED"]
    assert [m.image_index for m in photos] == [0, 1, 2, 3]
    assert photos[-1].time_boot_ms - photos[0].time_boot_ms == pytest.approx(1500.0, abs=40.0)
    assert photos[0].time_boot_ms / 1000.0 - begin < 0.2
    # what arrives at the autopilot goes to the camera: 3 m up are one photo each metre
    assert ground.command(BY_DISTANCE, 1.0) == ACCEPTED
    assert ground.command(ARM, 1.0) == ACCEPTED
    ground.send("param_set", 1, 1, b"MIS_TAKEOFF_ALT", 3.7, 9)
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: ground.last("LOCAL_POSITION_NED").z < -3.5)
    heights = [m.relative_alt / 1000.0 for m in ground.heard if m.get_type() == "CAMERA_IMAGE_CAPTURED"][4:]
    assert heights == pytest.approx([1.0, 2.0, 3.0], abs=0.3)
    assert ground.command(STOP, component=CAMERA) == ACCEPTED


def test_a_mission_takes_photos(ground: Any) -> None:
    items = [(2, START, 0.0, 0.0, 1.0, 0.0, 0, 0, 0.0), (1, 16, 0.0, 0.0, 0.0, NAN, 20_000, 0, -3.0)]
    assert ground.upload(items) == ACCEPTED
    ground.heard.clear()
    assert ground.command(300) == ACCEPTED
    ground.until(lambda: any(m.get_type() == "CAMERA_IMAGE_CAPTURED" for m in ground.heard))


@pytest.mark.peer("pymavlink", does="what a camera does not have is refused, and a file is only read")
def test_nothing_else_is_promised_and_no_number_harms(ground: Any) -> None:
    for number in (STREAM, 270, 271, 276, 395, 1e9, -1.0, NAN, math.inf):
        assert ground.command(REQUEST, number, component=CAMERA) == UNSUPPORTED
    for command in (2500, 2501, 2502, 2503, 531, 532, 2004, 2005, 529):
        assert ground.command(command, component=CAMERA) == UNSUPPORTED
    assert ground.command(MODE, 0.0, 1.0, component=CAMERA) == DENIED, "there is no video"
    for wrong in (NAN, math.inf, -1.0, 3e38):
        assert ground.command(START, 0.0, wrong, 1.0, component=CAMERA) == DENIED
        assert ground.command(START, 0.0, 1.0, wrong, component=CAMERA) == DENIED
        assert ground.command(BY_DISTANCE, wrong, component=CAMERA) == DENIED
        assert ground.command(REQUEST, CAPTURED, wrong, component=CAMERA) == DENIED
    # a component that does not exist refuses too, by its name
    assert ground.command(42600, component=169) == UNSUPPORTED
    ftp = Ftp(ground)
    for operation in (CREATE, WRITE, REMOVE, 9, 10, 11, 12, 13):
        assert ftp.ask(operation, b"/x")[::2] == (NAK, bytes((PROTECTED,)))
    assert ftp.ask(99)[::2] == (NAK, bytes((UNKNOWN,)))
    assert ftp.ask(READ, session=3, size=239)[::2] == (NAK, bytes((NO_SESSION,)))
    assert ftp.ask(READ, size=255)[0] == NAK
    assert ftp.ask(LIST, b"/etc")[::2] == (NAK, bytes((NOT_FOUND,)))
    assert ftp.ask(OPEN, b"../../etc/hostname")[::2] == (NAK, bytes((NOT_FOUND,)))
    assert ftp.ask(OPEN, b"\xff\xfe")[::2] == (NAK, bytes((NOT_FOUND,)))
    # as many photos as it likes: at most ten in a second
    assert ground.command(START, 0.0, 0.0, 0.0, component=CAMERA) == ACCEPTED
    ground.heard.clear()
    ground.step(120)
    assert 15 <= len([m for m in ground.heard if m.get_type() == "CAMERA_IMAGE_CAPTURED"]) <= 21
    assert ground.command(STOP, component=CAMERA) == ACCEPTED
    for _ in range(40):
        assert ground.command(START, 0.0, 1.0, 1.0, component=CAMERA) in (ACCEPTED, BUSY)
