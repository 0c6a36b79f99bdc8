"""Images and clouds are encoded beside the ticks of a simulation that is paced by the wall clock."""

import math
import threading
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from morse.middleware.ros2.datastream import Ros2DatastreamManager

#: wall-clock seconds after which the encoding goes on, and number of ticks that should end before
LIMIT, ENOUGH = 60.0, 3
CAMERA = """
camera = VideoCamera("camera"); camera.properties(cam_width=32, cam_height=24); camera.frequency(60)
camera.translate(z=1.5); robot.append(camera)
"""
IMAGE = "/robot/camera/image"


def test_a_tick_does_not_wait_until_an_image_is_encoded(
    start: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    later, flush = threading.Event(), Ros2DatastreamManager.flush
    waited: list[bool] = []
    ends: list[int] = []

    def slowly(type_name: str, message: Any) -> bytes:
        if type_name == "sensor_msgs/msg/CompressedImage":
            waited.append(later.wait(LIMIT))
        return encode(type_name, message)

    def counted(manager: Any) -> None:
        flush(manager)
        if waited or not desk.takes_threads:
            return
        ends.append(sim.ticks)
        if len(ends) > 2 * ENOUGH:
            later.set()

    monkeypatch.setattr(Ros2DatastreamManager, "flush", counted)
    sim, desk = start(CAMERA.replace("frequency(60)", "frequency(30)"))
    encode, desk.encode = desk.encode, slowly
    desk.takes_threads = True
    sim.run(0.5)
    sim.close()
    # the first image waited until later ticks had ended
    assert waited[0]
    assert len(ends) > ENOUGH


def test_images_come_in_their_order_and_none_is_left(start: Callable[..., Any]) -> None:
    sim, desk = start(CAMERA)
    desk.takes_threads = True
    sim.run(0.5)
    sim.close()
    type_name, _, publisher = desk.publishers[IMAGE]
    stamps = [desk.store.deserialize_cdr(data, type_name).header.stamp for data in publisher.sent]
    times = [stamp.sec + stamp.nanosec * 1e-9 for stamp in stamps]
    assert times == sorted(times)
    assert len(set(times)) == len(times) == 30
    assert not [thread for thread in threading.enumerate() if thread.name == "morse-ros2-images"]


@pytest.mark.parametrize("fast", [False, True], ids=["stepped", "as fast as possible"])
def test_a_simulation_that_is_not_paced_has_sent_the_images_of_a_tick_when_it_ends(
    start: Callable[..., Any], fast: bool
) -> None:
    sim, desk = start(CAMERA)
    desk.takes_threads = True
    sim.run(0.1)
    sent = desk.publishers[IMAGE][2].sent
    before = len(sent)
    for count in (1, 2):
        if fast:
            sim.run(1 / 60, speed=math.inf)
        else:
            sim.step()
        assert len(sent) >= before + count


def test_a_camera_that_has_stopped_capturing_sends_its_last_image(start: Callable[..., Any]) -> None:
    sim, desk = start(CAMERA)
    desk.takes_threads = True
    camera = sim.context.components["robot.camera"]
    camera.capturing = False
    sim.run(0.1)
    sent = desk.publishers[IMAGE][2].sent
    assert not sent
    camera.capture(lambda outcome: None, 1)
    sim.run(0.2)
    sim.close()
    assert len(sent) == 1


@pytest.mark.parametrize(("rate", "wanted"), [(20.0, 20), (25.0, 25), (500.0, 60), (None, 60)])
def test_transforms_have_the_rate_of_the_option(start: Callable[..., Any], rate: float | None, wanted: int) -> None:
    options = "" if rate is None else f'env.configure_stream_manager("ros2", tf_rate={rate})'
    sim, desk = start("robot.append(Pose('pose'))", options)
    sim.step(60)
    type_name, _, publisher = desk.publishers["/tf"]
    # the message of time 0 is never sent, so that one may be missing
    assert abs(len(publisher.sent) - wanted) <= 1
    stamps = [desk.store.deserialize_cdr(data, type_name).transforms[0].header.stamp for data in publisher.sent]
    times = [stamp.sec + stamp.nanosec * 1e-9 for stamp in stamps]
    gaps = [after - before for before, after in pairwise(times)]
    assert max(gaps) <= 1 / min(wanted, 60) + 1 / 60 + 1e-6
