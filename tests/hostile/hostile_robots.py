"""MJCF and URDF files that ask for much more work than their size suggests."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from hostile_meshes import _TRIANGLE, Maker, doubling, late, obj, soup, stl, text

_BOX = '<geom type="box" size=".1 .1 .1"/>'


def mjcf(world: str, more: str = "") -> str:
    """An MJCF file."""
    return f'<mujoco model="hostile">{more}<worldbody>{world}</worldbody></mujoco>'


def urdf(content: str) -> str:
    """A URDF file."""
    return f'<robot name="hostile">{content}</robot>'


def with_files(maker: Maker, **files: str | bytes | Callable[[], str | bytes]) -> Maker:
    """A maker of a model and of files that it refers to; ``a_obj`` is the file ``a.obj``."""

    def make(folder: Path) -> Path:
        for name, content in files.items():
            data = content() if callable(content) else content
            (folder / name.replace("_", ".")).write_bytes(data.encode() if isinstance(data, str) else data)
        return maker(folder)

    return make


def _including(depth: int, uses: int) -> Maker:
    """Files that each include the next one several times."""

    def make(folder: Path) -> Path:
        for level in range(depth):
            inside = f'<include file="i{level + 1}.xml"/>' * uses if level < depth - 1 else _BOX
            (folder / f"i{level}.xml").write_text(f"<mujocoinclude>{inside}</mujocoinclude>")
        return text(".xml", mjcf('<include file="i0.xml"/>'))(folder)

    return make


def _mesh_robot(file: str, count: int = 1, tag: str = "collision") -> str:
    return urdf(
        '<link name="a">' + f'<{tag}><geometry><mesh filename="{file}"/></geometry></{tag}>' * count + "</link>"
    )


def _links(count: int, more: str = "") -> str:
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{(i - 1) // 2}"/><child link="l{i}"/>{more}</joint>'
        for i in range(1, count)
    )
    return urdf(links + joints)


def _with_masses(robot: str) -> str:
    return robot.replace('"/><link', (
        '"><inertial><mass value="1"/></inertial><collision><geometry><sphere radius=".1"/></geometry></collision>'
        "</link><link"))  # fmt: skip


def _chains(count: int, length: int) -> str:
    links = [f"c{chain}l{i}" for chain in range(count) for i in range(length)]
    parents = [f"c{chain}l{i - 1}" if i else "base" for chain in range(count) for i in range(length)]
    joints = "".join(
        f'<joint name="j_{link}" type="revolute"><parent link="{parent}"/><child link="{link}"/>'
        '<origin xyz="0 0 0.1"/><axis xyz="0 1 0"/></joint>'
        for parent, link in zip(parents, links, strict=True)
    )
    return urdf("".join(f'<link name="{link}"/>' for link in [*links, "base"]) + joints)


def _mjcf_mesh(file: str, uses: int = 1) -> str:
    return mjcf('<geom type="mesh" mesh="m"/>' * uses, f'<asset><mesh name="m" file="{file}"/></asset>')


def _boxes(count: int) -> str:
    rng = np.random.default_rng(1)
    return "".join(
        f'<geom type="box" size=".1 .1 .1" pos="{x:.3f} {y:.3f} {z:.3f}"/>' for x, y, z in rng.random((count, 3)) * 50
    )


def _bodies(count: int, geoms: int = 1) -> str:
    body = "".join(
        f'<body><joint/><geom type="box" size=".1 .1 .1" contype="{2 << i % 20}" conaffinity="{1 << i % 20}"/>'
        f"{_BOX * (geoms - 1)}</body>"
        for i in range(count)
    )
    return f'<body name="base"><freejoint/>{_BOX}{body}</body>'


_PAIRS = "<tendon>" + "".join(f'<fixed name="t{i}"><joint joint="j" coef="{i}"/></fixed>' for i in range(20_000))
_ONE = f'<body name="b"><joint name="j"/>{_BOX}<site name="s"/></body>'
_POLYGON = _TRIANGLE + "f" + " 1 2 3" * 400_000 + "\n"

_SDF_PAIR = '<link name="a"/><link name="b"/>'
_SDF_JOINT = '<joint name="a" type="fixed"><parent>a</parent><child>b</child></joint>'


def sdf(content: str, tag: str = "model") -> str:
    """An SDF file."""
    return f'<sdf version="1.7"><{tag} name="hostile">{content}</{tag}></sdf>'


ROBOTS: dict[str, Maker] = {
    # SDF
    "sdf: 250,000 comments without an end": text(".sdf", sdf("<!--" * 250_000)),
    "sdf: 19,000 joints of one name": text(".sdf", sdf(_SDF_PAIR + _SDF_JOINT * 19_000)),
    "sdf: 19,000 links of one name": text(".sdf", sdf('<link name="a"/>' * 19_000)),
    "sdf: 9,000 models of one name": text(".sdf", sdf(
        '<model name="a"><static>1</static><link name="a"/></model>' * 9000, "world")),
    "sdf: 9,000 shapes of one name": text(".sdf", sdf('<link name="a">' + (
        '<visual name="a"><geometry><box><size>1 1 1</size></box></geometry></visual>' * 9000) + "</link>")),
    "sdf: 19,000 frames in a row": text(".sdf", sdf('<link name="a"/>' + "".join(
        f'<frame name="f{i}" attached_to="f{i + 1}"/>' for i in range(19_000)))),
    "sdf: 190 nested models": text(".sdf", sdf('<model name="a"><link name="a"/>' * 95 + "</model>" * 95)),
    "sdf: entities": text(".sdf", '<!DOCTYPE a [<!ENTITY b "c">]>' + sdf("&b;")),
    "sdf: 2,500 files of a model that includes itself": text(".sdf", sdf(
        "<include><uri>hostile.sdf</uri></include>" * 2500, "world")),
    # MJCF
    "mjcf: 250,000 comments without an end": text(".xml", mjcf("<!--" * 250_000)),
    "mjcf: 20,000 equal boxes": text(".xml", mjcf(_BOX * 20_000)),
    "mjcf: 90,000 equal boxes": late(".xml", lambda: mjcf(_BOX * 90_000)),
    "mjcf: 50,000 boxes": late(".xml", lambda: mjcf(_boxes(50_000))),
    "mjcf: 20,000 boxes of one body": text(".xml", mjcf(f"<body><freejoint/>{_BOX * 20_000}</body>")),
    "mjcf: 2,000 bodies of 10 shapes": text(".xml", mjcf(_bodies(1900, 10))),
    "mjcf: 30,000 bodies": text(".xml", mjcf(_bodies(30_000))),
    "mjcf: 150 nested bodies": text(".xml", mjcf(f"<body><joint/>{_BOX}" * 150 + "</body>" * 150)),
    "mjcf: files that include each other twice": _including(20, 2),
    "mjcf: files that include 100 each": _including(4, 100),
    "mjcf: nested replicate": text(".xml", mjcf('<replicate count="100">' * 5 + _BOX + "</replicate>" * 5)),
    "mjcf: replicate of many": text(".xml", mjcf('<replicate count="900">' + _BOX * 2000 + "</replicate>")),
    "mjcf: many replicates": text(".xml", mjcf(f'<replicate count="900">{_BOX}</replicate>' * 2000)),
    "mjcf: 20,000 tendons": text(".xml", mjcf(_ONE).replace("</mujoco>", _PAIRS + "</tendon></mujoco>")),
    "mjcf: 40,000 sensors": text(".xml", mjcf(_ONE).replace(
        "</mujoco>", "<sensor>" + '<gyro site="s"/>' * 40_000 + "</sensor></mujoco>")),
    "mjcf: 40,000 motors": text(".xml", mjcf(_ONE).replace(
        "</mujoco>", "<actuator>" + '<motor joint="j"/>' * 40_000 + "</actuator></mujoco>")),
    "mjcf: 30,000 equations": text(".xml", mjcf(_ONE).replace(
        "</mujoco>", "<equality>" + '<joint joint1="j"/>' * 30_000 + "</equality></mujoco>")),
    "mjcf: 40,000 cameras": text(".xml", mjcf(f"<body>{_BOX}" + "<camera/>" * 40_000 + "</body>")),
    "mjcf: mesh with a polygon of 1.2 M corners": with_files(text(".xml", _mjcf_mesh("a.obj")), a_obj=lambda: _POLYGON),
    "mjcf: mesh of random triangles": with_files(
        text(".xml", _mjcf_mesh("a.stl")), a_stl=lambda: stl(soup(90_000))),
    "mjcf: mesh with 20,000 uses": with_files(
        text(".xml", _mjcf_mesh("a.stl", 20_000)), a_stl=lambda: stl(soup(2000))),
    "mjcf: 200 meshes of one file": with_files(text(".xml", mjcf(
        "".join(f'<geom type="mesh" mesh="m{i}"/>' for i in range(200)),
        "<asset>" + "".join(f'<mesh name="m{i}" file="a.stl"/>' for i in range(200)) + "</asset>")),
        a_stl=lambda: stl(soup(90_000))),
    "mjcf: mesh of 300,000 numbers": late(".xml", lambda: mjcf('<geom type="mesh" mesh="m"/>', (
        '<asset><mesh name="m" vertex="' + " ".join(f"{x:.4f}" for x in soup(60_000).ravel()) + '"/></asset>'))),
    "mjcf: height field of 2,000 x 2,000": late(".xml", lambda: mjcf('<geom type="hfield" hfield="h"/>', (
        '<asset><hfield name="h" nrow="2000" ncol="2000" size="1 1 1 1"/></asset>'))),
    "mjcf: 100 height fields": late(".xml", lambda: mjcf(
        "".join(f'<geom type="hfield" hfield="h{i}"/>' for i in range(100)), "<asset>" + "".join(
            f'<hfield name="h{i}" nrow="2000" ncol="2000" size="1 1 1 1"/>' for i in range(100)) + "</asset>")),
    "mjcf: 5,000 nested defaults": text(".xml", mjcf(_BOX, (
        '<default class="main">' + "".join(f'<default class="d{i}"/>' for i in range(30_000)) + "</default>"))),
    "mjcf: nested elements": text(".xml", mjcf("<frame>" * 150_000 + _BOX + "</frame>" * 150_000)),
    "mjcf: an attribute of 4 MB": late(".xml", lambda: mjcf(_BOX.replace(".1 .1 .1", "0.1 " * 1_000_000))),
    # URDF
    "urdf: 100,000 links": late(".urdf", lambda: urdf("".join(f'<link name="l{i}"/>' for i in range(100_000)))),
    "urdf: 30,000 links and joints": late(".urdf", lambda: _links(30_000)),
    "urdf: 2,000 joints that follow": text(".urdf", _links(1990, '<mimic joint="j1"/>')),
    "urdf: 1,990 moving links with masses": text(".urdf", _with_masses(_links(1990))),
    "urdf: 800 moving links with masses": text(".urdf", _with_masses(_links(800))),
    "urdf: 750 moving links in five chains": text(".urdf", _with_masses(_chains(5, 150))),
    "urdf: 40,000 boxes": late(".urdf", lambda: urdf('<link name="a">' + (
        '<collision><geometry><box size="1 1 1"/></geometry></collision>' * 40_000) + "</link>")),
    "urdf: 40,000 visuals": late(".urdf", lambda: urdf('<link name="a">' + (
        '<visual><geometry><sphere radius="1"/></geometry></visual>' * 40_000) + "</link>")),
    "urdf: 30,000 uses of a mesh": with_files(
        late(".urdf", lambda: _mesh_robot("a.stl", 30_000)), a_stl=lambda: stl(soup(1000))),
    "urdf: 30,000 visuals of a mesh": with_files(
        late(".urdf", lambda: _mesh_robot("a.stl", 30_000, "visual")), a_stl=lambda: stl(soup(1000))),
    "urdf: collada instances": with_files(text(".urdf", _mesh_robot("a.dae")), a_dae=doubling(22)),
    "urdf: 100 uses of 8,000 collada instances": with_files(
        text(".urdf", _mesh_robot("a.dae", 100)), a_dae=doubling(13)),
    "urdf: mesh with a polygon of 1.2 M corners": with_files(
        text(".urdf", _mesh_robot("a.obj")), a_obj=lambda: _POLYGON),
    "urdf: mesh of random triangles": with_files(text(".urdf", _mesh_robot("a.obj")), a_obj=lambda: obj(soup(40_000))),
    "urdf: 200,000 materials": late(".urdf", lambda: urdf(
        '<link name="a"/>' + '<material name="m"/>' * 200_000)),
    "urdf: 30,000 sensors": late(".urdf", lambda: urdf('<link name="a"/>' + (
        '<gazebo reference="a"><sensor type="camera" name="c"/></gazebo>' * 30_000))),
    "urdf: nested elements": late(".urdf", lambda: urdf("<link>" * 300_000 + "</link>" * 300_000)),
    "urdf: 200,000 substitutions without an end": late(".urdf", lambda: urdf(
        f'<link name="a"><visual><geometry><mesh filename="{"$(env" * 200_000}"/></geometry></visual></link>')),
    "urdf: 1,000,000 blanks in a substitution": late(".urdf", lambda: urdf(
        f'<link name="a"><visual><geometry><mesh filename="$(env{" " * 1_000_000}"/></geometry></visual></link>')),
    "urdf: entities": text(".urdf", '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">]>'
        + urdf("&b;" * 1000)),
    "urdf: 30,000 attributes": late(".urdf", lambda: urdf(
        '<link name="a" ' + " ".join(f'a{i}="1"' for i in range(200_000)) + "/>")),
}  # fmt: skip
