"""Robots on wheels touch the plane of a floor only while they are above the floor."""

import mujoco
import pytest
from test_wheels import RADIUS, TRACK, wheeled
from worlds import box as box_of
from worlds import ground, node, run, scene

from morse.physics import World
from morse.physics.gliding.plane_builder import PlaneBuilder

#: radius of the wheels, and the compression of a contact under this load, m
AT_REST = pytest.approx(RADIUS, abs=2e-3)


def world(*others, at=(0.0, 0.0)):
    body = wheeled(at=(*at, RADIUS))
    made = scene(ground(), *others, body, robots=[body])
    made.components[0].options["wheels"] = ["robot.Wheel_L", "robot.Wheel_R"]
    return World(made)


def drive(made, v, w=0.0):
    left, right = made.game_object("robot").wheels()

    def command():
        left.set_speed((v - w * TRACK / 2) / RADIUS)
        right.set_speed((v + w * TRACK / 2) / RADIUS)

    return command


def kinds(made):
    """The shapes of floors that something touches."""
    touched = {mujoco.mjtGeom(made.model.geom_type[geom]).name for geom in made.data.contact.geom.ravel()}
    return touched & {"mjGEOM_PLANE", "mjGEOM_BOX"}


def height(made):
    return float(made.game_object("robot").worldPosition.z)


def test_a_robot_far_from_the_edges_touches_the_plane_and_the_plane_is_the_floor():
    made = world()
    run(made, 1.0, drive(made, 0.5, 0.3))
    assert kinds(made) == {"mjGEOM_PLANE"}
    assert {one.name for one, _ in made.contacts()} == {"Ground"}  # the plane belongs to it
    assert height(made) == AT_REST


def test_a_robot_drives_alike_on_the_plane_and_on_the_box(monkeypatch):
    ends = []
    for finish in (PlaneBuilder.finish, lambda _: None):
        monkeypatch.setattr(PlaneBuilder, "finish", finish)
        made = world()
        run(made, 3.0, drive(made, 0.5, 0.4))
        ends.append((kinds(made), tuple(made.game_object("robot").worldPosition)))
    (on_plane, there), (on_box, here) = ends
    assert on_plane == {"mjGEOM_PLANE"}
    assert on_box == {"mjGEOM_BOX"}
    assert there == pytest.approx(here, abs=1e-3)


def test_a_robot_falls_over_the_edge():
    made = world(at=(18.5, 0.0))
    run(made, 4.0, drive(made, 1.0))
    assert height(made) < -1.0


def test_a_robot_that_is_placed_beside_the_floor_falls():
    made = world()
    run(made, 0.5)
    made.game_object("robot").worldPosition = (25.0, 0.0, RADIUS)
    run(made, 1.0)
    # 9.81 / 2 m in a second
    assert height(made) == pytest.approx(RADIUS - 4.905, abs=0.15)


def test_a_robot_below_the_floor_is_not_lifted():
    made = world()
    run(made, 0.5)
    made.game_object("robot").worldPosition = (0.0, 0.0, -2.0)
    run(made, 1.0)
    assert height(made) == pytest.approx(-2.0 - 4.905, abs=0.15)


def test_a_robot_falls_to_a_floor_that_was_lowered():
    made = world()
    run(made, 0.5)
    floor = made.game_object("Ground")
    floor.worldPosition = (0.0, 0.0, -1.5)
    run(made, 2.0)
    assert height(made) == pytest.approx(RADIUS - 1.0, abs=2e-3)
    assert kinds(made) == {"mjGEOM_BOX"}
    made.reset()
    run(made, 1.0)
    assert height(made) == AT_REST
    assert kinds(made) == {"mjGEOM_PLANE"}


def test_a_robot_on_a_platform_stands_on_the_platform():
    made = world(node("Platform", box_of(10, 10, 0.5), at=(0, 0, 1.0)))
    run(made, 0.5)
    assert height(made) == AT_REST, "it is below the platform"
    made.game_object("robot").worldPosition = (0.0, 0.0, 1.25 + RADIUS)
    run(made, 1.0, drive(made, 0.5))
    assert height(made) == pytest.approx(1.25 + RADIUS, abs=2e-3)
    assert kinds(made) == {"mjGEOM_PLANE"}
    run(made, 11.0, drive(made, 1.0))
    assert height(made) == AT_REST, "it has driven over the edge of the platform"


def test_a_run_goes_on_from_a_saved_state_with_the_same_bits():
    made, other = world(at=(18.5, 0.0)), world(at=(18.5, 0.0))
    run(made, 0.8, drive(made, 1.0))
    other.set_state(made.get_state())
    for each in (made, other):
        run(each, 1.5, drive(each, 1.0))
    assert other.data.qpos.tobytes() == made.data.qpos.tobytes()
