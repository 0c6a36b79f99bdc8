"""Robots of MJCF files move as in plain MuJoCo, and keep their joints whatever else the file has.

With MORSE_TEST_ROBOT_FILES, a folder with models of others, every file there is compared.
"""

import os
from pathlib import Path

import mujoco
import pytest
from comparison import compare

import morse
from morse.assets.mjcf import read_mjcf

OTHERS = os.environ.get("MORSE_TEST_ROBOT_FILES", "")
DEFAULTS = '<option timestep="0.002"/><default><geom solref="0.015 1"/></default>'
LEG = """<body name="leg{n}" pos="{x} {y} 0"><joint name="hip{n}" axis="0 1 0" damping="1" range="-1 1" limited="true"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.02" mass="0.3"/>
  <geom name="foot{n}" size="0.03" pos="0 0 -0.2" mass="0.05" priority="1" condim="6" solimp="0.015 1 0.03"
    friction="0.8 0.02 0.01"/></body>"""
LEGS = "".join(
    LEG.format(n=n, x=x, y=y) for n, (x, y) in enumerate(((0.2, 0.1), (0.2, -0.1), (-0.2, 0.1), (-0.2, -0.1)))
)
MOTORS = "".join(f'<position joint="hip{n}" kp="40" kv="2"/>' for n in range(4))
DOG = f"""<mujoco model="dog">{DEFAULTS}<worldbody><body name="trunk" pos="0 0 0.4"><freejoint/>
  <geom type="box" size="0.25 0.1 0.04" mass="5"/>{LEGS}</body>%s</worldbody><actuator>{MOTORS}</actuator>%s</mujoco>"""
KEYS = '<keyframe><key name="home" qpos="0 0 0.3 1 0 0 0 0.4 0.4 -0.4 -0.4" ctrl="0.4 0.4 -0.4 -0.4"/></keyframe>'
ARM = """<mujoco model="arm"><option timestep="0.002" integrator="implicitfast" cone="elliptic" impratio="5"/>
<worldbody>
  <body name="base"><geom type="cylinder" size="0.05 0.1" pos="0 0 0.1"/>
    <body name="upper" pos="0 0 0.25"><joint name="lift" axis="0 1 0" frictionloss="0.1" range="-2 2" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02"/><site name="a" pos="0.15 0 0.05"/>
      <body name="lower" pos="0.3 0 0"><joint name="bend" axis="0 1 0" damping="0.05" stiffness="1"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02"/><site name="b" pos="0.15 0 0.05"/></body></body></body>
</worldbody>
<tendon><spatial name="cord" range="0 0.4" limited="true"><site site="a"/><site site="b"/></spatial></tendon>
<actuator><position joint="lift" kp="60" dampratio="1"/><muscle name="biceps" tendon="cord" ctrllimited="true"
  ctrlrange="0 1"/><general name="slow" joint="bend" dyntype="integrator" gainprm="1"/></actuator></mujoco>"""
SLED = """<mujoco model="sled"><option gravity="2 0 -9.81"/><worldbody><body name="base">
  <geom type="box" pos="0 0 0.1" size="2 0.3 0.1" friction="0.1 0.01 0.001" solref="0.04 1.2" {base}/>
  <body name="sled" pos="0 0 0.31"><joint axis="0 0 1" type="slide"/><joint axis="1 0 0" type="slide"/>
  <joint axis="0 0 1"/><geom type="box" size="0.1 0.2 0.1" pos="0 0.1 0" friction="0.05 0.2 0.002" condim="4"
  solimp="0.3 0.9 0.02" solmix="3"/></body></body></worldbody></mujoco>"""
PINCER = """<mujoco model="pincer"><worldbody><body name="palm"><geom type="box" size="0.1 0.1 0.1" pos="0 0 0.1"/>
<body name="left" pos="0.05 0 0.25"><joint name="left" axis="0 1 0" armature="0.05"/>
<geom size="0.04" mass="0.1"/></body>
<body name="right" pos="-0.05 0 0.25"><joint name="right" axis="0 1 0" armature="0.05"/>
<geom size="0.04" mass="0.1"/>
</body></body></worldbody><equality><joint joint1="left" joint2="right" polycoef="0.1 -2"/></equality>
<actuator><position name="grip" joint="left" kp="20" kv="1"/></actuator></mujoco>"""
LOW_FLOOR = '<geom name="ground" type="plane" size="0 0 1" pos="0 0 -0.4"/>'
LOW_BALL = '<body name="ball" pos="1 0 -0.2"><freejoint/><geom size="0.05" mass="0.5"/></body>'
MODELS = {
    "dog": DOG % ("", ""),
    "dog beside furniture": DOG % (
        '<body name="dummy" pos="0 0 20"><geom size="0.1"/></body>'
        '<body name="door" pos="3 0 1"><joint name="hinge" axis="0 0 1"/><geom type="box" size="0.4 0.02 0.9"/></body>'
        '<body name="ball" pos="2 0 0.3"><freejoint/><geom size="0.1"/></body>', "",
    ),
    "arm": ARM,
    "sled on its fixed base": SLED.format(base=""),
    "sled on a base that decides": SLED.format(base='priority="1"'),
    "motor on the joint that an equality lets follow": PINCER,
    "dog on its own floor below 0": (DOG % (LOW_FLOOR.replace("-0.4", "-0.9"), ""))
    .replace('pos="0 0 0.4"', 'pos="0 0 -0.5"'),
    "arm over its own floor below 0, with a ball": ARM.replace("</worldbody>", LOW_FLOOR + LOW_BALL + "</worldbody>"),
    "ball in a tilted tray": '<mujoco><worldbody><body name="ball" pos="0 0 0.5" euler="0 10 0"><freejoint/><geom '
    'size="0.05" mass="4" solref="0.05 1" solimp="0.1 0.9 0.02" condim="6" friction="1 0.01 0.02"/></body></worldbody>'
    "</mujoco>",
}  # fmt: skip


def test_the_joint_with_the_motor_leads(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(PINCER)
    bones = {bone.name: bone for node in read_mjcf(path).nodes() for bone in node.bones}
    assert (bones["left"].leader, bones["left"].dynamics.gain) == (-1, 20.0)
    # left = 0.1 - 2 right
    right = bones["right"]
    assert list(bones)[right.leader] == "left"
    assert (right.factor, right.offset) == (-0.5, pytest.approx(0.05))


@pytest.mark.parametrize("name", MODELS)
def test_it_moves_as_in_plain_mujoco(tmp_path: Path, name: str) -> None:
    path = tmp_path / "model.xml"
    path.write_text(MODELS[name])
    result = compare(path, tmp_path)
    assert result.joints[0] == result.joints[1]
    if result.is_free:
        assert result.errors[0.5] < 1e-3
        assert result.height < 1e-3
    else:
        assert result.errors[2.0] < 1e-4


#: in grams and centimetres
FLY = """<mujoco model="fly"><option gravity="0 0 -981" timestep="0.0005"/><worldbody>
<geom type="plane" size="1 1 1"/><body name="thorax" pos="0 0 0.3"><freejoint/>
<geom type="ellipsoid" size="0.1 0.05 0.05" mass="3e-4"/><body name="leg" pos="0.05 0 0">
<joint name="coxa" axis="0 1 0" damping="1e-6"/><geom type="capsule" fromto="0 0 0 0 0 -0.1" size="0.005" mass="1e-6"/>
<body name="tarsus" pos="0 0 -0.1"><joint name="tarsus" axis="0 1 0" damping="1e-7"/>
<geom type="capsule" fromto="0 0 0 0.02 0 -0.02" size="0.002" mass="1e-8"/></body></body></body></worldbody></mujoco>"""
REST = """<mujoco model="rest"><worldbody><geom type="plane" size="5 5 1"/>
<body name="base" pos="1 0 1"><geom size="0.1"/><body name="rod"><joint name="j" axis="0 1 0" damping="0.1"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="0.3"/></body></body>
<body name="crate" pos="0 0 0.052"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="1"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize("text", [FLY, REST])
def test_insects_keep_their_masses_and_crates_creep_as_in_plain_mujoco(tmp_path: Path, text: str) -> None:
    path = tmp_path / "model.xml"
    path.write_text(text)
    assert compare(path, tmp_path).errors[2.0] < 1e-9


#: bodies without mass or joint, as makers put them at the tips of hands; without damping, each last bit of the
#: inertias shows after some seconds
TRIPLE = """<mujoco model="triple"><option timestep="0.002"/><worldbody><body name="a" pos="0 0 2"><joint axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.02"/><body name="eye" pos="0.1 0 0.3"/>
<body name="b" pos="0.3 0 0.1"><joint axis="0 1 0.2"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02"/>
<body name="c" pos="0.3 0 0"><joint axis="0.1 1 0"/><geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.02"/>
<body name="tip" pos="0.3 0.1 0"><site name="tip"/></body></body></body></body></worldbody></mujoco>"""
#: the mesh that would give its finger a mass does not exist
LOST = """<mujoco><asset><mesh name="m" file="gone.stl"/></asset><worldbody><body name="palm"><geom size="0.1"/>
<body name="finger" pos="0.2 0 0"><joint name="j" axis="0 1 0"/><geom type="mesh" mesh="m"/></body></body></worldbody>
</mujoco>"""


def test_bodies_without_mass_have_none(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(TRIPLE)
    assert compare(path, tmp_path).errors[2.0] == 0.0


def test_a_body_whose_mesh_is_missing_moves(tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(LOST)
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'model.xml')!r})\nenv = Environment('empty')\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(10)
        assert [bone.name for node in sim.scene.nodes() for bone in node.bones] == ["j"]


def test_it_starts_in_a_keyframe(tmp_path: Path) -> None:
    path = tmp_path / "dog.xml"
    path.write_text(DOG % ("", KEYS))
    result = compare(path, tmp_path, keyframe="home")
    assert result.errors[0.5] < 1e-3
    script = tmp_path / "other.py"
    script.write_text(f"from morse.builder import *\nRobot({str(path)!r}, keyframe='hone')\nEnvironment('empty')\n")
    with pytest.raises(Exception, match=r"no keyframe 'hone'.*home"):
        morse.load(script)


def test_further_bodies_are_objects(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(MODELS["dog beside furniture"])
    library = read_mjcf(path)
    assert [root.name for root in library.roots] == ["dog", "dog_world", "ball"]
    assert library.robot == "dog"
    assert [bone.name for node in library.roots[1:] for part in node.walk() for bone in part.bones] == ["hinge"]


def test_a_model_attaches_others(tmp_path: Path) -> None:
    (tmp_path / "leg.xml").write_text('<mujoco><worldbody><body name="leg"><joint name="j"/><geom size="0.1"/></body>'
                                      "</worldbody></mujoco>")  # fmt: skip
    path = tmp_path / "model.xml"
    path.write_text(
        '<mujoco><asset><model name="leg" file="leg.xml"/></asset><worldbody><body name="trunk"><freejoint/>'
        '<geom size="0.2"/><replicate count="3" offset="0.3 0 0"><frame pos="0 0 -0.2"><attach model="leg" body="leg" '
        'prefix="my_"/></frame></replicate></body></worldbody></mujoco>'
    )
    plain = mujoco.MjModel.from_xml_path(str(path))
    bones = [bone.name for node in read_mjcf(path).nodes() for bone in node.bones]
    assert sorted(bones) == sorted(plain.joint(number).name for number in range(1, plain.njnt))


@pytest.mark.slow
@pytest.mark.skipif(not OTHERS, reason="MORSE_TEST_ROBOT_FILES is not set")
@pytest.mark.parametrize("path", sorted(Path(OTHERS).rglob("*.xml")) if OTHERS else [], ids=str)
def test_files_of_others_keep_all_joints(path: Path) -> None:
    try:
        plain = mujoco.MjModel.from_xml_path(str(path))
    except ValueError:
        pytest.skip("plain MuJoCo refuses it")
    if plain.nbody == 1:
        pytest.skip("it has no bodies")
    library = read_mjcf(path)
    assert sum(len(node.bones) for node in library.nodes()) == int((plain.jnt_type != 0).sum())


LOW = f"""<mujoco model="low"><worldbody>{LOW_FLOOR}
<body name="base" pos="0 0 -0.3"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/></body></worldbody>
</mujoco>"""


@pytest.mark.parametrize(
    ("frequency", "more", "step"),
    [
        (20, "", 0.01),  # as in the file
        (60, "", 1 / 120),  # at most
        (100, "", 0.01),
        (20, "env.set_physics_step_sub(10)", 0.005),
        (20, "env.set_physics_step_sub(1)", 0.05),
        # beside a robot of MORSE, whose drive is tuned for short steps
        (20, "ATRV().translate(x=5)", 1 / 240),
    ],
)
def test_a_step_of_a_file_may_be_long(frequency: int, more: str, step: float, tmp_path: Path) -> None:
    (tmp_path / "dog.xml").write_text((DOG % ("", "")).replace('timestep="0.002"', 'timestep="0.01"'))
    first, last = ("", more) if more.startswith("env") else (more, "")
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'dog.xml')!r})\n{first}\n"
        f"env = Environment('empty')\nenv.simulator_frequency({frequency})\n{last}\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        assert sim.world.model.opt.timestep == pytest.approx(step)
        assert sim.world.steps * step == pytest.approx(1.0 / frequency)


@pytest.mark.parametrize(
    ("more", "environment", "height"),
    [
        ("", "empty", -0.3),
        ("robot.translate(x=1)", "empty", -0.3),
        # in these scenes the world has the floor
        ("robot.translate(z=0.5)", "empty", 0.1),
        ("other = ATRV(); other.translate(x=5)", "empty", 0.1),
        ("", "indoors-1/boxes", 0.1),
    ],
)
def test_a_scene_has_one_floor(more: str, environment: str, height: float, tmp_path: Path) -> None:
    (tmp_path / "low.xml").write_text(LOW)
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'low.xml')!r})\n{more}\n"
        f"env = Environment({environment!r})\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(120)
        assert sim.context.robots["robot"].bge_object.world_pose()[0][2] == pytest.approx(height, abs=3e-3)
        has_own = any(node.name.startswith("ground") for root in sim.scene.roots for node in root.walk())
        assert has_own == (height < 0.0)
