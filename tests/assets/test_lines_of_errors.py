"""Errors of robot files name the file and the line, also after comments, in included files and in the engine."""

from pathlib import Path

import pytest

from morse.assets import load
from morse.assets.errors import AssetError

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
