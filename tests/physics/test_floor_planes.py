"""Robots on wheels touch the plane of a floor only while they are above the floor."""

import logging
from pathlib import Path

import mujoco
import pytest
from test_wheels import RADIUS, TRACK, wheeled
from worlds import box as box_of
from worlds import ground, node, run, scene

import morse
from morse.physics import World
from morse.physics.gliding.feet import PlaneBuilder

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


# -- robots from files that start with their legs below the floor are put on it --------------------

#: distance from the origin, in the trunk, to the feet, m
LEG = 0.5
LEGS = "".join(
    f'<link name="leg{n}"><collision><origin xyz="0 0 -0.25"/><geometry><cylinder radius="0.02" length="{LEG}"/>'
    '</geometry></collision><inertial><mass value="0.3"/><inertia ixx="0.006" iyy="0.006" izz="0.001" ixy="0" ixz="0" '
    f'iyz="0"/></inertial></link><joint name="hip{n}" type="revolute"><parent link="trunk"/><child link="leg{n}"/>'
    f'<origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="30" velocity="5"/></joint>'
    for n, (x, y) in enumerate(((0.2, 0.15), (0.2, -0.15), (-0.2, 0.15), (-0.2, -0.15)))
)
DOG = f"""<robot name="dog"><link name="trunk"><collision><geometry><box size="0.5 0.3 0.1"/></geometry></collision>
<inertial><mass value="5"/><inertia ixx="0.04" iyy="0.1" izz="0.14" ixy="0" ixz="0" iyz="0"/></inertial></link>{LEGS}
</robot>"""
STEP = """<robot name="step"><link name="s"><collision><geometry><box size="0.2 2 0.6"/></geometry></collision></link>
</robot>"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z={height})
robot.append(Pose("pose"))
env = Environment("empty")
"""


@pytest.mark.parametrize("height", [0.0, 0.2, LEG - 0.16])
def test_legs_are_put_on_the_floor(tmp_path: Path, caplog: pytest.LogCaptureFixture, height: float) -> None:
    (tmp_path / "dog.urdf").write_text(DOG)
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "dog.urdf"), height=height))
    with caplog.at_level(logging.WARNING), morse.load(script) as sim:
        sim.step(120)
        pose = sim.robot.pose.get()
        assert pose["z"] == pytest.approx(LEG, abs=0.02)
        assert (pose["x"], pose["y"], pose["roll"], pose["pitch"]) == pytest.approx((0.0,) * 4, abs=0.02)
    assert "robots start inside the ground, and are put on it: 'robot' by" in caplog.text


def test_a_robot_on_the_floor_or_beside_a_step_stays(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "dog.urdf").write_text(DOG)
    (tmp_path / "step.urdf").write_text(STEP)
    script = tmp_path / "scene.py"
    more = f"step = Robot({str(tmp_path / 'step.urdf')!r})\nstep.set_physics_type('STATIC')\n"
    # the front legs overlap the step by 4 cm
    more += "step.translate(x=0.28, z=0.3)\n"
    script.write_text(SCENE.format(file=str(tmp_path / "dog.urdf"), height=LEG) + more)
    with caplog.at_level(logging.WARNING), morse.load(script) as sim:
        sim.step(60)
        assert sim.robot.pose.get()["z"] == pytest.approx(LEG, abs=0.03)
    assert "put on it" not in caplog.text


@pytest.mark.parametrize("floor", ["", '<geom type="plane" size="5 5 0.1"/>'], ids=["no_floor", "floor"])
def test_an_mjcf_file_with_a_floor_places_its_robot(tmp_path: Path, floor: str) -> None:
    (tmp_path / "post.xml").write_text(
        f'<mujoco><worldbody>{floor}<body name="post" pos="0 0 0.2"><freejoint/><geom type="cylinder" size="0.3 0.5"/>'
        "</body></worldbody></mujoco>"
    )
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "post.xml"), height=0.0))
    with morse.load(script) as sim:
        start = float(sim.world.data.qpos[2])
    assert start == pytest.approx(0.2 if floor else 0.5, abs=0.02)


FEET = "".join(
    f"""<link name="f{x}{y}"><collision><origin xyz="0 0 {0.02 - LEG}"/><geometry><box size="0.08 0.06 0.04"/>
  </geometry></collision></link><joint name="jf{x}{y}" type="fixed"><parent link="trunk"/><child link="f{x}{y}"/>
  <origin xyz="{x} {y} 0"/></joint>"""
    for x in (-0.2, 0.2)
    for y in (-0.1, 0.1)
)
FOUR_FEET = f"""<robot name="feet"><link name="trunk">
<inertial><mass value="5"/><inertia ixx="0.04" iyy="0.1" izz="0.14" ixy="0" ixz="0" iyz="0"/></inertial></link>{FEET}
</robot>"""


@pytest.mark.parametrize("height", [0.0, 0.1])
def test_feet_that_are_below_a_thin_floor_are_put_on_it(tmp_path: Path, height: float) -> None:
    """Nothing else of the robot collides, so that nothing touches the floor."""
    (tmp_path / "feet.urdf").write_text(FOUR_FEET)
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "feet.urdf"), height=height))
    with morse.load(script) as sim:
        sim.step(60)
        pose = sim.robot.pose.get()
        assert pose["z"] == pytest.approx(LEG, abs=0.005)
        assert (pose["x"], pose["y"], pose["roll"], pose["pitch"]) == pytest.approx((0.0,) * 4, abs=0.005)


@pytest.mark.parametrize("height", [0.0, 0.1])
def test_feet_below_a_thin_floor_that_something_higher_touches_are_put_on_it(tmp_path: Path, height: float) -> None:
    """The thighs of straight legs touch the floor, so that the robot was raised by these alone, and stuck in it."""
    thigh = '<collision><origin xyz="0 0 -0.1"/><geometry><box size="0.3 0.1 0.1"/></geometry></collision>'
    (tmp_path / "feet.urdf").write_text(FOUR_FEET.replace('<link name="trunk">', f'<link name="trunk">{thigh}'))
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "feet.urdf"), height=height))
    with morse.load(script) as sim:
        sim.step(60)
        pose = sim.robot.pose.get()
        assert pose["z"] == pytest.approx(LEG, abs=0.005)
        assert (pose["x"], pose["y"], pose["roll"], pose["pitch"]) == pytest.approx((0.0,) * 4, abs=0.005)


def test_a_robot_that_stands_astride_something_stays(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "feet.urdf").write_text(FOUR_FEET)
    (tmp_path / "step.urdf").write_text(STEP)
    more = f"step = Robot({str(tmp_path / 'step.urdf')!r})\nstep.set_physics_type('STATIC')\n"
    more += f"step.translate(z={LEG - 0.35})\n"
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(tmp_path / "feet.urdf"), height=LEG) + more)
    with caplog.at_level(logging.WARNING), morse.load(script) as sim:
        sim.step(30)
        assert sim.robot.pose.get()["z"] == pytest.approx(LEG, abs=0.005)
    assert "put on it" not in caplog.text
