"""Colours of robot files are what the programs for these files show: the numbers are those of the screen, sRGB."""

from pathlib import Path

import pytest

from morse.assets import load

#: linear light of 0.5 and 0.2, IEC 61966-2-1
HALF, FIFTH = ((0.5 + 0.055) / 1.055) ** 2.4, ((0.2 + 0.055) / 1.055) ** 2.4
BOX = '<visual><geometry><box size="1 1 1"/></geometry>{}</visual>'
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
TEXTS = {
    "shape.xml": '<mujoco><worldbody><body><geom size="1" rgba="0.5 0.2 1 1"/></body></worldbody></mujoco>',
    "material.xml": '<mujoco><asset><material name="m" rgba="0.5 0.2 1 1"/></asset><worldbody><body>'
    '<geom size="1" material="m"/></body></worldbody></mujoco>',
    "robot.urdf": '<robot name="r"><link name="l">'
    + BOX.format('<material name="m"><color rgba="0.5 0.2 1 1"/></material>')
    + "</link></robot>",
    "mesh.urdf": '<robot name="r"><link name="l"><visual><geometry><mesh filename="mesh.obj"/></geometry></visual>'
    "</link></robot>",
    "model.sdf": '<sdf version="1.9"><model name="m"><link name="l"><visual name="v">'
    "<geometry><box><size>1 1 1</size></box></geometry>"
    "<material><diffuse>0.5 0.2 1 1</diffuse></material></visual></link></model></sdf>",
}


@pytest.mark.parametrize("name", TEXTS)
def test_colors_are_those_of_the_screen(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(TEXTS[name])
    (tmp_path / "mesh.obj").write_text(f"mtllib mesh.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\n")
    (tmp_path / "mesh.mtl").write_text("newmtl m\nKd 0.5 0.2 1\n")
    shown = [node for node in load(tmp_path / name).nodes() if node.mesh is not None]
    (node,) = shown
    material = (*node.materials, *node.mesh.materials)[0]
    # files of colours have eight bits
    assert material.color == pytest.approx((HALF, FIFTH, 1.0, 1.0), abs=5e-3)


def test_a_shape_that_glows_is_as_bright_as_in_its_program(tmp_path: Path) -> None:
    file = tmp_path / "lamp.xml"
    file.write_text(TEXTS["material.xml"].replace('name="m" rgba', 'name="m" emission="0.5" rgba'))
    (node,) = (node for node in load(file).nodes() if node.mesh is not None)
    # MuJoCo adds emission times colour, as numbers of the screen
    assert node.materials[0].emission[2] == pytest.approx(HALF)
