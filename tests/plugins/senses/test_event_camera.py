"""The event camera against its formula, and on its way through the simulator."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import morse
from morse.plugins.senses.sensors.event_camera import aer, log_light
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode

SCENE = """
robot = FakeRobot()
robot.translate(z=1.0)
camera = EventCamera()
camera.properties(cam_width=40, cam_height=30, {properties})
robot.append(camera)
Environment("empty")
"""


@pytest.fixture
def camera(load):
    """A camera that is shown images (30, 40) of grey codes: (camera, function that shows one at a time)."""

    def make(**properties):
        given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
        simulation = load(SCENE.format(properties=given))
        sensor = simulation.context.components["robot.camera"]
        sensor._time = -1.0

        def show(codes, time):
            rgba = np.repeat(np.asarray(codes, np.uint8)[..., None], 4, axis=2)
            sensor._exposed = time
            sensor.take(SimpleNamespace(rgba=rgba))
            return sensor.local_data["events"]

        return show

    return make


def linear(code):
    share = code / 255.0
    return (share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4) + 0.002


@pytest.mark.parametrize(("before", "after"), [(80, 160), (200, 60), (10, 240), (100, 105)])
@pytest.mark.parametrize("threshold", [0.1, 0.35])
def test_a_change_gives_delta_ln_i_over_c_events(camera, before, after, threshold):
    show = camera(threshold=threshold)
    assert len(show(np.full((30, 40), before), 0.0)) == 0
    events = show(np.full((30, 40), after), 0.01)
    change = math.log(linear(after) / linear(before))
    number = math.floor(abs(change) / threshold)
    assert len(events) == 30 * 40 * number
    assert (events[:, 3] == math.copysign(1.0, change)).all()
    if number:
        # the logarithm is linear in time
        times = np.unique(events[:, 2].round(9))
        expected = [0.01 * threshold * (index + 1) / abs(change) for index in range(number)]
        assert times == pytest.approx(expected, abs=5e-5)


def test_what_is_left_of_a_change_is_remembered(camera):
    """Many small steps give as many events as a large one."""
    show = camera(threshold=0.2)
    codes = np.linspace(60, 240, 40).round().astype(int)
    counts = sum(len(show(np.full((30, 40), code), 0.01 * index)) for index, code in enumerate(codes))
    assert counts == 1200 * math.floor(math.log(linear(240) / linear(60)) / 0.2)


def test_a_moving_edge_fires_where_it_passes(camera):
    """An edge of the contrast ln(I₂ / I₁) that moves by three columns."""
    show = camera(threshold=0.3)
    first, second = np.full((30, 40), 200), np.full((30, 40), 200)
    first[:, :10], second[:, :13] = 50, 50
    show(first, 0.0)
    events = show(second, 0.01)
    number = math.floor(math.log(linear(200) / linear(50)) / 0.3)
    assert set(events[:, 0]) == {10.0, 11.0, 12.0}
    assert set(events[:, 3]) == {-1.0}
    assert len(events) == 3 * 30 * number


def test_events_are_in_the_order_of_time_and_a_pixel_is_blind_after_an_event(camera):
    show = camera(threshold=0.1, refractory_period=0.004)
    show(np.full((30, 40), 20), 0.0)
    events = show(np.full((30, 40), 250), 0.01)
    assert (np.diff(events[:, 2]) >= 0.0).all()
    of_pixel = events[(events[:, 0] == 7) & (events[:, 1] == 3), 2]
    assert len(of_pixel) >= 2
    assert np.diff(of_pixel).min() >= 0.004 - 1e-12


def test_noise_has_its_rate_and_thresholds_their_deviation(camera):
    show = camera(errors=True, noise_rate=5.0, threshold_deviation=0.0)
    grey = np.full((30, 40), 100)
    show(grey, 0.0)
    counts = [len(show(grey, 0.1 * (index + 1))) for index in range(20)]
    # the tick does not change between these calls, and with it the noise
    assert len(set(counts)) == 1
    assert counts[0] == pytest.approx(5.0 * 0.1 * 1200, abs=4 * math.sqrt(600))


def test_the_number_of_events_has_a_limit(load):
    simulation = load(
        SCENE.format(properties="threshold=0.01").replace(
            "cam_width=40, cam_height=30", ("cam_width=320, cam_height=240")
        )
    )
    sensor = simulation.context.components["robot.camera"]
    for time, code in ((1.0, 5), (2.0, 250)):
        sensor._exposed = time
        sensor.take(SimpleNamespace(rgba=np.full((240, 320, 4), code, np.uint8)))
    assert len(sensor.local_data["events"]) == 100_000
    assert sensor.local_data["lost"] == 320 * 240 * 64 - 100_000


def test_the_light_is_that_of_srgb():
    image = np.array([[[255, 255, 255], [0, 0, 0], [188, 188, 188]]], np.uint8)
    assert np.exp(log_light(image))[0] == pytest.approx([1.002, 0.002, 0.5], abs=0.005)


def test_address_events_have_the_bits_of_a_davis():
    (word, time), (other, _) = aer(np.array([[5.0, 3.0, 0.25, 1.0], [1.0, 0.0, 0.5, -1.0]])).tolist()
    assert (word >> 22 & 0x1FF, word >> 12 & 0x3FF, word >> 11 & 1, time) == (3, 5, 1, 250_000)
    assert other == 1 << 12


def driving_scene():
    from morse.builder import ATRV, Environment, EventCamera, MotionVW

    robot = ATRV()
    motion = MotionVW()
    robot.append(motion)
    camera = EventCamera()
    camera.translate(x=0.6, z=1.2)
    camera.properties(cam_width=64, cam_height=48, errors=True)
    robot.append(camera)
    Environment("indoors-1/boxes").simulator_frequency(100)


def run(simulation, ticks):
    found = []
    for _ in range(ticks):
        simulation.step(1)
        found.append(simulation.robot.camera.data["events"].tobytes())
    return found


@pytest.mark.long
def test_rows_and_restored_states_have_the_bits_of_the_simulation_alone():
    with morse.load(driving_scene, seed=5, sockets=False) as alone:
        alone.robot.motion.publish({"v": 0.5, "w": 0.3})
        alone.step(10)
        state = alone.save()
        expected = run(alone, 10)
        assert sum(map(len, expected)) > 1000
        alone.restore(state)
        assert run(alone, 10) == expected
    with morse.batch(driving_scene, 2, seed=4) as many:
        many[1].robot.motion.publish({"v": 0.5, "w": 0.3})
        many.step(20)
        assert many[1].robot.camera.data["events"].tobytes() == expected[-1]


@pytest.mark.long
def test_packets_are_those_of_event_camera_msgs(tmp_path):
    file = tmp_path / "events.mcap"
    with morse.load(driving_scene, sockets=False, record=str(file)) as simulation:
        simulation.robot.motion.publish({"v": 0.5, "w": 0.3})
        simulation.step(20)
        events = simulation.robot.camera.data["events"]
    with Recording(file) as recording:
        channel = {one.topic: one for one in recording.channels.values()}["/robot/camera"]
        assert channel.type == "event_camera_msgs/msg/EventPacket"
        packet = decode(channel.type, bytes(list(recording.messages({channel.number}))[-1].data))
    words = np.frombuffer(bytes(packet["events"]), "<u8")
    assert (packet["encoding"], packet["width"], packet["height"]) == ("mono", 64, 48)
    assert len(words) == len(events)
    assert (words >> np.uint64(32) & np.uint64(0xFFFF)).tolist() == events[:, 0].tolist()
    assert (words >> np.uint64(48) & np.uint64(0x7FFF)).tolist() == events[:, 1].tolist()
    assert (words >> np.uint64(63)).astype(bool).tolist() == (events[:, 3] > 0).tolist()
    times = (packet["time_base"] + (words & np.uint64(0xFFFFFFFF)).astype(np.int64)) / 1e9
    assert times == pytest.approx(events[:, 2], abs=1e-8)
