"""ArduPilot's backend for MORSE in closed loop: scenes as its examples, controllers that know what it parses only."""

import math
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from ardupilot_peer import Peer

import morse
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
vehicle = {robot}()
vehicle.properties(Object=True, Graspable=False, Label="Vehicle")
vehicle.translate(x=0.0, z={height})
imu = IMU(); vehicle.append(imu)
gps = GPS(); vehicle.append(gps)
velocity = Velocity(); vehicle.append(velocity)
pose = Pose(); vehicle.append(pose)
all_sensors = CompoundSensor([imu, gps, velocity, pose])
all_sensors.add_stream('socket', port={ports[0]})
vehicle.append(all_sensors)
motion = {motion}()
vehicle.append(motion)
motion.add_stream('socket', port={ports[1]})
env = Environment('empty', fastmode=True)
env.properties(longitude=149.165230, latitude=-35.363261, altitude=584.0)
"""


@pytest.fixture
def backend(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    running: list[Any] = []

    def load(robot: str, motion: str, height: float) -> tuple[Any, Peer]:
        probes = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
        ports = [probe.getsockname()[1] for probe in probes]
        for probe in probes:
            probe.close()
        script = SCENE.format(robot=robot, motion=motion, height=height, ports=ports)
        (tmp_path / "scene.py").write_text(script)
        running.append(morse.load(tmp_path / "scene.py", sockets=True))
        running.append(Peer(*ports))
        return running[0], running[1]

    yield load
    for one in reversed(running):
        one.close()


def states(sim: Any, peer: Peer, ticks: int) -> Iterator[dict[str, Any]]:
    """The state after each tick, as soon as the connections stand."""
    is_connected = False
    (reader,) = next(
        one.streams["vehicle.motion"] for one in sim.observers if "vehicle.motion" in getattr(one, "streams", ())
    )
    for _ in range(ticks):
        sim.step()
        end = time.monotonic() + 60.0
        state = peer.receive()
        while is_connected and (state is None or state["timestamp"] < sim.clock.time - 1e-6):
            assert time.monotonic() < end, "no line comes"
            state = peer.receive() or state
        if state is not None:
            is_connected = True
            yield state
            # the controls of this tick take part in the next one, as in the lock-step of the backend
            wait_until(lambda: not peer.has_sent or reader.waiting)
            peer.has_sent = False


def test_a_rover_drives_round_a_square(backend: Callable[..., Any]) -> None:
    sim, peer = backend("Hummer", "SteerForce", 1.0)
    corners = [(25.0, 0.0), (25.0, 25.0), (0.0, 25.0), (0.0, 0.0)]
    start: list[float] | None = None
    for state in states(sim, peer, 120 * 60):
        x, y, _ = state["position"]
        if start is None:
            start = [x, y]
        north, east = corners[0][0] - (x - start[0]), corners[0][1] - (y - start[1])
        if math.hypot(north, east) < 3.0:
            del corners[0]
            if not corners:
                break
            continue
        # the Hummer of MORSE looks along its Y axis
        heading = state["yaw"] - 0.5 * math.pi
        error = math.remainder(math.atan2(east, north) - heading, math.tau)
        speed = math.hypot(*state["world_linear_velocity"][:2])
        # a positive steer turns to the left, a negative force drives forward
        peer.drive(max(-0.6, min(-error, 0.6)), max(-2000.0, min(-1000.0 * (3.0 - speed), 0.0)))
    assert not corners


def test_a_quadrotor_takes_off_and_hovers(backend: Callable[..., Any]) -> None:
    sim, peer = backend("Quadrotor", "QuadrotorDynamicControl", 0.2)
    track: list[float] = []
    first: float | None = None
    # thrust of the hover, and the shares that turn it; squares of speeds, (rad/s)^2
    hover = 2.0 * 9.81 / (4.0 * 9.169e-6)
    for state in states(sim, peer, 12 * 60):
        if first is None:
            first = state["position"][2]
        height = first - state["position"][2]
        track.append(height)
        north, east, down = state["world_linear_velocity"]
        p, q, r = state["angular_velocity"]
        yaw = state["yaw"]
        forward = math.cos(yaw) * north + math.sin(yaw) * east
        rightward = math.cos(yaw) * east - math.sin(yaw) * north
        pitch, roll = max(-0.2, min(0.1 * forward, 0.2)), max(-0.2, min(-0.1 * rightward, 0.2))
        up = hover * max(0.5, min(1.0 + 0.15 * (2.0 - height) + 0.3 * down, 1.5))
        turn = [60_000.0 * (roll - state["roll"]) - 20_000.0 * p, 60_000.0 * (pitch - state["pitch"]) - 20_000.0 * q]
        spin = 30_000.0 * r
        squares = (up - turn[0] - spin, up + turn[0] - spin, up + turn[1] + spin, up - turn[1] + spin)
        peer.fly(*(math.sqrt(max(0.0, square)) for square in squares))
    assert len(track) > 500, "a line in each tick"
    assert track[-120:] == pytest.approx([2.0] * 120, abs=0.15)
    body = sim.world.game_object("vehicle")
    assert math.hypot(*(float(v) for v in body.world_pose()[0][:2])) < 1.0
