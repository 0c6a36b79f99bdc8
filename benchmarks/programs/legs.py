"""Robots with joints from MJCF files, in turn with a loop around MuJoCo that steps the same file at the same step.

An *environment step* is one tick: new efforts for all joints, the steps of the engine, then the pose of the robot and
the values of all joints.

    python -m benchmarks.programs.legs ant.xml --n 64               # a batch
    python -m benchmarks.programs.legs ant.xml --mode step          # one simulation: publish, step(1), data
    python -m benchmarks.programs.legs ant.xml --mode gym --n 16    # morse.gym, beside SyncVectorEnv of Gymnasium

A batch also runs beside `mujoco.rollout`, which gets the efforts of all steps at once; the vectors beside Gymnasium's
own environment of a file that it has (``ant.xml``, ``half_cheetah.xml``, …), which needs its extra ``mujoco``.
"""

from __future__ import annotations

import argparse
import gc
import os
import resource
import statistics
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

os.environ.setdefault("MORSE_THREADS", "1")

import gymnasium
import mujoco
import mujoco.rollout
import numpy as np

import morse
from benchmarks import stopwatch

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

#: share of the largest effort of a joint that random commands use
_SHARE = 0.3
#: least number of steps between two restarts
_EPISODE = 50


def scene(file: str) -> Callable[[], None]:
    """A scene of a robot, with its joints and its pose."""

    def legs() -> None:
        from morse.builder import Armature, ArmaturePose, Environment, Pose, Robot

        robot = Robot(file, name="robot")
        (joints,) = (child.name for child in robot._bpy_object.children if child.name.endswith("_joints"))
        arm = Armature("arm", armature_name=joints)
        arm.control("effort")
        arm.append(ArmaturePose("angles"))
        robot.append(arm)
        robot.append(Pose("pose"))
        Environment("empty")

    return legs


class Bare:
    """A loop around N states of a file, with the time step that MORSE takes for it."""

    def __init__(self, file: str, count: int, like: Any) -> None:
        world = like.context.world
        self._model = model = mujoco.MjModel.from_xml_path(file)
        model.opt.timestep, self._steps = world.model.opt.timestep, world.steps
        if not any(model.geom_type[i] == mujoco.mjtGeom.mjGEOM_PLANE for i in range(model.ngeom)):
            spec = mujoco.MjSpec.from_file(file)
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[60.0, 60.0, 1.0])
            self._model = model = spec.compile()
            model.opt.timestep = world.model.opt.timestep
        self._datas = [mujoco.MjData(model) for _ in range(count)]
        self.joints = [j for j in range(model.njnt) if model.jnt_type[j] in (2, 3)]
        self._dofs = model.jnt_dofadr[self.joints]
        self.seen = np.zeros((count, model.nq + model.nv))

    def names(self) -> list[str]:
        return [self._model.joint(j).name for j in self.joints]

    def run(self, commands: NDArray[np.float64]) -> None:
        for command in commands:
            self.step(command)

    def step(self, commands: NDArray[np.float64]) -> None:
        model, steps, dofs = self._model, self._steps, self._dofs
        for row, data in enumerate(self._datas):
            data.qfrc_applied[dofs] = commands[row]
            mujoco.mj_step(model, data, steps)
            self.seen[row, : model.nq], self.seen[row, model.nq :] = data.qpos, data.qvel

    def restart(self) -> None:
        for data in self._datas:
            mujoco.mj_resetData(self._model, data)


class Rollout(Bare):
    """The same by one call of `mujoco.rollout` for all steps."""

    def run(self, commands: NDArray[np.float64]) -> None:
        model, (steps, count, _) = self._model, commands.shape
        control = np.zeros((count, steps * self._steps, model.nv))
        control[:, :, self._dofs] = np.repeat(commands.transpose(1, 0, 2), self._steps, axis=1)
        size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        start = np.zeros((count, size))
        for row, data in enumerate(self._datas):
            mujoco.mj_getState(model, data, start[row], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        spec = mujoco.mjtState.mjSTATE_QFRC_APPLIED.value
        mujoco.rollout.rollout(model, self._datas[0], start, control, control_spec=spec)


class Rows:
    """A batch by its public interface."""

    def __init__(self, file: str, count: int) -> None:
        self.many = many = morse.batch(scene(file), count)
        self.command = many.command("robot.arm")
        self.angles = many.read("robot.arm.angles")
        self.pose = many.read("robot.pose", "x", "y", "z", "yaw", "pitch", "roll")

    def run(self, commands: NDArray[np.float64]) -> None:
        for command in commands:
            self.step(command)

    def step(self, command: NDArray[np.float64]) -> None:
        self.command[:] = command
        self.many.step(1, measure=True)

    def restart(self) -> None:
        self.many.restart()


class Single:
    """One simulation by its handles: a command, a tick, the data."""

    def __init__(self, file: str) -> None:
        self.simulation = simulation = morse.load(scene(file))
        robot = simulation.robot
        self._arm, self._angles, self._pose = robot.arm, robot.arm.angles, robot.pose
        self._names = list(self._arm.component.local_data)
        self.seen: Any = None

    def run(self, commands: NDArray[np.float64]) -> None:
        for (command,) in commands:
            self._arm.publish(dict(zip(self._names, command.tolist(), strict=True)))
            self.simulation.step(1, measure=True)
            self.seen = self._angles.data, self._pose.data

    def restart(self) -> None:
        self.simulation.restart()


class _BareEnv(gymnasium.Env[Any, Any]):
    """The bare loop as an environment of Gymnasium."""

    def __init__(self, file: str, like: Any, high: NDArray[np.float64]) -> None:
        self._loop = Bare(file, 1, like)
        self.action_space = gymnasium.spaces.Box(-high.astype(np.float32), high.astype(np.float32))
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, self._loop.seen.shape[1:], np.float32)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self._loop.restart()
        return self._loop.seen[0].astype(np.float32), {}

    def step(self, action: Any) -> Any:
        before = self._loop.seen[0, 0]
        self._loop.step(np.asarray(action, float)[None])
        return self._loop.seen[0].astype(np.float32), float(self._loop.seen[0, 0] - before), False, False, {}


class Vector:
    """A vector of environments."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self.env = make()
        self.env.reset(seed=1)

    def run(self, commands: NDArray[np.float64]) -> None:
        # an environment of Gymnasium has no command for joints without motor
        for command in commands[..., : self.env.single_action_space.shape[0]].astype(np.float32):
            self.env.step(command)

    def restart(self) -> None:
        self.env.reset()


#: Gymnasium's environments of its files
_OWN = {"half_cheetah": "HalfCheetah", "walker2d": "Walker2d", "inverted_pendulum": "InvertedPendulum"}


def own_env(file: str, like: Any) -> Any:
    """Gymnasium's own environment of a file, with the time step of MORSE; None if it has none, or lacks its extra."""
    stem, world = Path(file).stem, like.context.world
    name = f"{_OWN.get(stem, stem.capitalize())}-v5"
    try:
        env = gymnasium.make(name, xml_file=file, frame_skip=world.steps, disable_env_checker=True)
    except (gymnasium.error.Error, ImportError, TypeError):
        return None
    env.unwrapped.model.opt.timestep = world.model.opt.timestep
    return env


def task_of(file: str, names: list[str], high: NDArray[np.float64]) -> Any:
    """The same as a task."""

    class Legs(morse.gym.Task):  # type: ignore[name-defined]
        ticks = 1
        action = morse.gym.Command("robot.arm", **{n: (-h, h) for n, h in zip(names, high.tolist(), strict=True)})
        observation = gymnasium.spaces.Box(-np.inf, np.inf, (len(names) + 6,), np.float32)
        data: ClassVar[dict[str, Any]] = {
            "angles": morse.gym.Read("robot.arm.angles", *names),
            "pose": morse.gym.Read("robot.pose", "x", "y", "z", "yaw", "pitch", "roll"),
        }

        def __init__(self) -> None:
            self.scene = scene(file)

        def observe(self, data: Any) -> Any:
            return np.concatenate([data["angles"], data["pose"]], axis=1)

        def reward(self, before: Any, now: Any) -> Any:
            return now["pose"][:, 0] - before["pose"][:, 0], np.zeros(len(self.many), bool), {}

    return Legs


def efforts(simulation: Any) -> tuple[list[str], NDArray[np.float64]]:
    """The joints, and the largest random command of each."""
    world, names = simulation.context.world, list(simulation.robot.arm.component.local_data)
    high = np.ones(len(names))
    for index, name in enumerate(names):
        for joints in world.joints.values():
            if name in joints and joints[name].actuator >= 0:
                limit = np.abs(world.model.actuator_forcerange[joints[name].actuator]).max()
                high[index] = limit if 0.0 < limit < 1e4 else 1.0
    return names, _SHARE * high


def memory_and_reset(file: str, count: int) -> dict[str, float]:
    """MB that a row adds, of which the engine's own, and ms of a reset."""

    def resident() -> float:
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6

    def run(rows: int) -> Rows:
        loop = Rows(file, rows)
        for _ in range(2):
            loop.step(np.zeros(loop.command.shape))
        return loop

    first = run(2)
    before = resident()
    loop = run(count)
    row = (resident() - before) / count
    model = first.many[0].context.world.model
    before = resident()
    datas = [mujoco.MjData(model) for _ in range(count)]
    for data in datas:
        mujoco.mj_step(model, data)
    own = (resident() - before) / count
    times = []
    for _ in range(9):
        begin = time.process_time()
        loop.restart()
        times.append((time.process_time() - begin) / count * 1e3)
    return {"row_mb": row, "engine_mb": own, "reset_ms": statistics.median(times)}


def main() -> None:
    """Run the loops in turn; report µs of processor time per environment step."""
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--n", type=int, default=1)
    parser.add_argument("--mode", choices=["batch", "step", "gym", "memory"], default="batch")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    file, count = str(Path(arguments.file).resolve()), arguments.n
    if arguments.mode == "memory":
        stopwatch.report(**memory_and_reset(file, count))
        return
    first = Single(file)
    bare = Bare(file, count, first.simulation)
    names, high = efforts(first.simulation)
    loops: dict[str, Any] = {"bare": bare}
    if arguments.mode == "step":
        loops["morse"] = first
    elif arguments.mode == "gym":
        import morse.gym

        task = task_of(file, names, high)
        loops["bare"] = Vector(
            lambda: gymnasium.vector.SyncVectorEnv([lambda: _BareEnv(file, first.simulation, high)] * count, copy=True)
        )
        loops["morse"] = Vector(lambda: morse.gym.vector(task, count))
        if own_env(file, first.simulation) is not None:
            loops["gymnasium"] = Vector(
                lambda: gymnasium.vector.SyncVectorEnv([lambda: own_env(file, first.simulation)] * count)
            )
    else:
        loops |= {"morse": Rows(file, count), "rollout": Rollout(file, count, first.simulation)}
    rng = np.random.default_rng(1)
    order = [bare.names().index(name) for name in names]
    times: dict[str, list[float]] = {name: [] for name in loops}
    # as long as a short episode, because the first step after a restart costs more
    steps = max(_EPISODE, 400 // count)
    for number in range(arguments.rounds + 1):
        commands = rng.uniform(-high, high, (steps, count, len(names)))
        for name, loop in loops.items():
            loop.restart()
            given = commands
            if name in ("bare", "rollout"):
                given = np.empty_like(commands)
                given[..., order] = commands
            begin = time.process_time()
            loop.run(given)
            if number:
                times[name].append((time.process_time() - begin) / steps / count * 1e6)
    ratios = {
        f"{name}_ratio": statistics.median(one / bare for one, bare in zip(each, times["bare"], strict=True))
        for name, each in times.items()
        if name not in ("bare", "morse")
    }
    ratio = statistics.median(m / b for m, b in zip(times["morse"], times["bare"], strict=True))
    each = {f"{name}_us": statistics.median(one) for name, one in times.items()}
    stopwatch.report(cost_ratio=ratio, **each, **ratios)


if __name__ == "__main__":
    main()
