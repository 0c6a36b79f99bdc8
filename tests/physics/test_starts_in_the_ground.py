"""Robots from files that start with their legs below the floor are put on it."""

import logging
from pathlib import Path

import pytest

import morse

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
