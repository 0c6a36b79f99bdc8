"""``robot_description`` of a robot from a URDF file is this file."""

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from test_base_frames import JOINT, LAYOUTS, LINK

WHEEL = """<joint name="spin" type="continuous"><parent link="base_link"/><child link="wheel"/><axis xyz="0 1 0"/>
<limit effort="7" velocity="9"/></joint>"""
MESHES = """<visual><geometry><mesh filename="part.stl"/></geometry></visual>
<visual><geometry><mesh filename="package://gone/part.stl"/></geometry></visual>"""
#: options of the stream manager, the prefix of frames, and the namespace
OPTIONS = {
    "every name": ("", "rover/", "/rover"),
    "one robot": ("env.configure_stream_manager('ros2', namespace='', frame_prefix='')", "", ""),
}


def scene(file: Path) -> str:
    return f"""rover = Robot({str(file)!r})
rover.translate(x=9.0)
pose = Pose()
rover.append(pose, "base_link")
rover.add_default_interface("ros2")
"""


def tree(model: ElementTree.Element) -> dict[str, str]:
    """Link to its parent; there is one without."""
    links = [link.get("name") for link in model.findall("link")]
    assert len(links) == len(set(links))
    parents = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in model.findall("joint")}
    assert len(parents) == len(model.findall("joint"))
    assert len(set(links) - set(parents)) == 1
    assert set(parents.values()) <= set(links)
    return parents


@pytest.mark.parametrize("layout", LAYOUTS)
def test_it_is_a_tree(start: Callable, tmp_path: Path, layout: str) -> None:
    links = list(dict.fromkeys(link for one in LAYOUTS[layout] for link in one[:2]))
    text = "".join([*(LINK.format(link) for link in links), *(JOINT.format(*one) for one in LAYOUTS[layout])])
    (tmp_path / "rover.urdf").write_text(f'<robot name="rover">{text}</robot>')
    sim, desk = start(scene(tmp_path / "rover.urdf"))
    sim.step(3)
    parents = tree(ElementTree.fromstring(desk.last("/rover/robot_description").data))
    assert {f"rover/{link}" for link in links} <= {*parents, *parents.values()}
    assert "rover/pose" in parents


@pytest.mark.parametrize("options", OPTIONS)
def test_it_is_the_file_of_the_user(start: Callable, tmp_path: Path, options: str) -> None:
    manager, prefix, space = OPTIONS[options]
    (tmp_path / "part.stl").write_text("solid part\nendsolid part\n")
    link = LINK.format("base_link").replace("</link>", f"{MESHES}</link>")
    extra = '<gazebo reference="base_link"><mu1>0.3</mu1></gazebo><transmission name="t"/>'
    (tmp_path / "rover.urdf").write_text(f'<robot name="rover">{link}{LINK.format("wheel")}{WHEEL}{extra}</robot>')
    sim, desk = start(scene(tmp_path / "rover.urdf"), manager)
    sim.step(3)
    model = ElementTree.fromstring(desk.last(f"{space}/robot_description").data)
    assert model.get("name") == "rover"
    (spin,) = (joint for joint in model.findall("joint") if joint.get("name") == "spin")
    assert spin.get("type") == "continuous"
    assert spin.find("limit").attrib == {"effort": "7", "velocity": "9"}
    assert spin.find("child").get("link") == f"{prefix}wheel"
    assert [mesh.get("filename") for mesh in model.iter("mesh")] == [
        (tmp_path / "part.stl").as_uri(),
        "package://gone/part.stl",
    ]
    assert model.find("transmission") is not None
    assert model.find("gazebo").get("reference") == f"{prefix}base_link"
    assert tree(model)[f"{prefix}pose"] == f"{prefix}base_link"
