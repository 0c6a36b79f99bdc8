"""Contacts as booleans, impulses and events."""

import math

import numpy as np
import pytest
from many_scenes import arena, block, body

import morse

SPEED, MASS = 3.0, 2.0


def free_ball():
    """A ball without a motor, 1 m above the floor and 1 m from a wall, without gravity for it."""
    from morse.builder import Environment, ForceTorque, Pose, Robot, Sphere

    robot = Robot(name="ball")
    shape = Sphere("shape")
    shape.scale = (0.1, 0.1, 0.1)
    game = shape._bpy_object.game
    game.physics_type, game.collision_bounds_type, game.use_collision_bounds = "RIGID_BODY", "SPHERE", True
    robot.append(shape)
    robot.set_rigid_body()
    robot.set_mass(MASS)
    robot.translate(0.0, 0.0, 1.0)
    robot.append(ForceTorque("push"))
    robot.append(Pose("pose"))
    wall = block("Wall", 1.0, 0.0, 0.1, 2.0)
    wall.scale = (0.1, 2.0, 3.0)
    Environment("empty")


def test_the_impulse_is_the_change_of_momentum():
    with morse.load(free_ball) as sim:
        ball = sim.ball.component.bge_object
        contacts = sim.ball.contacts()
        ball.set_velocity([SPEED, 0.0, 0.0], [0.0, 0.0, 0.0])
        begin, before, total = sim.time(), np.array(ball.velocity()[0]), 0.0
        while sim.ticks < 30:
            sim.step(1)
            total += contacts.impulse
            if total and not contacts.touched:
                break
        fall = np.array([0.0, 0.0, -9.81]) * (sim.time() - begin)
        change = MASS * (np.array(ball.velocity()[0]) - before - fall)
    assert change[0] < -MASS * SPEED
    assert total == pytest.approx(np.linalg.norm(change), rel=0.02)


def test_the_floor_does_not_count_and_the_other_body_is_named():
    with morse.load(arena) as sim:
        contacts = sim.contacts("robot")
        heard = []
        contacts.subscribe(heard.append)
        sim.robot.motion.publish({"v": 0.0, "w": 0.5})
        sim.step(60)
        assert not contacts.touched
        assert contacts.impulse == 0.0
        sim.robot.motion.publish({"v": 2.0, "w": 0.0})
        sim.step(180)
        assert contacts.touched
        assert contacts.impulse > 0.0
        assert {contact.other for contact in contacts.events} <= {f"Wall{k}" for k in range(4)}
        assert [contact.other for contact in heard] == [contact.other for contact in contacts.events]
        assert all(math.isfinite(contact.begin) and contact.begin > 1.0 for contact in heard)
        sim.robot.motion.publish({"v": -1.0, "w": 0.0})
        sim.step(30)
        assert contacts.events[0].end is not None
        sim.step(1)
        assert not contacts.touched


def test_a_touch_within_a_step_is_not_lost():
    with morse.load(arena) as sim:
        contacts = sim.robot.contacts()
        sim.place("robot", [1.65, 0.0, 0.0])
        sim.step(1)
        sim.robot.motion.publish({"v": 3.0, "w": 0.0})
        sim.step(3)
        sim.robot.motion.publish({"v": -3.0, "w": 0.0})
        touched_while_there = contacts.touched
        sim.step(20)
        assert touched_while_there or contacts.touched
        sim.step(5)
        assert not contacts.touched


def test_a_sleeping_body_still_touches_what_it_leans_on():
    def leaning():
        from morse.builder import Environment, Robot

        robot = Robot(name="lower")
        body(robot, mass=5.0)
        upper = Robot(name="upper")
        body(upper, mass=1.0, radius=0.1)
        upper.translate(0.0, 0.0, 0.31)
        Environment("empty")

    with morse.load(leaning) as sim:
        contacts = sim.upper.contacts()
        sim.step(600)
        rest = contacts.impulse
        assert [contact.other for contact in contacts.events if contact.end is None] == ["lower"]
        sim.step(60)
        # it carries its weight for one second
        assert contacts.impulse == pytest.approx(1.0 * 9.81, rel=0.1)
        assert rest > 0.0
        state = sim.save()
        sim.restore(state)
        sim.step(60)
        assert contacts.impulse == pytest.approx(1.0 * 9.81, rel=0.1)


def test_watching_changes_nothing():
    hashes = []
    for watches in (False, True):
        with morse.load(arena, seed=1) as sim:
            if watches:
                sim.robot.contacts()
            sim.robot.motion.publish({"v": 1.5, "w": 0.4})
            sim.step(200)
            hashes.append(sim.state_hash())
    assert hashes[0] == hashes[1]


def test_a_robot_that_is_placed_leaves_its_contacts_behind():
    with morse.load(arena) as sim:
        contacts, wall = sim.robot.contacts(), None
        sim.robot.motion.publish({"v": 2.0, "w": 0.0})
        for _ in range(300):
            sim.step(1)
            if contacts.touched:
                wall = contacts.events[0]
                break
        assert wall is not None
        touching, arrived = sim.contacts(wall.other), sim.time()
        sim.step(1)
        assert touching.touched
        sim.place("robot", [0.0, 0.0, 0.0])
        assert wall.end == pytest.approx(arrived + 1.0 / 60.0)
        sim.step(6)
        assert not contacts.touched
        assert not touching.touched


def test_contacts_of_a_batch():
    with morse.batch(arena, 3) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        drive[:] = [[2.0, 0.0], [0.0, 0.0], [-2.0, 0.0]]
        many.step(90)
        assert hit.tolist() == [True, False, True]
        assert hit.impulse.shape == (3,)
        assert (np.asarray(hit.impulse) > 0.0).tolist() == [True, False, True]
        many.restart(0)
        assert hit.tolist() == [False, False, True]
