"""Compares the motion of an MJCF file in MORSE and in plain MuJoCo: same file, same step, same commands."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

import morse
from morse.scene.mjcf import name_all

SCRIPT = """
from morse.builder import *
robot = Robot({file!r}, sensors=False, keyframe={keyframe!r})
env = Environment("empty", fastmode=True)
env.simulator_frequency({frequency})
"""


@dataclass
class Comparison:
    """The result.

    Attributes:
        joints: number of joints in MORSE and in plain MuJoCo.
        is_free: whether the file has free joints.
        errors: time (s) to the largest distance between the positions of a body in both, m.
        height: largest difference between the heights of free bodies at the end, m.
        peak: largest speed of a free body in plain MuJoCo at the end, m/s.
    """

    joints: tuple[int, int]
    is_free: bool
    errors: dict[float, float]
    height: float
    peak: float


def plain_model(path: Path) -> mujoco.MjModel:
    """The file in plain MuJoCo, on a floor at height 0 if it has none there or below."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = mujoco.MjSpec.from_file(str(path))
        name_all(spec)
        floors = [
            geom for geom in spec.worldbody.geoms if geom.type == mujoco.mjtGeom.mjGEOM_PLANE and geom.pos[2] < 1e-3
        ]
        if not floors:
            plain = mujoco.MjSpec().default.geom
            plane = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50.0, 50.0, 1.0])
            for name in ("friction", "solref", "solimp", "solmix", "margin", "gap", "condim", "priority", "contype"):
                setattr(plane, name, getattr(plain, name))
            plane.conaffinity = plain.conaffinity
        return spec.compile()


def compare(path: Path, folder: Path, times: tuple[float, ...] = (0.5, 2.0), keyframe: str = "") -> Comparison:
    """Run a file in both."""
    model = plain_model(path)
    script = folder / "default.py"
    frequency = max(round(1.0 / model.opt.timestep), 1)
    script.write_text(SCRIPT.format(file=str(path), frequency=frequency, keyframe=keyframe))
    with morse.load(script) as sim:
        world = sim.world
        model.opt.timestep = world.model.opt.timestep
        data = mujoco.MjData(model)
        if keyframe:
            mujoco.mj_resetDataKeyframe(model, data, model.key(keyframe).id)
        _copy_commands(world, model, data)
        bodies = _bodies(world, model)
        errors, now = {}, 0.0
        for time in times:
            ticks = round((time - now) * frequency)
            sim.step(ticks)
            for _ in range(ticks * world.steps):
                mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            mujoco.mj_kinematics(world.model, world.data)
            apart = [np.abs(world.data.xpos[a] - data.xpos[b]).max() for a, b in bodies]
            errors[time], now = float(max(apart, default=np.nan)), time
        free = {int(model.jnt_bodyid[j]): int(model.jnt_dofadr[j]) for j in np.nonzero(model.jnt_type == 0)[0]}
        heights = [abs(world.data.xpos[a][2] - data.xpos[b][2]) for a, b in bodies if b in free]
        speeds = [np.abs(data.qvel[dof : dof + 3]).max() for dof in free.values()]
        return Comparison(
            (int((world.model.jnt_type != 0).sum()), int((model.jnt_type != 0).sum())),
            bool(free),
            errors,
            float(max(heights, default=0.0)),
            float(max(speeds, default=0.0)),
        )


def _bodies(world, model) -> list[tuple[int, int]]:
    """The bodies in MORSE and in plain MuJoCo with the same names."""
    names = {model.body(number).name: number for number in range(1, model.nbody)}
    pairs = []
    for number in range(1, world.model.nbody):
        _, slash, name = world.model.body(number).name.partition("/")
        if slash and name in names:
            pairs.append((number, names[name]))
    return pairs


def _copy_commands(world, model, data) -> None:
    """Give the actuators of plain MuJoCo the commands of those of MORSE."""
    commands = {}
    for number in range(world.model.nu):
        name = world.model.actuator(number).name.partition("/")[2]
        commands[name] = (float(world.data.ctrl[number]), world.model.actuator_biasprm[number])
    for number in range(model.nu):
        name = model.actuator(number).name
        if f"{name} actuator" in commands:
            data.ctrl[number] = commands[f"{name} actuator"][0]
            continue
        joint = model.joint(int(model.actuator_trnid[number][0])).name
        command, bias = commands.get(joint, (0.0, (0.0, 0.0, 0.0)))
        gear = float(model.actuator_gear[number][0])
        data.ctrl[number] = (
            command * gear if bias[1] or bias[2] else command / (gear * model.actuator_gainprm[number][0])
        )
