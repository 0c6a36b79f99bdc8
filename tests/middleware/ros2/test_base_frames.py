"""The frames of a robot whose file has the layout of mobile bases: base_footprint carries base_link."""

from pathlib import Path

import pytest

import morse
from morse.rosmsgs.moving import joints_of
from morse.rosmsgs.names import Names

INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
LINK = '<link name="{}"><inertial><mass value="1"/>' + INERTIA + "</inertial></link>"
JOINT = """<joint name="to_{1}" type="{2}"><parent link="{0}"/><child link="{1}"/><origin xyz="0 0 0.1"/>
  <axis xyz="0 1 0"/></joint>"""
LAYOUTS = {
    "base_footprint": (("base_footprint", "base_link", "fixed"), ("base_link", "wheel", "continuous")),
    "base_link": (("base_link", "mast", "fixed"), ("base_link", "wheel", "continuous")),
    "chassis": (("chassis", "wheel", "continuous"), ("chassis", "base_link", "fixed")),
    "moved": (("root", "turret", "continuous"), ("turret", "base_link", "fixed")),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_frames_are_a_tree(tmp_path: Path, layout: str) -> None:
    joints = LAYOUTS[layout]
    links = list(dict.fromkeys(link for one in joints for link in one[:2]))
    text = "".join([*(LINK.format(link) for link in links), *(JOINT.format(*one) for one in joints)])
    (tmp_path / "rover.urdf").write_text(f'<robot name="rover">{text}</robot>')
    file = str(tmp_path / "rover.urdf")
    scene = f"from morse.builder import *\nrobot = Robot({file!r})\nenv = Environment('empty')\n"
    (tmp_path / "scene.py").write_text(scene)
    with morse.load(tmp_path / "scene.py") as sim:
        robot = sim.robot.component
        names = Names({"namespace": None, "frame_prefix": ""})
        parents: dict[str, str] = {names.base(robot): names.odom(robot)}
        for joint in joints_of(robot, names):
            assert joint.frame not in parents, "a frame has one parent"
            parents[joint.frame] = joint.parent
        assert set(parents) == set(links)
        for frame in parents:
            path = [frame]
            while path[-1] in parents:
                path.append(parents[path[-1]])
                assert len(path) <= len(parents) + 1, f"a loop: {path}"
            assert path[-1] == "odom"
