"""Arms that move on robots that drive: they hinder nothing, they push, and they are saved."""

import contextlib
import json
import math
import socket
import time

import pytest

import morse

SCENE = """
robot = ATRV()
motion = MotionVW()
robot.append(motion)
arm = KukaLWR()
arm.translate(z={height})
robot.append(arm)
pose = Pose()
robot.append(pose)
tip = Pose()
arm.append(tip)
{more}
"""
BOX = """
box = Cube('box')
box.scale = (0.2, 0.2, 0.2)
box.location = (0.95, 0.65, 0.2)
box._bpy_object.game.physics_type = 'RIGID_BODY'
box._bpy_object.game.use_collision_bounds = True
box._bpy_object.game.collision_bounds_type = 'BOX'
"""


def measured(sim, name="robot.pose"):
    return dict(sim.context.component(name).local_data)


def glides(sim):
    return len(sim.context.world.gliding.glides)


def swing(sim, ticks, speed=0.5, rate=0.2):
    """Drive, and swing all joints; return how many ticks the robot glided."""
    sim.context.component("robot.motion").local_data.update(v=speed, w=rate)
    arm, glided = sim.context.component("robot.arm"), 0
    for _ in range(ticks):
        angle = 0.4 * math.sin(2.0 * sim.context.clock.time)
        arm.local_data.update(dict.fromkeys(arm.joints, angle))
        sim.step()
        glided += glides(sim)
    return glided


def test_a_moving_arm_does_not_keep_its_robot_from_gliding_along_its_arc(simulate):
    sim = simulate(SCENE.format(height=0.7, more=""), sockets=False)
    sim.step(60)
    x, y, yaw = (measured(sim)[field] for field in ("x", "y", "yaw"))
    assert swing(sim, 120) > 100
    there, radius, turned = measured(sim), 0.5 / 0.2, 0.2 * 2.0
    assert there["yaw"] - yaw == pytest.approx(turned, abs=1e-3)
    assert there["x"] - x == pytest.approx(radius * math.sin(turned), abs=5e-3)
    assert there["y"] - y == pytest.approx(radius * (1.0 - math.cos(turned)), abs=5e-3)
    # the tip is where the joints put it
    tip, values = measured(sim, "robot.arm.tip"), sim.context.component("robot.arm").joint_values
    assert tip["z"] > there["z"] + 0.7
    assert max(map(abs, values)) > 0.1


def test_an_arm_on_a_gliding_robot_pushes_what_it_meets(simulate):
    sim = simulate(SCENE.format(height=-0.1, more=BOX), sockets=False)
    sim.robot.arm.set_rotation("kuka_2", -math.pi / 2 - 0.02).result()
    sim.step(120)
    box = sim.context.world.objects_by_name["box"]
    before = list(box.worldPosition)
    sim.robot.motion.set_speed(0.2, 0.0).result()
    sim.robot.arm.rotate("kuka_1", 1.2, 0.6)
    sim.step(150)
    after = list(box.worldPosition)
    assert math.dist(before[:2], after[:2]) > 0.05
    assert after[2] == pytest.approx(0.2, abs=0.05)


def test_an_arm_that_reaches_for_the_floor_is_carried_by_it(simulate):
    """A gliding robot collides with no floor: with an arm that presses on the floor it has to stand."""
    sim = simulate(SCENE.format(height=-0.1, more=""), sockets=False)
    sim.step(60)
    sim.robot.motion.set_speed(0.3, 0.0).result()
    sim.step(60)
    assert glides(sim)
    # its tip would be half a metre below the floor
    sim.robot.arm.rotate("kuka_2", -2.0, 0.8)
    sim.step(180)
    assert not glides(sim)
    leaning = measured(sim)
    assert abs(leaning["pitch"]) > 0.02 or leaning["z"] > 0.15


def test_a_saved_state_goes_on_with_the_same_bits(simulate, tmp_path):
    script = SCENE.format(height=0.7, more=BOX)
    sim = simulate(script, sockets=False)
    sim.step(30)
    swing(sim, 40)
    state = sim.save()
    swing(sim, 40)
    ahead, place = sim.state_hash(), measured(sim, "robot.arm.tip")
    sim.restore(state)
    swing(sim, 40)
    assert sim.state_hash() == ahead
    other = simulate(script, sockets=False)
    other.restore(state)
    swing(other, 40)
    assert other.state_hash() == ahead
    assert measured(other, "robot.arm.tip") == place


def test_after_a_restart_everything_is_as_at_the_start(simulate):
    sim = simulate(SCENE.format(height=0.7, more=""), sockets=False)
    sim.step(30)
    swing(sim, 40)
    first, tip = sim.state_hash(), measured(sim, "robot.arm.tip")
    sim.restart()
    sim.step(30)
    swing(sim, 40)
    assert measured(sim, "robot.arm.tip") == tip
    assert sim.state_hash() == first


# -- a client that calls a service and disconnects stops nothing -----------------------------------

CLIENT_GONE_SCENE = """
from morse.builder import *
robot = {robot}()
robot.translate(0, 0, {height})
motion = {actuator}()
robot.append(motion)
motion.add_service('socket')
env = Environment('empty')
"""


def port(sim):
    managers = sim.context.services.request_managers().values()
    return next(manager.port for manager in managers if hasattr(manager, "port"))


def tick_until(sim, done):
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        if done():
            return
        sim.step()
        time.sleep(0.0005)
    pytest.fail("it did not happen")


@pytest.mark.parametrize(
    ("robot", "height", "actuator", "service", "arguments", "arrived"),
    [
        ("Morsy", 0, "Waypoint", "goto", [3.0, 0.0, 0.0], lambda c: c.robot_parent.move_status == "Arrived"),
        (
            "Quadrotor",
            10,
            "RotorcraftWaypoint",
            "goto",
            [1.0, 0.0, 10.0, 0.0],
            lambda c: c.robot_parent.move_status == "Arrived",
        ),
        ("ATRV", 0, "KukaLWR", "rotate", ["kuka_2", 0.5], lambda c: abs(c.joint_values[1] - 0.5) < 0.011),
        (
            "ATRV",
            0,
            "PTU",
            "set_pan_tilt",
            [1.0, 0.2],
            lambda c: abs(c.pan - 1.0) < 0.011 and abs(c.tilt - 0.2) < 0.011,
        ),
    ],
)
def test_what_was_begun_goes_on(tmp_path, monkeypatch, robot, height, actuator, service, arguments, arrived):
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    path = tmp_path / "scene.py"
    path.write_text(CLIENT_GONE_SCENE.format(robot=robot, height=height, actuator=actuator))
    with morse.load(path, sockets=True) as sim:
        component = sim.context.component("robot.motion")
        with socket.create_connection(("127.0.0.1", port(sim)), timeout=60) as client:
            client.sendall(f"1 robot.motion {service} {json.dumps(arguments)}\n".encode())
            tick_until(sim, lambda: component.running_service == service)
        tick_until(sim, lambda: component.running_service is None and arrived(component))
        # the next client gets an answer
        with socket.create_connection(("127.0.0.1", port(sim)), timeout=60) as client:
            client.sendall(b"2 robot.motion get_properties []\n")
            client.setblocking(False)
            heard = bytearray()

            def answered():
                with contextlib.suppress(BlockingIOError):
                    heard.extend(client.recv(65536))
                return b"\n" in heard

            tick_until(sim, answered)
            assert heard.startswith(b"2 SUCCESS")
