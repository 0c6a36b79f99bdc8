"""MJCF files that are broken or that want to do harm are refused, with the reason."""

from pathlib import Path

import pytest

from morse.assets.errors import AssetError
from morse.assets.mjcf import read_mjcf

BODY = '<body name="a"><joint name="j"/><geom size="0.1"/></body>'


def robot(inside: str = BODY, more: str = "") -> str:
    return f"<mujoco><worldbody>{inside}</worldbody>{more}</mujoco>"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not XML"),
        ("<mujoco>", "not XML"),
        ("<mujocoinclude/>", "load the file that includes it"),
        ("<robot/>", "begins with <robot>, expected <mujoco>"),
        ("<mujoco/>", "no bodies"),
        (robot('<light pos="1 1 1"/>'), "no bodies"),
        ('<!DOCTYPE m [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]><mujoco model="&b;"/>', "defines the entity 'a'"),
        (robot('<body pos="nan 0 0"><geom size="0.1"/></body>'), "pos='nan 0 0'.*expected numbers"),
        (robot('<body><geom size="inf"/></body>'), "size='inf'"),
        (robot('<body><geom size="0.1" mass="1e300"/></body>'), "mass='1e300'"),
        (robot('<body><geom size="-1"/></body>'), "the engine refuses it"),
        (robot('<body><geom type="cone" size="1"/></body>'), "the engine refuses it.*cone"),
        (robot('<body name="b" pos="0 0 1e12"><geom size="0.1"/></body>'), "body 'b' has a length of 1e"),
        (robot('<body name="b"><geom size="0.1" mass="1e12"/></body>'), "body 'b' has a mass of 1e"),
        (robot(f'<replicate count="1e6">{BODY}</replicate>'), "1000000 elements <body>"),
        (robot(f'<replicate count="90"><replicate count="90">{BODY}</replicate></replicate>'), "8100 elements <body>"),
        (
            "<mujoco>" + "<worldbody>" * 300 + "</worldbody>" * 300 + "</mujoco>",
            "elements are nested more than 200 deep",
        ),
        (robot(BODY, '<include file="/etc/passwd"/>'), "cannot be included: it is at /etc/passwd, outside"),
        (robot(BODY, '<include file="gone.xml"/>'), "cannot be included: the file does not exist"),
        (robot(BODY, "<include/>"), "cannot be included"),
        (
            robot(BODY, '<asset><mesh name="m" builtin="sphere" params="9999"/></asset>'),
            "the mesh 'm' has the parameters '9999'",
        ),
    ],
)
def test_it_is_refused_with_the_reason(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "bad.xml"
    file.write_text(text)
    with pytest.raises(AssetError, match=words):
        read_mjcf(file)


def test_files_that_include_each_other_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(robot(BODY, '<include file="b.xml"/>'))
    (tmp_path / "b.xml").write_text('<mujocoinclude><include file="c.xml"/></mujocoinclude>')
    (tmp_path / "c.xml").write_text('<mujocoinclude><include file="b.xml"/></mujocoinclude>')
    with pytest.raises(AssetError, match=r"b\.xml includes c\.xml includes b\.xml"):
        read_mjcf(tmp_path / "a.xml")


def test_files_that_include_many_are_refused(tmp_path: Path) -> None:
    (tmp_path / "leaf.xml").write_text("<mujocoinclude/>")
    leaves = '<include file="leaf.xml"/>' * 50
    (tmp_path / "mid.xml").write_text(f"<mujocoinclude>{leaves}</mujocoinclude>")
    (tmp_path / "top.xml").write_text(robot(BODY, '<include file="mid.xml"/>' * 50))
    with pytest.raises(AssetError, match="more than 200 files"):
        read_mjcf(tmp_path / "top.xml")


def test_meshes_elsewhere_and_unsupported_things_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path.parent / "secret.stl").write_text("solid")
    (tmp_path / "sub" / "bad.xml").write_text(
        robot(
            '<body name="a"><joint/><geom size="0.1"/><geom type="mesh" mesh="secret"/><geom type="mesh" mesh="x"/>'
            '<flexcomp name="f" type="grid" count="900 900 900" spacing="1 1 1" radius="1"/></body>',
            '<asset><mesh file="../../secret.stl"/><mesh name="x" file="x.dae"/>'
            '<hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>'
            '<size memory="900G"/><extension><plugin plugin="a.b"/></extension>',
        )
    )
    library = read_mjcf(tmp_path / "sub" / "bad.xml")
    said = " ".join(library.warnings)
    for word in (
        "'../../secret.stl' is left out: it is at",
        "'x.dae' is left out",
        "'f' is left out",
        "hfield",
        "extension",
    ):
        assert word in said
    assert [bone.name for bone in library.roots[0].children[0].bones] == ["joint0"]


def test_a_damaged_mesh_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "claw.stl").write_bytes(b"\x00" * 84 + b"\xff" * 20)
    file = tmp_path / "bad.xml"
    file.write_text(
        robot(
            '<body><joint/><geom type="mesh" mesh="claw"/></body>', '<asset><mesh name="claw" file="claw.stl"/></asset>'
        )
    )
    with pytest.raises(AssetError, match=r"bad\.xml: the engine refuses it"):
        read_mjcf(file)
