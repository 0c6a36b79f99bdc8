"""What joins the bodies of an MJCF file that become different objects, and its floor, works as in plain MuJoCo."""

from pathlib import Path

import pytest
from comparison import compare

FLOOR = '<geom name="floor" type="plane" size="3 3 1"/>'
UNSEEN = 'contype="0" conaffinity="0"'
HAND = """<body name="hand" pos="0 0 0.5"><freejoint/><geom type="box" size="0.05 0.05 0.02"/>
  <body name="finger" pos="0.05 0 -0.05"><joint name="finger" type="slide" axis="1 0 0" range="-0.04 0.04"/>
    <geom type="box" size="0.01 0.02 0.04"/></body></body>"""
FOOT = '<geom name="foot" type="sphere" size="0.1" contype="0" conaffinity="0"/>'
MODELS = {
    "a hand follows a body that the user moves": f"""<mujoco><worldbody>{FLOOR}
        <body name="target" mocap="true" pos="0 0 0.5"><geom type="sphere" size="0.02" {UNSEEN}/></body>{HAND}
        </worldbody><equality><weld body1="target" body2="hand"/></equality></mujoco>""",
    "a load is welded to an arm": """<mujoco><worldbody><body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0"/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/></body>
        <body name="load" pos="0.4 0 1"><freejoint/><geom type="box" size="0.05 0.05 0.05"/></body></worldbody>
        <equality><weld body1="arm" body2="load" relpose="0.35 0 0 1 0 0 0"/></equality></mujoco>""",
    "two free bodies are connected and touch": f"""<mujoco><worldbody>{FLOOR}
        <body name="a" pos="1 0 1"><freejoint/><geom name="ga" size="0.1"/></body>
        <body name="b" pos="1 0 1.3"><freejoint/><geom name="gb" size="0.1" {UNSEEN}/></body></worldbody>
        <equality><connect body1="a" body2="b" anchor="0 0 0.15"/></equality>
        <contact><pair geom1="ga" geom2="gb"/><pair geom1="floor" geom2="gb"/></contact></mujoco>""",
    "two bodies do not touch": f"""<mujoco><worldbody>{FLOOR}
        <body name="a" pos="1 0 0.5"><freejoint/><geom size="0.1"/></body>
        <body name="b" pos="1 0 0.9"><freejoint/><geom size="0.1"/></body></worldbody>
        <contact><exclude body1="a" body2="b"/></contact></mujoco>""",
    "a foot touches only the floor": f"""<mujoco><worldbody>{FLOOR}
        <body name="trunk" pos="0 0 0.6"><freejoint/><inertial pos="0 0 0" mass="3" diaginertia="0.1 0.1 0.1"/>{FOOT}
        <body name="leg"><joint name="j" axis="0 1 0" damping="1"/><geom name="other" size="0.05" pos="0.1 0 -0.2"/>
          </body>
        </body></worldbody><contact><pair geom1="foot" geom2="floor" condim="6" solref="-500 -10"
        friction="0.5 0.5 0.01 0.001 0.001"/></contact></mujoco>""",
    "two feet of one robot touch": f"""<mujoco><worldbody>{FLOOR}<body name="trunk" pos="0 0 0.6"><freejoint/>
        <geom type="box" size="0.2 0.1 0.05"/>
        <body name="left" pos="0 0.1 0"><joint name="l" axis="1 0 0"/>
          <inertial pos="0 0 -0.2" mass="1" diaginertia="0.1 0.1 0.1"/>
        <geom name="left" size="0.08" pos="0 0 -0.3" {UNSEEN}/></body>
        <body name="right" pos="0 -0.1 0"><joint name="r" axis="1 0 0"/>
          <geom name="right" size="0.08" pos="0 0 -0.3"/></body>
        </body></worldbody><contact><pair geom1="left" geom2="right"/></contact></mujoco>""",
    "a body without shapes that collide falls": f"""<mujoco><worldbody><body name="drone" pos="0 0 30"><freejoint/>
        <geom size="0.1" {UNSEEN}/></body></worldbody></mujoco>""",
    "a free body is aligned with its inertia": f"""<mujoco>
      <worldbody>{FLOOR}<body name="b" pos="0 0 0.4" euler="10 0 30">
        <freejoint align="true"/><geom type="box" size="0.1 0.05 0.05" pos="0.2 0 0" euler="10 20 30"/>
          <geom size="0.05"/>
        </body></worldbody></mujoco>""",
    "a wheel has an infinite range": """<mujoco><worldbody><body name="w" pos="0 0 1"><joint name="j" axis="0 1 0"
        range="-inf inf"/><geom size="0.1" pos="0.1 0 0"/></body></worldbody></mujoco>""",
    "a joint starts apart from the one that it follows": """<mujoco><worldbody><body name="a" pos="0 0 1">
        <joint name="j" axis="0 1 0" damping="1"/><geom size="0.1" pos="0.1 0 0"/></body><body name="b" pos="1 0 1">
        <joint name="k" axis="0 1 0" damping="1"/><geom size="0.1" pos="0.1 0 0"/></body></worldbody>
        <equality><joint joint1="k" joint2="j" polycoef="0.5 -1 0 0 0"/></equality></mujoco>""",
    "a thing stands in the table of an arm": """<mujoco><worldbody><body name="table"><geom type="box"
        size="0.3 0.3 0.02" pos="0 0 0.5"/></body><body name="arm" pos="1 0 1">
            <joint name="j" axis="0 1 0" damping="1"/>
        <geom size="0.1" pos="0.1 0 0"/></body><body name="thing" pos="0 0 0.47"><freejoint/>
        <geom type="box" size="0.03 0.03 0.04"/></body></worldbody></mujoco>""",
    "attributes touch each other": """<mujoco><worldbody><body name="w"pos="0 0 1"><joint name='j'axis='0 1 0'/>
        <geom size="0.1" pos="0.1 0 0"/></body></worldbody></mujoco>""",
}


@pytest.mark.parametrize("name", MODELS)
def test_it_moves_as_in_plain_mujoco(tmp_path: Path, name: str) -> None:
    path = tmp_path / "model.xml"
    path.write_text(MODELS[name])
    result = compare(path, tmp_path)
    assert result.joints[0] == result.joints[1]
    assert result.errors[0.5] < 1e-4
    assert result.errors[2.0] < 1e-3
