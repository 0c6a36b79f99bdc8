"""Masses, friction and limits of URDF files."""

import math
from pathlib import Path

import numpy as np
import pytest

from morse.assets.errors import AssetError
from morse.assets.urdf import read_urdf
from morse.scene import PhysicsType

JOINT = """<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="2" effort="{e}"
velocity="{v}"/><dynamics damping="0.3" friction="0.1"/></joint>"""


def robot(tmp_path: Path, inertial: str, joint: str = JOINT.format(e=5, v=3), base='<mass value="3"/>'):
    file = tmp_path / "robot.urdf"
    file.write_text(
        f'<robot name="r"><link name="a"><inertial>{base}</inertial></link><link name="b"><inertial>{inertial}'
        f"</inertial></link>{joint}</robot>"
    )
    return read_urdf(file)


def link_of(library, name="b"):
    return next(node for node in library.nodes() if node.name == name)


def tensor(*moments: float) -> str:
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    return "<inertia " + " ".join(f'{n}="{m}"' for n, m in zip(names, moments, strict=True)) + "/>"


def test_an_inertia_is_turned_into_the_axes_of_the_link(tmp_path: Path) -> None:
    library = robot(
        tmp_path, f'<origin xyz="1 2 3" rpy="0 0 {math.pi / 2}"/><mass value="2"/>{tensor(0.1, 0.2, 0.25, 0, 0, 0)}'
    )
    inertial = link_of(library).inertial
    assert inertial.mass == 2.0
    assert inertial.centre == (1.0, 2.0, 3.0)
    assert np.reshape(inertial.inertia, (3, 3)) == pytest.approx(np.diag([0.2, 0.1, 0.25]), abs=1e-12)
    assert library.warnings == []


def test_dynamics_and_limits_of_joints(tmp_path: Path) -> None:
    (bone,) = robot(tmp_path, '<mass value="2"/>').roots[0].children[0].bones
    moves = bone.dynamics
    assert (moves.damping, moves.friction, moves.effort, moves.speed, moves.limited) == (0.3, 0.1, 5.0, 3.0, True)
    # no number stands for no limit
    (bone,) = robot(tmp_path, '<mass value="2"/>', JOINT.format(e=0, v=0)).roots[0].children[0].bones
    assert (bone.dynamics.effort, bone.dynamics.speed) == (math.inf, math.inf)


def test_a_mass_without_inertia_is_that_of_a_ball_of_water(tmp_path: Path) -> None:
    inertial = link_of(robot(tmp_path, '<mass value="4.18879"/>')).inertial
    # a ball of 0.1 m radius has 4.18879 kg
    assert inertial.inertia[0] == pytest.approx(0.4 * 4.18879 * 0.01, rel=1e-5)


@pytest.mark.parametrize(
    ("moments", "words"),
    [
        ((0.1, 0.1, 0.5, 0, 0, 0), "none can be larger than the sum"),
        ((0.1, -0.1, 0.1, 0, 0, 0), "expected positive"),
        ((0.1, 0.1, 0.1, 0.5, 0, 0), "expected positive"),
    ],
)
def test_an_inertia_that_no_body_has_is_mended_and_said(tmp_path: Path, moments: tuple[float, ...], words: str) -> None:
    library = robot(tmp_path, f'<mass value="2"/>{tensor(*moments)}')
    (warning,) = library.warnings
    assert "the link 'b'" in warning
    assert words in warning
    values = np.linalg.eigvalsh(np.reshape(link_of(library).inertial.inertia, (3, 3)))
    assert values[0] > 0.0
    assert values[2] <= (values[0] + values[1]) * 1.001


def test_an_inertia_that_is_no_number_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match=r"robot\.urdf.*ixx='nan'"):
        robot(tmp_path, f'<mass value="2"/>{tensor(math.nan, 1, 1, 0, 0, 0)}')


def test_a_robot_whose_base_has_no_mass_is_bolted(tmp_path: Path) -> None:
    assert robot(tmp_path, '<mass value="2"/>', base='<mass value="0"/>').roots[0].body.type is PhysicsType.STATIC
    assert robot(tmp_path, '<mass value="2"/>').roots[0].body.type is PhysicsType.RIGID_BODY


def test_too_many_joints_in_a_row_are_refused(tmp_path: Path) -> None:
    count = 300
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(count - 1)
    )
    file = tmp_path / "long.urdf"
    file.write_text(f"<robot name='long'>{links}{joints}</robot>")
    with pytest.raises(AssetError, match="more than 200 joints in a chain"):
        read_urdf(file)


def test_entities_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "bomb.urdf"
    file.write_text(
        '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><robot name="&b;"/>'
    )
    with pytest.raises(AssetError, match="defines the entity 'a'"):
        read_urdf(file)
