"""The waypoint actuator: it arrives, turns by its control law, and drives around obstacles."""

import math

import pytest

from pymorse import MorseServiceFailed, MorseServicePreempted

SCENE = """
robot = Morsy()
motion = Waypoint()
{more}
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


def scene(more=""):
    return SCENE.format(more=more)


def place(sim):
    sim.step()
    data = sim.robot.pose.get()
    return data["x"], data["y"]


def test_it_stands_and_has_arrived_until_it_is_told_to_go(simulate):
    sim = simulate(scene(), sockets=False)
    sim.step(30)
    assert sim.robot.motion.get_status().result() == "Arrived"
    assert place(sim) == pytest.approx((0, 0), abs=1e-3)


@pytest.mark.parametrize("target", [(4.0, 2.0), (-3.0, 1.0), (0.0, -4.0)])
@pytest.mark.parametrize("control", ["Velocity", "Position"])
def test_goto_ends_within_the_tolerance(simulate, target, control):
    sim = simulate(scene(f"motion.properties(ControlType='{control}')"), sockets=False)
    answer = sim.robot.motion.goto(*target, 0.0, 0.3, 1.0)
    sim.step(10)
    assert sim.robot.motion.get_status().result() == "Transit"
    assert answer.result(30.0) == "Arrived"
    assert math.dist(place(sim), target) <= 0.3 + 0.02
    sim.step(60)
    assert math.dist(place(sim), target) <= 0.3 + 0.02


def test_straight_ahead_it_takes_distance_over_speed(simulate):
    sim = simulate(scene(), sockets=False)
    sim.step(30)
    start = sim.time()
    sim.robot.motion.goto(5.0, 0.0, 0.0, 0.5, 1.5).result(20.0)
    assert sim.time() - start == pytest.approx(4.5 / 1.5, abs=0.1)


def test_it_turns_on_the_spot_at_half_its_speed_as_long_as_the_heading_is_far_wrong(simulate):
    sim = simulate(scene(), sockets=False)
    sim.step(30)
    sim.robot.motion.publish({"x": -10.0, "y": 1e-3, "speed": 0.8})
    sim.step(60)
    data = sim.robot.pose.get()
    assert data["yaw"] == pytest.approx(0.4 * 59 / 60, abs=0.02)
    assert math.hypot(data["x"], data["y"]) < 5e-3


def test_a_heading_that_is_little_wrong_is_left(simulate):
    sim = simulate(scene("motion.properties(AngleTolerance=0.2)"), sockets=False)
    sim.step(30)
    sim.robot.motion.publish({"x": 10.0, "y": 10.0 * math.tan(0.15)})
    sim.step(60)
    assert sim.robot.pose.get()["yaw"] == pytest.approx(0.0, abs=1e-3)


def test_stop_and_resume_leave_a_goto_pending(simulate):
    sim = simulate(scene(), sockets=False)
    answer = sim.robot.motion.goto(4.0, 0.0, 0.0, 0.5, 1.0)
    sim.step(60)
    assert sim.robot.motion.stop().result() == "Stop"
    # no command brakes the robot: it rolls out
    sim.step(30)
    stopped = place(sim)
    sim.step(60)
    assert place(sim) == pytest.approx(stopped, abs=1e-3)
    assert sim.robot.motion.get_status().result() == "Stop"
    assert answer.running()
    assert sim.robot.motion.resume().result() == "Transit"
    assert answer.result(10.0) == "Arrived"


def test_setdest_tells_whether_it_is_there_already(simulate):
    sim = simulate(scene(), sockets=False)
    assert sim.robot.motion.setdest(0.1, 0.0, 0.0, 0.5).result() is False
    assert sim.robot.motion.setdest(2.0, 0.0, 0.0, 0.5, 1.0).result() is True
    sim.step(150)
    assert sim.robot.motion.get_status().result() == "Arrived"


def test_a_new_goto_preempts_the_old_one(simulate):
    sim = simulate(scene(), sockets=False)
    first = sim.robot.motion.goto(10.0, 0.0, 0.0)
    sim.step(30)
    second = sim.robot.motion.goto(0.0, 2.0, 0.0)
    with pytest.raises(MorseServicePreempted):
        first.result(1.0)
    assert second.result(20.0) == "Arrived"


def test_cancelled_it_stays_where_it_is(simulate):
    sim = simulate(scene(), sockets=False)
    answer = sim.robot.motion.goto(10.0, 0.0, 0.0)
    sim.step(60)
    answer.cancel()
    with pytest.raises(MorseServicePreempted):
        answer.result(1.0)
    here = place(sim)
    sim.step(60)
    assert place(sim) == pytest.approx(here, abs=0.03)
    assert sim.robot.motion.get_status().result() == "Stop"


@pytest.mark.parametrize("wrong", [(math.nan, 0.0, 0.0), (1e30, 0.0, 0.0), (1.0, 0.0, 0.0, -1.0), ("far", 0.0, 0.0)])
def test_a_place_that_is_none_is_refused(simulate, wrong):
    sim = simulate(scene(), sockets=False)
    sim.step(5)
    with pytest.raises(MorseServiceFailed):
        sim.robot.motion.goto(*wrong).result()
    sim.step(30)
    assert place(sim) == pytest.approx((0, 0), abs=1e-3)


@pytest.mark.parametrize("robot", ["ATRV", "Pioneer3DX"])
def test_robots_of_other_kinds_arrive(simulate, robot):
    sim = simulate(scene().replace("Morsy()", f"{robot}()"), sockets=False)
    assert sim.robot.motion.goto(3.0, 1.5, 0.0, 0.3, 0.8).result(30.0) == "Arrived"
    assert math.dist(place(sim), (3.0, 1.5)) <= 0.33


def test_with_free_z_an_aircraft_climbs_in_a_straight_line(simulate):
    sim = simulate(
        scene("motion.properties(FreeZ=True, ObstacleAvoidance=False)").replace("Morsy", "RMax"), sockets=False
    )
    assert sim.robot.motion.goto(6.0, 0.0, 3.0, 0.2, 1.0).result(30.0) == "Arrived"
    data = sim.robot.pose.get()
    assert math.dist((data["x"], data["y"], data["z"]), (6.0, 0.0, 3.0)) <= 0.23
    halfway = sim.time()
    # 6.7 m less the tolerance, at 1 m/s
    assert halfway == pytest.approx(math.hypot(6.0, 3.0) - 0.2, abs=0.2)


BOX = """
box = Cube('box')
box.scale = ({0}, {1}, 1.0)
box._bpy_object.game.physics_type = 'STATIC'
box._bpy_object.game.use_collision_bounds = True
box.translate(5.0, {2}, 0.5)
"""


@pytest.mark.parametrize(
    ("half", "aside"), [((0.3, 0.3), 0.0), ((0.5, 1.0), 0.3), ((0.5, 1.0), -0.6), ((0.3, 2.0), 0.2)]
)
def test_it_drives_around_a_box_without_touching_it(simulate, half, aside):
    sim = simulate(scene() + BOX.format(half[0], half[1], aside), sockets=False)
    world = sim.context.world
    answer = sim.robot.motion.goto(10.0, 0.0, 0.0, 0.5, 1.0)
    touched = set()
    for _ in range(60 * 60):
        sim.step()
        touched |= {name for pair in world.contacts() for name in (pair[0].name, pair[1].name)}
        if answer.done():
            break
    assert answer.result(0.1) == "Arrived"
    assert "box" not in touched


def test_without_avoidance_or_with_an_ignored_property_it_runs_into_the_box(simulate):
    for more in ("motion.properties(ObstacleAvoidance=False)", "motion.properties(Ignore='Other, Soft')"):
        sim = simulate(scene(more) + BOX.format(0.5, 1.0, 0.0) + "box.properties(Soft=True)\n", sockets=False)
        sim.robot.motion.publish({"x": 10.0})
        sim.step(60 * 8)
        assert 3.0 < place(sim)[0] < 5.0


def test_the_target_object_marks_the_place(simulate):
    sim = simulate(
        scene("motion.properties(Target='flag')") + "flag = Sphere('flag')\nflag.scale = (0.1, 0.1, 0.1)\n",
        sockets=False,
    )
    sim.robot.motion.publish({"x": 3.0, "y": -2.0, "z": 1.0})
    sim.step(2)
    assert sim.context.world.game_object("flag").worldPosition == pytest.approx((3.0, -2.0, 1.0), abs=1e-6)


def test_saved_on_its_way_it_goes_on_to_the_bit(simulate):
    sim = simulate(scene() + BOX.format(0.5, 1.0, 0.3), sockets=False)
    sim.robot.motion.publish({"x": 10.0})
    sim.step(200)
    state = sim.save()
    sim.step(100)
    expected = place(sim)
    sim.restore(state)
    sim.step(100)
    assert place(sim) == expected
