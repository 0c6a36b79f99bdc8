"""Controllers of rotorcraft, on a quadrotor with a rigid body."""

import math

import pytest

from pymorse import MorseServiceFailed, MorseServicePreempted

SCENE = """
robot = Quadrotor()
robot.translate(0, 0, 20)
robot.rotate(0, 0, {yaw})
robot._bpy_object.game.damping = 0.0
robot._bpy_object.game.rotation_damping = 0.0
motion = {motion}
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


def load(simulate, motion, yaw=0.0):
    return simulate(SCENE.format(motion=motion, yaw=yaw), sockets=False)


def body(sim):
    return sim.context.component("robot").bge_object


def pose(sim):
    return sim.robot.pose.get()


def turned(a, b):
    return math.remainder(a - b, 2.0 * math.pi)


# -- attitude ------------------------------------------------------------------------------


def hover_share(sim):
    return body(sim).mass * 9.81 / 40.0


@pytest.mark.parametrize("linear", [True, False])
def test_the_hover_thrust_carries_the_weight(simulate, linear):
    sim = load(simulate, f"RotorcraftAttitude(); motion.properties(LinearThrust={linear})")
    share = hover_share(sim)
    sim.robot.motion.publish({"thrust": share if linear else math.sqrt(share)})
    sim.step(120)
    assert body(sim).worldLinearVelocity.length < 0.2
    sim.robot.motion.publish({"thrust": 0.0})
    sim.step(60)
    assert body(sim).worldLinearVelocity[2] == pytest.approx(-9.81, rel=0.05)


@pytest.mark.parametrize(("roll", "pitch"), [(0.2, 0.0), (0.0, 0.15), (-0.1, -0.2)])
def test_roll_and_pitch_are_those_of_autopilots(simulate, roll, pitch):
    sim = load(simulate, "RotorcraftAttitude()")
    sim.robot.motion.publish({"thrust": hover_share(sim), "roll": roll, "pitch": pitch})
    sim.step(180)
    data = pose(sim)
    # to the right, and nose up, in axes with Y to the left
    assert (data["roll"], data["pitch"]) == pytest.approx((roll, -pitch), abs=0.01)
    sideways = body(sim).worldLinearVelocity
    assert sideways[1] * roll <= 0.0
    assert sideways[0] * pitch <= 0.0


def test_a_yaw_rate_turns_to_the_right(simulate):
    sim = load(simulate, "RotorcraftAttitude()", yaw=0.5)
    sim.robot.motion.publish({"thrust": hover_share(sim)})
    sim.step(60)
    assert pose(sim)["yaw"] == pytest.approx(0.5, abs=0.01)
    sim.robot.motion.publish({"thrust": hover_share(sim), "yaw": 0.4})
    sim.step(360)
    begun = pose(sim)["yaw"]
    sim.step(59)
    assert turned(pose(sim)["yaw"], begun) == pytest.approx(-0.4, abs=0.02)


def test_a_yaw_angle_is_held(simulate):
    sim = load(simulate, "RotorcraftAttitude(); motion.properties(YawRateControl=False)")
    sim.robot.motion.publish({"thrust": hover_share(sim), "yaw": 1.0})
    sim.step(360)
    assert pose(sim)["yaw"] == pytest.approx(-1.0, abs=0.02)


def test_a_yaw_angle_against_north(simulate):
    motion = "RotorcraftAttitude(); motion.properties(YawRateControl=False, UseAngleAgainstNorth=True)"
    sim = simulate(
        SCENE.format(motion=motion, yaw=0.5) + "env = Environment('empty')\nenv.properties(angle_against_north=0.3)",
        sockets=False,
    )
    sim.robot.motion.publish({"thrust": hover_share(sim), "yaw": 1.0})
    sim.step(420)
    # X of the world is 0.3 rad to the left of east; the heading is measured from north, clockwise
    assert pose(sim)["yaw"] == pytest.approx(math.pi / 2 - 1.0 - 0.3, abs=0.02)


# -- velocity ------------------------------------------------------------------------------


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_it_flies_at_the_velocity_asked_for_along_its_heading(simulate, yaw):
    sim = load(simulate, "RotorcraftVelocity()", yaw=yaw)
    sim.robot.motion.setvel(1.0, -0.5, 0.3, 0.0).result()
    sim.step(60 * 30)
    v = body(sim).worldLinearVelocity
    c, s = math.cos(yaw), math.sin(yaw)
    assert v[:] == pytest.approx((c + 0.5 * s, s - 0.5 * c, 0.3), abs=0.06)
    assert turned(pose(sim)["yaw"], yaw) == pytest.approx(0.0, abs=0.02)


def test_it_hovers_when_it_is_told_nothing(simulate):
    sim = load(simulate, "RotorcraftVelocity()")
    sim.step(300)
    assert body(sim).worldLinearVelocity.length < 0.05
    assert pose(sim)["z"] == pytest.approx(20.0, abs=0.1)


def test_a_positive_yaw_rate_turns_to_the_right(simulate):
    sim = load(simulate, "RotorcraftVelocity()")
    sim.robot.motion.setvel(0.0, 0.0, 0.0, 0.5).result()
    sim.step(180)
    begun = pose(sim)["yaw"]
    sim.step(59)
    assert turned(pose(sim)["yaw"], begun) == pytest.approx(-0.5, abs=0.02)


def test_as_a_twist_a_positive_yaw_rate_turns_to_the_left(simulate):
    from morse.core.kinds.binding import bind

    sim = load(simulate, "RotorcraftVelocity()")
    (twist,) = bind(sim.context.component("robot.motion"))
    fields, _ = twist.scatter({"linear": [1.0, 2.0, 3.0], "angular": [0.0, 0.0, 0.4]})
    assert fields == pytest.approx({"vx": 1.0, "vy": 2.0, "vz": 3.0, "vyaw": -0.4})


def test_it_banks_by_no_more_than_it_may(simulate):
    sim = load(simulate, "RotorcraftVelocity(); motion.properties(MaxBankAngle=0.1)")
    sim.robot.motion.publish({"vx": 50.0})
    steepest = 0.0
    for _ in range(180):
        sim.step()
        steepest = max(steepest, abs(sim.context.component("robot.pose").local_data["pitch"]))
    assert 0.05 < steepest < 0.15


# -- waypoint ------------------------------------------------------------------------------


@pytest.mark.parametrize("yaw", [0.0, -2.0])
def test_it_flies_to_a_place_and_a_heading(simulate, yaw):
    sim = load(simulate, "RotorcraftWaypoint()", yaw=yaw)
    sim.step(60)
    assert sim.robot.motion.get_status().result() == "Arrived"
    assert pose(sim)["z"] == pytest.approx(20.0, abs=0.1)
    answer = sim.robot.motion.goto(5.0, -3.0, 24.0, 1.0, 0.3)
    sim.step(10)
    assert sim.robot.motion.get_status().result() == "Transit"
    assert answer.result(60.0) == "Arrived"
    sim.step(60 * 30)
    data = pose(sim)
    # it holds the position
    assert (data["x"], data["y"], data["z"]) == pytest.approx((5.0, -3.0, 24.0), abs=0.1)
    assert turned(data["yaw"], 1.0) == pytest.approx(0.0, abs=0.03)


def test_without_remaining_the_rotors_stop_there(simulate):
    sim = load(simulate, "RotorcraftWaypoint(); motion.properties(RemainAtDestination=False)")
    sim.step(2)
    assert sim.robot.motion.get_status().result() == "Arrived"
    falling = [body(sim).worldLinearVelocity[2]]
    sim.step(6)
    falling.append(body(sim).worldLinearVelocity[2])
    assert falling[1] - falling[0] == pytest.approx(-9.81 * 0.1, rel=0.1)


def test_a_new_goto_preempts_and_a_cancelled_one_holds_the_place(simulate):
    sim = load(simulate, "RotorcraftWaypoint()")
    first = sim.robot.motion.goto(50.0, 0.0, 20.0, 0.0)
    sim.step(120)
    second = sim.robot.motion.goto(0.0, 50.0, 20.0, 0.0)
    with pytest.raises(MorseServicePreempted):
        first.result(1.0)
    sim.step(120)
    second.cancel()
    with pytest.raises(MorseServicePreempted):
        second.result(1.0)
    target = dict(sim.context.component("robot.motion").local_data)
    sim.step(60 * 40)
    data = pose(sim)
    assert (data["x"], data["y"]) == pytest.approx((target["x"], target["y"]), abs=0.2)
    assert sim.robot.motion.get_status().result() == "Stop"


def test_a_place_that_is_none_is_refused(simulate):
    sim = load(simulate, "RotorcraftWaypoint()")
    with pytest.raises(MorseServiceFailed):
        sim.robot.motion.goto(math.inf, 0.0, 0.0, 0.0).result()


def test_the_marker_is_put_to_the_place(simulate):
    sim = simulate(SCENE.format(motion="RotorcraftWaypoint()", yaw=0.0) + "flag = Sphere('wp_target')\n", sockets=False)
    sim.robot.motion.setdest(1.0, 2.0, 23.0, 0.0).result()
    sim.step(2)
    assert sim.context.world.game_object("wp_target").worldPosition == pytest.approx((1.0, 2.0, 23.0), abs=1e-6)


# -- rotors --------------------------------------------------------------------------------


def hover_speed(sim):
    return math.sqrt(body(sim).mass * 9.81 / (4.0 * 9.169e-6))


@pytest.mark.parametrize("configuration", ["+", "x"])
def test_four_equal_rotors_carry_the_weight(simulate, configuration):
    sim = load(simulate, f"QuadrotorDynamicControl(); motion.properties(Configuration='{configuration}')")
    sim.robot.motion.publish({"engines": [hover_speed(sim)] * 4})
    sim.step(60)
    assert body(sim).worldLinearVelocity.length < 0.2
    assert body(sim).worldAngularVelocity.length < 1e-6


@pytest.mark.parametrize(
    ("configuration", "signs"),
    [
        ("+", [(0, 1, -1), (-1, 0, 1), (0, -1, -1), (1, 0, 1)]),
        ("x", [(1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1)]),
    ],
)
def test_a_rotor_turns_the_robot(simulate, configuration, signs):
    for rotor, (x, y, z) in enumerate(signs):
        sim = load(simulate, f"QuadrotorDynamicControl(); motion.properties(Configuration='{configuration}')")
        inertia = body(sim).localInertia
        engines = [0.0] * 4
        engines[rotor] = 300.0
        sim.robot.motion.publish({"engines": engines})
        sim.step(2)
        lever = 0.18 * (1.0 if configuration == "+" else math.sqrt(0.5))
        force = 9.169e-6 * 300.0**2
        torque = (x * lever * force, y * lever * force, z * 2.4e-7 * 300.0**2)
        expected = [t / i * 2 / 60 for t, i in zip(torque, inertia, strict=True)]
        assert body(sim).localAngularVelocity[:] == pytest.approx(expected, abs=2e-3)


# -- with an autopilot ---------------------------------------------------------------------


def test_the_stabilized_quadrotor_takes_its_height(simulate):
    sim = load(simulate, "StabilizedQuadrotor()")
    sim.robot.motion.set_cons(0.0, 0.0, 0.0, 22.0).result()
    sim.step(60)
    # h'' = 9 (h_c - h) - 4.2 h': damped at 0.7, 3 rad/s
    w, d = 3.0, 0.7
    t, root = 60 / 60, math.sqrt(1.0 - d * d)
    step = 1.0 - math.exp(-d * w * t) * (math.cos(root * w * t) + d / root * math.sin(root * w * t))
    assert pose(sim)["z"] == pytest.approx(20.0 + 2.0 * step, abs=0.06)
    sim.step(300)
    assert pose(sim)["z"] == pytest.approx(22.0, abs=0.01)


def test_its_angles_follow_a_filter_and_its_yaw_a_rate(simulate):
    sim = load(simulate, "StabilizedQuadrotor()")
    sim.robot.motion.set_cons(0.1, -0.2, 0.0, 20.0).result()
    sim.step(120)
    data = pose(sim)
    assert (data["roll"], data["pitch"], data["yaw"]) == pytest.approx((0.1, -0.2, 0.0), abs=1e-3)
    sim.robot.motion.set_cons(0.0, 0.0, 0.07, 20.0).result()
    sim.step(120)
    begun = pose(sim)["yaw"]
    sim.step(59)
    assert pose(sim)["yaw"] - begun == pytest.approx(-0.07 * 10.0 / 1.4, abs=0.005)


def test_banked_it_accelerates_sideways(simulate):
    sim = load(simulate, "StabilizedQuadrotor()")
    sim.robot.motion.set_cons(0.0, 0.1, 0.0, 20.0).result()
    sim.step(120)
    before = pose(sim)["x"]
    sim.step(29)
    between = pose(sim)["x"]
    sim.step(29)
    after = pose(sim)["x"]
    # the vertical part of the lift equals the weight: 10 tan(pitch)
    assert (after - 2 * between + before) / 0.25 == pytest.approx(10.0 * math.tan(0.1), rel=0.05)


def test_stopped_it_stays_at_its_height_and_switched_off_it_falls(simulate):
    sim = load(simulate, "StabilizedQuadrotor()")
    sim.robot.motion.set_cons(0.0, 0.0, 0.0, 20.0).result()
    sim.step(60)
    sim.robot.motion.stop().result()
    sim.step(120)
    assert pose(sim)["z"] == pytest.approx(20.0, abs=0.01)
    sim.deactivate("robot.motion")
    sim.step(60)
    assert pose(sim)["z"] < 17.0
