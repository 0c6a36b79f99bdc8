"""The same model in MuJoCo alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
from figures import Figure, scene

if TYPE_CHECKING:
    from collections.abc import Iterator

#: a double pendulum, which is chaotic
DOUBLE = """
<mujoco><option timestep="0.002083333333333333" integrator="implicitfast"/><worldbody>
<body name="upper" pos="0 0 3" euler="0 100 0"><joint type="hinge" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.6" size="0.02"/>
  <body name="lower" pos="0 0 -0.6"><joint type="hinge" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.6" size="0.02"/></body></body></worldbody></mujoco>
"""
SECONDS = 2


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    model = mujoco.MjModel.from_xml_string(DOUBLE)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 480 * SECONDS)
    mujoco.mj_kinematics(model, data)
    wanted = data.body("lower").xpos.tolist()
    text = "arm = Robot('{folder}/arm.xml')\nenv = Environment('empty', fastmode=True)"
    with scene(text, {"arm.xml": DOUBLE}) as sim:
        sim.step(60 * SECONDS)
        place = sim.world.game_object("lower").world_pose()[0]
    yield Figure(
        "double pendulum, MORSE and MuJoCo alone",
        f"distance after {SECONDS} s, m",
        0.0,
        math.dist(place, wanted),
        1e-4,
        f"MuJoCo {mujoco.__version__}, the same file and step",
    )
