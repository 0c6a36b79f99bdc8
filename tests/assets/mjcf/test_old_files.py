"""MJCF files that earlier versions of MuJoCo read."""

from pathlib import Path

import mujoco
import pytest

from morse.assets.errors import AssetError
from morse.assets.mjcf import read_mjcf
from morse.assets.mjcf.source import Source

GLOBAL = """<mujoco><compiler coordinate="global" angle="degree"/><worldbody>
<body name="torso" pos="0.1 0 1.25"><joint type="slide" axis="1 0 0" pos="0 0 0"/><joint axis="0 1 0" pos="0.1 0 1.25"/>
  <geom type="capsule" fromto="0.1 0 1.45 0.1 0 1.05" size="0.05"/>
  <body name="thigh"><joint axis="0 -1 0" pos="0.1 0 1.05" range="-150 0" limited="true"/>
    <geom type="capsule" fromto="0.1 0 1.05 0.1 0 0.6" size="0.05"/><site name="knee" pos="0.1 0 0.6"/>
    <body name="leg" pos="0 0 0.4"><joint axis="0 -1 0" pos="0.1 0 0.6"/><geom type="box" size="0.04 0.03 0.2"
      pos="0.1 0 0.4"/></body></body></body></worldbody></mujoco>"""
LOCAL = """<mujoco><compiler angle="degree"/><worldbody>
<body name="torso" pos="0.1 0 1.25"><joint type="slide" axis="1 0 0" pos="-0.1 0 -1.25"/><joint axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0.2 0 0 -0.2" size="0.05"/>
  <body name="thigh" pos="0 0 -0.2"><joint axis="0 -1 0" range="-150 0" limited="true"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.45" size="0.05"/><site name="knee" pos="0 0 -0.45"/>
    <body name="leg" pos="0 0 -0.45"><joint axis="0 -1 0"/><geom type="box" size="0.04 0.03 0.2" pos="0 0 -0.2"/></body>
  </body></body></worldbody></mujoco>"""
BODY = '<worldbody><body pos="0 0 1"><joint axis="0 1 0" damping="3"/><geom name="g" size="0.1"/></body></worldbody>'


def compiled(tmp_path: Path, text: str) -> mujoco.MjModel:
    path = tmp_path / "model.xml"
    path.write_text(text)
    return Source(path).file().spec().compile()


def test_global_coordinates(tmp_path: Path) -> None:
    models = [compiled(tmp_path, text) for text in (GLOBAL, LOCAL)]
    states = [mujoco.MjData(model) for model in models]
    for _ in range(2):
        for model, data in zip(models, states, strict=True):
            mujoco.mj_forward(model, data)
        one, other = states
        for name in ("geom_xpos", "site_xpos", "xanchor", "xaxis", "xipos", "qvel"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-9), name
        for model, data in zip(models, states, strict=True):
            mujoco.mj_step(model, data, 200)


def test_global_coordinates_of_rotated_bodies_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(GLOBAL.replace('name="leg"', 'name="leg" euler="0 0 30"'))
    with pytest.raises(AssetError, match=r"the body 'leg' is rotated"):
        read_mjcf(path)


@pytest.mark.parametrize(
    "element",
    [
        '<option apirate="100" mpr_iterations="40"/>',
        '<compiler coordinate="local" convexhull="true" exactmeshinertia="true"/>',
        '<option><flag sensornoise="enable"/></option>',
    ],
)
def test_removed_attributes_change_nothing(tmp_path: Path, element: str) -> None:
    model = compiled(tmp_path, f"<mujoco>{element}{BODY}</mujoco>")
    assert model.body_mass == pytest.approx(compiled(tmp_path, f"<mujoco>{BODY}</mujoco>").body_mass)


def test_renamed_attributes_keep_their_meaning(tmp_path: Path) -> None:
    text = '<mujoco><option mpr_tolerance="0.01"><flag passive="disable"/></option>%s</mujoco>'
    model = compiled(tmp_path, text % BODY)
    assert model.opt.ccd_tolerance == pytest.approx(0.01)
    off = mujoco.mjtDisableBit.mjDSBL_DAMPER | mujoco.mjtDisableBit.mjDSBL_SPRING
    assert int(model.opt.disableflags) & int(off) == int(off)
    predefined = compiled(tmp_path, f'<mujoco><option collision="predefined"/>{BODY}</mujoco>')
    assert (int(predefined.geom_contype[0]), int(predefined.geom_conaffinity[0])) == (0, 0)


@pytest.mark.parametrize(
    ("asset", "body", "lost"),
    [
        ('<mesh name="m"><plugin plugin="mujoco.sdf.torus"/></mesh>', '<geom type="mesh" mesh="m"/>', "plugin"),
        ("", '<flexcomp name="f" type="grid" count="2 2 1" spacing="1 1 1" radius="0.01" dim="2"/>', "flexcomp"),
    ],
)
def test_what_is_left_out_does_not_make_the_rest_unreadable(tmp_path: Path, asset: str, body: str, lost: str) -> None:
    path = tmp_path / "model.xml"
    extra = ""
    if lost == "flexcomp":
        extra = '<keyframe><key qpos="0 1 2 3 4 5 6 7 8 9 10 11 12"/></keyframe>'
        extra += '<equality><connect body1="f_0" body2="b" anchor="0 0 0"/></equality>'
    path.write_text(
        f'<mujoco><asset>{asset}</asset>{BODY.replace("</worldbody>", "")}<body name="b" pos="1 0 1">{body}<geom '
        f'size="0.1"/></body></worldbody>{extra}</mujoco>'
    )
    library = read_mjcf(path)
    assert any(lost in warning and "left out" in warning for warning in library.warnings)
    assert sum(len(node.bones) for node in library.nodes()) == 1
