"""A model of a robot reads the files of its package, and no others."""

import os
import re
from pathlib import Path

import pytest

import morse
from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.nearby_files import FileRefusedError, find_near, find_package
from morse.assets.search import project_dirs
from morse.assets.xml_files import parse_xml


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model in ``ws/rover/urdf``, meshes in ``ws/rover/meshes``, another package beside it, a secret outside."""
    for folder in ("ws/rover/urdf/deep", "ws/rover/meshes", "ws/other/meshes", "secret"):
        (tmp_path / folder).mkdir(parents=True)
    for file in ("ws/rover/meshes/a.stl", "ws/other/meshes/b.stl", "secret/c.stl", "ws/rover/urdf/d.stl"):
        (tmp_path / file).write_text("x")
    file = tmp_path / "ws/rover/urdf/rover.urdf"
    file.write_text("<robot/>")
    return file


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("d.stl", "ws/rover/urdf/d.stl"),
        ("../meshes/a.stl", "ws/rover/meshes/a.stl"),
        # from the package, and from a file of macros in a folder that is one deeper
        ("meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("../../meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://rover/meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://other/meshes/b.stl", "ws/other/meshes/b.stl"),
        ("package:///other/meshes/b.stl", "ws/other/meshes/b.stl"),
    ],
)
def test_files_of_packages_are_found(model: Path, tmp_path: Path, name: str, where: str) -> None:
    assert find_near(name, model).samefile(tmp_path / where)


@pytest.mark.parametrize(
    "name",
    [
        "../../../secret/c.stl",
        "../../other/meshes/b.stl",
        "package://rover/../../secret/c.stl",
        "package://../secret/c.stl",
        "file://{root}/secret/c.stl",
        "{root}/secret/c.stl",
        "../meshes/link.stl",
    ],
)
def test_files_elsewhere_are_refused(model: Path, tmp_path: Path, name: str) -> None:
    os.symlink(tmp_path / "secret/c.stl", tmp_path / "ws/rover/meshes/link.stl")
    with pytest.raises(FileRefusedError, match=r"outside of the package|the file does not exist"):
        find_near(name.format(root=tmp_path), model)


def test_what_the_user_lists_may_be_read(model: Path, tmp_path: Path, monkeypatch) -> None:
    with project_dirs([tmp_path / "secret"]):
        assert find_near("../../../secret/c.stl", model).samefile(tmp_path / "secret/c.stl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert find_near("package://secret/c.stl", model).samefile(tmp_path / "secret/c.stl")


def test_a_package_reaches_as_far_as_its_mark_says(model: Path, tmp_path: Path) -> None:
    deep = tmp_path / "ws" / "rover" / "made" / "deep" / "rover.urdf"
    deep.parent.mkdir(parents=True)
    deep.write_text("<robot/>")
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../meshes/a.stl", deep)
    (tmp_path / "ws/rover/package.xml").write_text("<package/>")
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")


@pytest.mark.parametrize("marks", [(), ("ws/rover/urdf/deep/__init__.py", "ws/rover/urdf/__init__.py")])
def test_a_package_without_a_mark_is_above_its_folder_of_models(model: Path, tmp_path: Path, marks) -> None:
    for mark in marks:
        (tmp_path / mark).touch()
    deep = model.parent / "deep" / "rover.urdf"
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../../other/meshes/b.stl", deep)


def test_python_packages_reach_as_far_as_they_are_nested(model: Path, tmp_path: Path) -> None:
    deep = tmp_path / "ws" / "rover" / "made" / "deep" / "rover.urdf"
    deep.parent.mkdir(parents=True)
    for folder in (deep.parent, deep.parent.parent):
        (folder / "__init__.py").touch()
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../meshes/a.stl", deep)
    (tmp_path / "ws/rover/__init__.py").touch()
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")


def test_a_renamed_package_and_other_capitals_are_understood(model: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "ws/rover/meshes/a.stl"
    for name in ("package://rover_description/meshes/a.stl", "../meshes/A.STL", "package://rover/meshes/A.stl"):
        assert find_near(name, model).samefile(mesh)
    assert find_package("rover_description", model).samefile(tmp_path / "ws/rover")
    (tmp_path / "ws").rename(tmp_path / "xacro")
    model = tmp_path / "xacro/rover/urdf/rover.urdf"
    assert find_package("rover_description", model).samefile(tmp_path / "xacro/rover"), "the nearest"
    (tmp_path / "xacro").rename(tmp_path / "ws")
    model = tmp_path / "ws/rover/urdf/rover.urdf"
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../other/meshes/B.stl", model)
    # a package that says its name is not another one
    (tmp_path / "ws/rover/package.xml").write_text("<package><name>rover</name></package>")
    with pytest.raises(FileRefusedError, match="there is no package 'rover_description'"):
        find_package("rover_description", model)


@pytest.mark.parametrize("name", ["", "\0", "package://", "package:///etc/passwd", "gone.stl", "x" * 5000])
def test_names_of_nothing_are_refused(model: Path, name: str) -> None:
    with pytest.raises(FileRefusedError):
        find_near(name, model)


# -- xML that is not quite XML, which the programs that robots are written for accept --------------

URDF = '<robot name="r"><link name="l"/>{}</robot>'
SDF = '<sdf version="1.6"><model name="r"><link name="l"/>{}</model></sdf>'
ODD = {
    "prefix": "<gazebo><sensor:camera name='c' a:b='1'><x>1</x></sensor:camera></gazebo>",
    "dashes": "<!-- a -- b -->",
    "latin": "<gazebo><about>Z\u00fcrich</about></gazebo>",
}


@pytest.mark.parametrize("text", [URDF, SDF])
@pytest.mark.parametrize("name", ODD)
def test_it_is_read_in_every_format(tmp_path: Path, text: str, name: str) -> None:
    file = tmp_path / ("r.urdf" if text == URDF else "r.sdf")
    file.write_bytes(text.format(ODD[name]).encode("latin-1"))
    assert {"r", "l"} <= {node.name for node in load(file).nodes()}


def test_a_zero_at_the_end_is_ignored() -> None:
    for text in ("<a>\u00e9</a>\r\n\0", "<a>\u00e9</a>\0\0"):
        assert parse_xml(text.encode(), Path("a")).text == "\u00e9"
    assert parse_xml("<a>\u00e9</a>".encode("utf-16"), Path("a")).text == "\u00e9"


def test_namespaces_and_text_are_kept() -> None:
    root = parse_xml(b'<a xmlns="urn:x"><b>1 &amp; 2</b></a>', Path("a"))
    assert root.find("{urn:x}b").text == "1 & 2"
    root = parse_xml(b"<a><k:b>1 &amp; 2</k:b> tail</a>", Path("a"))
    assert (root[0].tag, root[0].text, root[0].tail) == ("k:b", "1 & 2", " tail")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"<a><b></a>", "not XML: mismatched tag: line 1"),
        (b'<!DOCTYPE a [<!ENTITY e "x">]><a><k:b>&e;</k:b></a>', "defines the entity 'e'"),
        (b"<k:a>" * 300, "nested more than"),
    ],
)
def test_what_is_broken_or_too_large_is_refused_with_the_reason(text: bytes, words: str) -> None:
    with pytest.raises(AssetError, match=words):
        parse_xml(text, Path("a"))


# -- errors of robot files name the file and the line, also after comments, in included files and in the engine

BODY = "<worldbody>\n<body>\n<geom size='1'/>\n{}\n</body>\n</worldbody>"
FILES = {
    # seven lines before the mistake
    "robot.urdf": (
        '<?xml version="1.0"?>\n<!-- a\n\n -->\n<robot name="r">\n<link name="l"/>\n\n'
        '<joint name="j" type="turning"><parent link="l"/><child link="m"/></joint>\n</robot>',
        "'turning', expected one of .*line 8",
    ),
    "numbers.urdf": (
        '<robot name="r">\n<link name="l"/><link name="m"/>\n<joint name="j" type="fixed"><parent link="l"/>'
        '<child link="m"/>\n'
        '<origin xyz="a 0 0"/></joint></robot>',
        "<origin xyz='a 0 0'>: expected 3 numbers .line 4",
    ),
    "engine.xml": ("<mujoco>\n<!--\n-->\n" + BODY.format("<joint axis='0 0'/>") + "</mujoco>", "'axis'.*line 7"),
    "unknown.xml": (f"<mujoco>\n{BODY.format('')}<actuator>\n\n<motor joint='x'/></actuator></mujoco>", "'x'.*line 9"),
    "included.xml": ('<mujoco>\n<include file="part"/>\n</mujoco>', "'gear'.*line 7 of part"),
    "large.xml": ("<mujoco>\n" + BODY.format("<joint damping='1e99'/>") + "</mujoco>", "realistic for a robot .line 5"),
    "broken.xml": ("\n\n<!--\n--><mujoco>\n<worldbody></mujoco>", "not XML: mismatched tag: line 5"),
}


@pytest.mark.parametrize("name", FILES)
def test_the_line_is_that_of_the_file(tmp_path: Path, name: str) -> None:
    text, words = FILES[name]
    (tmp_path / name).write_text(text)
    joint = '<joint name="j" gear="1"/>'
    (tmp_path / "part").write_text(f"<mujocoinclude>\n<!--\n-->\n{BODY.format(joint)}</mujocoinclude>")
    with pytest.raises(AssetError, match=words):
        load(tmp_path / name)


def test_the_line_of_a_number_in_sdf_is_in_the_warning(tmp_path: Path) -> None:
    file = tmp_path / "m.sdf"
    file.write_text(
        '<sdf version="1.9">\n<model name="m">\n<link name="l"><inertial>\n<mass>heavy</mass></inertial></link></model>'
        "</sdf>"
    )
    assert any("'heavy'" in warning and "(line 4)" in warning for warning in load(file).warnings)


def test_what_names_a_missing_mesh_is_left_out_with_it(tmp_path: Path) -> None:
    file = tmp_path / "m.xml"
    file.write_text("""<mujoco><asset><mesh name="m" file="gone.stl"/></asset><worldbody><geom name="base" size="1"/>
        <body name="b"><joint name="j"/><geom name="g" type="mesh" mesh="m"/><geom name="h" size="0.1"/>
          <site name="s"/>
        </body><site name="t"/></worldbody><contact><pair geom1="g" geom2="base"/></contact>
        <tendon><spatial><site site="s"/><geom geom="g"/><site site="t"/></spatial></tendon>
        <sensor><distance geom1="g" geom2="base" cutoff="1"/><framepos objtype="geom" objname="g"/></sensor>
          </mujoco>""")
    library = load(file)
    assert [bone.name for node in library.nodes() for bone in node.bones] == ["j"]
    assert any("'gone.stl' is left out" in warning for warning in library.warnings)


# -- the first lines of the chapter on models work with a file of each format ----------------------

HERE = Path(__file__).parent
CHAPTER = HERE.parents[1] / "docs" / "models.md"
MJCF = """<mujoco model="walker"><worldbody><geom type="plane" size="5 5 .1"/><body name="base" pos="0 0 .5">
<freejoint/><geom type="box" size=".2 .2 .05" mass="2"/><body name="leg" pos="0 0 -.05">
<joint name="knee" axis="0 1 0" range="-1 1" limited="true"/>
<geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".2"/></body></body></worldbody>
<actuator><motor joint="knee"/></actuator><keyframe><key name="home" qpos="0 0 0.6 1 0 0 0 0.3"/></keyframe></mujoco>"""
CUBE = [(x, y, z) for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (-0.2, 0.2)]
FACES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def lines(word: str) -> str:
    text = CHAPTER.read_text("utf-8").split("\n## ")[0]
    (code,) = (part for part in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if word in part)
    assert len(code.strip().splitlines()) <= 5
    return code


@pytest.fixture
def run(tmp_path, monkeypatch):
    for folder in ("urdf", "sdf"):
        monkeypatch.syspath_prepend(str(HERE / folder))

    def load(word: str, **files: str):
        for name, text in files.items():
            (tmp_path / name.replace("_", ".")).write_text(text)
        (tmp_path / "scene.py").write_text(f"from morse.builder import *\n{lines(word)}")
        return morse.load(tmp_path / "scene.py")

    return load


def test_a_urdf_drives(run) -> None:
    import test_urdf_drives as urdf

    with run("rover.urdf", rover_urdf=f'<robot name="rover">{urdf.CART}</robot>') as simulation:
        simulation.step(60)
        simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
        simulation.step(240)
        assert simulation.robot.component.position_3d.x > 1.5


def test_an_mjcf_starts_at_home(run) -> None:
    with run("walker.xml", walker_xml=MJCF) as simulation:
        simulation.step(1)
        assert simulation.robot.component.position_3d.z == pytest.approx(0.6, abs=0.01)
        simulation.step(60)
        assert simulation.robot.joints.get_controls().result()["knee"] == "position"


def test_an_sdf_drives_in_its_world(run) -> None:
    import test_sdf_plugins as sdf
    import test_sdf_worlds as worlds

    world = f'<sdf version="1.9"><world name="w">{worlds.GROUND}</world></sdf>'
    with run("cart.sdf", cart_sdf=sdf.CART, warehouse_sdf=world) as simulation:
        simulation.step(60)
        simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
        simulation.step(240)
        assert simulation.robot.component.position_3d.x > 1.5


def test_a_mesh_falls_and_lies(run) -> None:
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in CUBE) + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in FACES)
    with run("chair.obj", chair_obj=text) as simulation:
        simulation.step(240)
        (chair,) = (one for one in simulation.world.objects() if one.name == "chair")
        assert chair.world_pose()[0][2] == pytest.approx(0.2, abs=0.01)
