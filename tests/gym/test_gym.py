"""Environments of Gymnasium and PettingZoo: the checkers of these libraries, seeds, processes."""

import copy
import os
import pickle
import re
import signal
import urllib.error
import urllib.request
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gym_tasks import Fragile, Frail, LookAround, Meet, Picture, two_robots
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import NormalizeObservation, RecordEpisodeStatistics

import morse.gym
from morse.gym import Command, Read
from morse.gym.crossing import AGENTS, Crossing
from morse.gym.reach import Reach, ReachDepth
from morse.gym.walk import Walk
from morse.many import normal, uniform
from tests.kit.programs import python


@pytest.mark.parametrize("task", [Reach, ReachDepth, Walk, LookAround, Picture])
@pytest.mark.peer("gymnasium", does="its checker accepts the environments")
def test_gymnasium_checks_it(task):
    env = morse.gym.TaskEnv(task, render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*symmetric and normalized.*")
        check_env(env, skip_render_check=issubclass(task, (Reach, Walk)))  # a view of the scene takes long
    env.close()


@pytest.mark.parametrize("task", [Reach, ReachDepth, Walk, LookAround, Picture])
def test_stable_baselines_checks_it(task):
    try:
        from stable_baselines3.common.env_checker import check_env as check
    except ImportError:
        return  # it brings torch, of some gigabytes, which MORSE does not install
    env = morse.gym.TaskEnv(task)
    check(env)
    env.close()


@pytest.mark.slow
@pytest.mark.peer("stable-baselines3")
def test_stable_baselines_learns():
    pytest.importorskip("stable_baselines3")
    page = (Path(__file__).parents[2] / "docs" / "gym.md").read_text(encoding="utf-8")
    example = next(text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "stable_baselines3" in text)
    functions: dict = {}
    exec(example, functions)
    model = functions["learn"](512)
    assert model.num_timesteps >= 512


def test_spaces_come_from_declarations():
    env = morse.gym.TaskEnv(LookAround)
    space = env.observation_space
    assert space["image"] == gymnasium.spaces.Box(0, 255, (36, 40, 3), np.uint8)
    assert space["pose"].shape == (3,)
    assert space["pose"].high[2] == np.float32(np.pi)
    assert env.action_space == gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)
    env.close()


def test_made_by_name():
    env = gymnasium.make("morse/Reach-v0")
    first, _ = env.reset(seed=4)
    again, _ = env.reset(seed=4)
    other, _ = env.reset(seed=5)
    assert (first == again).all()
    assert (first != other).any()
    env.close()
    with gymnasium.make("morse/Reach-v0", layouts=[7]) as one:
        assert [scene.__name__ for scene in one.unwrapped.task.scene] == ["arena 7"]
    many = gymnasium.make_vec("morse/Reach-v0", num_envs=3, layouts=range(70, 73))
    assert many.num_envs == 3
    assert many.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    many.close()


def test_rows_are_as_alone_with_any_number_of_workers():
    count, rng = 5, np.random.default_rng(0)
    vectors = [morse.gym.vector(Reach, count), morse.gym.vector(Reach, count, workers=2)]
    try:
        firsts = [env.reset(seed=7)[0] for env in vectors]
        assert (firsts[0] == firsts[1]).all()
        ended = 0
        for _ in range(60):
            actions = rng.uniform([0.0, -1.5], [1.0, 1.5], (count, 2))
            (one, *ones, first_infos), (two, *twos, infos) = [env.step(actions) for env in vectors]
            assert (one == two).all()
            for a, b in zip(ones, twos, strict=True):
                assert (a == b).all()
            assert set(first_infos) == set(infos)
            done = ones[1] | ones[2]
            ended += done.sum()
            if done.any():
                assert (infos["_final_obs"] == done).all()
                for row in np.flatnonzero(done):
                    assert (infos["final_obs"][row] == first_infos["final_obs"][row]).all()
                    assert (infos["final_obs"][row] != two[row]).any()
        assert ended > 0
    finally:
        for env in vectors:
            env.close()


@pytest.mark.parametrize("workers", [0, 2])
def test_modes_of_beginning_anew(workers):
    """The episodes of all modes are the same; they differ in the steps in which they begin."""
    done, starts = {}, {}
    for mode in AutoresetMode:
        env = morse.gym.vector(LookAround, 2, workers=workers, autoreset_mode=mode.value)
        assert env.metadata["autoreset_mode"] is mode
        env.reset(seed=1)
        ends, firsts = [], []
        for number in range(2 * LookAround.limit + 2):
            observations, rewards, _, late, infos = env.step(np.ones((2, 2), np.float32))
            if ends and number == ends[-1] + 1 and mode is AutoresetMode.NEXT_STEP:
                assert not rewards.any()
                assert not infos["_x"].any()
                firsts.append(observations)
            if late.all():
                ends.append(number)
                assert ("final_obs" in infos) == (mode is AutoresetMode.SAME_STEP)
                if mode is AutoresetMode.SAME_STEP:
                    firsts.append(observations)
                elif mode is AutoresetMode.DISABLED:
                    with pytest.raises((ResetNeeded, RuntimeError), match=r"episodes of the rows \[0"):
                        env.step(np.zeros((2, 2), np.float32))
                    firsts.append(env.reset(options={"reset_mask": late})[0])
        done[mode], starts[mode] = ends, firsts
        env.close()
    limit = LookAround.limit
    assert done[AutoresetMode.SAME_STEP] == done[AutoresetMode.DISABLED] == [limit - 1, 2 * limit - 1]
    assert done[AutoresetMode.NEXT_STEP] == [limit - 1, 2 * limit]
    for first in starts.values():
        for name, value in first[0].items():
            assert np.array_equal(value, starts[AutoresetMode.SAME_STEP][0][name])


def test_wrappers_of_vectors():
    env = morse.gym.vector(Reach, 2, autoreset_mode="NextStep")
    env = RecordEpisodeStatistics(NormalizeObservation(env))
    env.reset(seed=0)
    assert env.step(env.action_space.sample())[0].shape == (2, 40)
    env.close()


def test_an_action_for_several_actuators_and_a_space_of_several_parts():
    class Two(LookAround):
        scene, limit = two_robots, 6
        action = (Command("r0.motion", v=(-1.0, 1.0)), Command("r1.motion", v=(-2.0, 2.0), w=(-1.0, 1.0)))
        observation = gymnasium.spaces.Dict({"goal": gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)})
        data = {"a": Read("r0.pose", "x"), "b": Read("r1.pose", "x")}  # noqa: RUF012

        def start(self, rows, rngs):
            self.values["goal"][rows] = 0.5

        def reward(self, before, now):
            return now["b"] - before["b"], np.abs(now["a"] - before["a"]) > 1.0, {"a": now["a"]}

    env = morse.gym.TaskEnv(Two)
    check_env(env)
    assert env.action_space == gymnasium.spaces.Box(np.float32([-1, -2, -1]), np.float32([1, 2, 1]))
    assert list(env.observation_space.spaces) == ["goal"]
    env.reset(seed=0)
    _, reward, _, _, infos = env.step(np.float32([-0.5, 2.0, 0.0]))
    assert reward == pytest.approx(0.2, abs=1e-4)
    assert infos["a"] == pytest.approx(-0.05, abs=1e-4)
    env.close()


def test_truncation_is_not_termination():
    env = morse.gym.vector(LookAround, 2)
    env.reset(seed=1)
    for number in range(LookAround.limit):
        observations, _, ended, late, infos = env.step(np.zeros((2, 2)))
        assert not ended.any()
        assert late.all() == (number == LookAround.limit - 1)
    assert infos["final_obs"][0]["image"].shape == (36, 40, 3)
    assert observations["image"].shape == (2, 36, 40, 3)
    assert env.observation_space.contains(observations)
    env.close()


def test_each_episode_draws_parameters():
    class Varied(LookAround):
        vary = {"robot": {"mass": uniform(20.0, 30.0), "friction": uniform(0.5, 1.0)}}  # noqa: RUF012

    env = morse.gym.vector(Varied, 3)
    _, infos = env.reset(seed=2)
    masses = infos["robot.mass"]
    assert len(set(masses.tolist())) == 3
    assert ((masses >= 20.0) & (masses <= 30.0)).all()
    _, again = env.reset(seed=2)
    assert (again["robot.mass"] == masses).all()
    assert [sim.robot.component.bge_object.mass for sim in env._rows.episodes.many] == pytest.approx(masses.tolist())
    env.close()


def test_rows_draw_arguments_of_the_scene_poses_and_colours():
    def scene(noise=0.0, obstacle=3.0):
        from morse.builder import ATRV, Cube, Environment, MotionVW, Pose

        robot = ATRV("robot")
        pose = Pose("pose")
        if noise:
            pose.alter("Noise", pos_std=noise, rot_std=0.0)
        for part in (MotionVW("motion"), pose):
            robot.append(part)
        box = Cube("Box")
        box.location = (obstacle, 0.0, 1.0)
        box._bpy_object.game.physics_type = "STATIC"
        Environment("empty")

    class Drawn(morse.gym.Task):
        arguments = {"noise": uniform(0.1, 0.2), "obstacle": uniform(2.0, 9.0)}  # noqa: RUF012
        vary = {"Box": {"y": uniform(4.0, 5.0), "color": uniform(0.0, 1.0)}, "robot": {"yaw": normal(0.0, 0.5)}}  # noqa: RUF012
        action = morse.gym.Command("robot.motion", v=(-1.0, 1.0), w=(-1.0, 1.0))
        observation = morse.gym.Read("robot.pose", "x", "y", "yaw")

        def reward(self, before, now):
            return 0.0, False, {}

    Drawn.scene = staticmethod(scene)
    drawn = []
    for workers in (0, 2):
        env = morse.gym.vector(Drawn, 4, workers=workers)
        observations, infos = env.reset(seed=3)
        drawn.append((observations, infos))
        if not workers:
            boxes = [sim.world.objects_by_name["Box"] for sim in env._rows.episodes.many]
            assert [box.worldPosition[0] for box in boxes] == pytest.approx(infos["scene.obstacle"].tolist())
            assert [box.worldPosition[1] for box in boxes] == pytest.approx(infos["Box.y"].tolist())
            assert [box.node.color[:3] for box in boxes] == [tuple(color) for color in infos["Box.color"].tolist()]
            assert observations[:, 2] == pytest.approx(infos["robot.yaw"], abs=0.05)
        env.close()
    assert len(set(drawn[0][1]["scene.obstacle"].tolist())) == 4
    assert (drawn[0][0] == drawn[1][0]).all()
    for name, values in drawn[0][1].items():
        assert (values == drawn[1][1][name]).all(), name


@pytest.mark.peer("pettingzoo", does="its checkers accept the environments")
def test_pettingzoo_checks_it():
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    def make():
        return morse.gym.parallel(Meet, agents=["r0", "r1"])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        env = make()
        parallel_api_test(env, num_cycles=60)
        env.close()
        parallel_seed_test(make, num_cycles=20)
    with pytest.raises(KeyError, match=r"no robot 'r3'"):
        morse.gym.parallel(Meet, agents=["r0", "r3"])


def test_pettingzoo_checks_three_robots_that_cross():
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    def make():
        return morse.gym.parallel(Crossing, AGENTS)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        env = make()
        parallel_api_test(env, num_cycles=110)
        # straight ahead they meet in the middle
        env.reset(seed=1)
        crashed = set()
        while env.agents:
            seen = {agent: env._episodes.task.observe(env._episodes._now)[row] for row, agent in enumerate(AGENTS)}
            actions = {agent: np.float32([1.0, np.clip(3.0 * seen[agent][38], -1.5, 1.5)]) for agent in env.agents}
            _, _, ended, _, infos = env.step(actions)
            crashed |= {agent for agent, over in ended.items() if over and not infos[agent]["is_success"]}
        assert len(crashed) >= 2
        env.close()
        parallel_seed_test(make, num_cycles=20)


def test_a_process_that_dies_is_named():
    env = morse.gym.vector(Reach, 2, workers=2)
    env.reset(seed=1)
    os.kill(env._rows.parts.workers[1].pid, signal.SIGKILL)
    with pytest.raises(RuntimeError, match="the process of the rows 1 to 1 has ended by SIGKILL"):
        env.step(np.zeros((2, 2)))
    other = morse.gym.vector(Reach, 2)
    for mended, whole in zip(
        env.reset(seed=4)[:1] + env.step(np.ones((2, 2))),
        other.reset(seed=4)[:1] + other.step(np.ones((2, 2))),
        strict=True,
    ):
        if not isinstance(whole, dict):
            assert np.array_equal(mended, whole)
    env.close()
    other.close()


def test_a_program_that_does_not_close_a_vector_leaves_nothing_behind():
    code = (
        "import morse.gym; from morse.gym.reach import Reach\n"
        "if __name__ == '__main__':\n    env = morse.gym.vector(Reach, 2, workers=2); env.reset(seed=1)"
    )
    outcome = python("-c", code)
    assert (outcome.returncode, outcome.stderr) == (0, "")


class _Told(Meet):
    """Infos in all forms: a number for all rows, a text, an array, a list, a vector for each row."""

    def reward(self, before, now):
        rows = len(now["observation"])
        infos = {"goal": 2.0, "name": "near", "x": now["observation"][:, 0], "list": [1] * rows, "none": None}
        return 0.0, False, infos | {"pair": np.ones((rows, 2))}


class _ToldAlone(_Told):
    action, observation = Command("r0.motion", v=(-1.0, 1.0), w=(-1.0, 1.0)), Read("r0.pose", "x", "y", "yaw")

    def start(self, rows, rngs):
        pass


def test_infos_have_the_same_forms_alone_in_vectors_and_for_agents():
    def alone(infos):
        return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in infos.items()}

    env, agents = morse.gym.TaskEnv(_ToldAlone), morse.gym.parallel(_Told, ["r0", "r1"])
    env.reset(seed=0)
    expected = alone(env.step(np.zeros(2))[4])
    assert expected | {"x": 0} == {"goal": 2.0, "name": "near", "x": 0, "list": 1, "none": None, "pair": [1.0, 1.0]}
    assert type(expected["name"]) is str
    env.close()
    agents.reset(seed=0)
    for infos in agents.step(dict.fromkeys(["r0", "r1"], np.zeros(2)))[4].values():
        assert alone(infos) | {"x": 0} == expected | {"x": 0}
    agents.close()
    for workers in (0, 2):
        vector = morse.gym.vector(_ToldAlone, 2, workers=workers)
        vector.reset(seed=0)
        infos = vector.step(np.zeros((2, 2)))[4]
        for row in range(2):
            assert all(infos[f"_{name}"][row] for name in expected)
            assert alone({name: infos[name][row] for name in expected}) == expected
        vector.close()


@pytest.mark.parametrize("value", [[1.0, 2.0, 3.0], np.zeros((1, 2))])
def test_an_info_with_another_number_of_rows_is_named(value):
    class Wrong(LookAround):
        def reward(self, before, now):
            return 0.0, False, {"many": value}

    env = morse.gym.vector(Wrong, 2)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"Wrong.reward has returned the info 'many' .* or an array \(2, ...\)"):
        env.step(np.zeros((2, 2)))
    env.close()


def test_components_are_named_in_one_way_in_batches_teams_and_cameras():
    def of(task, change):
        return type("Other", (task,), change)

    for make in (
        lambda name: morse.gym.TaskEnv(of(LookAround, {"observation": Read(name, "x")})),
        lambda name: morse.gym.parallel(of(Meet, {"observation": Read(name, "x")}), ["r0", "r1"]),
    ):
        for name, message in (
            ("nobody.pose", "no robot 'nobody'"),
            ("nobody", "no robot 'nobody'"),
            (7, "a component is given by its full name"),
        ):
            with pytest.raises((KeyError, TypeError), match=message):
                make(name)
    for task, robot in ((LookAround, "robot"), (Meet, "r0")):
        with pytest.raises(KeyError, match=rf"{robot} has no 'posse'; did you mean 'pose'"):
            morse.gym.TaskEnv(
                of(task, {"action": Command(f"{robot}.motion", v=(0.0, 1.0)), "observation": Read(f"{robot}.posse")})
            )
    env = morse.gym.TaskEnv(of(Picture, {"camera": "robot.camra"}), render_mode="rgb_array")
    env.reset(seed=0)
    with pytest.raises(KeyError, match=r"robot has no 'camra'; did you mean 'camera'"):
        env.render()
    env.close()


class _Reward:
    """A task that returns something else than rewards, ends and infos."""

    def __init__(self, value):
        self.value = value

    def __call__(self):
        task = LookAround()
        task.reward = lambda _before, _now: self.value
        return task


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ((np.zeros(7), False, {}), r"LookAround.reward has returned rewards of the shape \(7,\), expected \(2,\)"),
        ((0.0, np.zeros((2, 1)), {}), r"ends of episodes of the shape \(2, 1\)"),
        ((np.array([0.0, np.nan]), False, {}), "has returned NaN for row 1"),
        (np.zeros(2), "returns rewards .N,., whether the episodes are over .N,., and a dictionary of infos"),
        (None, "LookAround.reward returns"),
    ],
)
def test_wrong_results_of_a_task_are_named(value, message):
    env = morse.gym.vector(_Reward(value), 2)
    env.reset(seed=0)
    with pytest.raises((TypeError, ValueError), match=message):
        env.step(np.zeros((2, 2)))
    env.close()


@pytest.mark.parametrize("workers", [0, 2])
def test_wrong_actions_are_named_and_no_time_passes(workers):
    env = morse.gym.vector(LookAround, 2, workers=workers)
    if not workers:
        with pytest.raises(ResetNeeded, match="call reset"):
            env.step(np.zeros((2, 2)))
    env.reset(seed=0)
    for actions, message in (
        (np.zeros((3, 2)), r"the shape \(3, 2\), expected \(2, 2\)"),
        ([[0.0, 0.0], [np.nan, 0.0]], r"the action of row 1 is \[nan, 0.0\]"),
        ("go", "an array of numbers of the shape .2, 2., not 'go'"),
        (None, "shape"),
    ):
        with pytest.raises(ValueError, match=message):
            env.step(actions)
    other = morse.gym.vector(LookAround, 2)
    other.reset(seed=0)
    after, expected = (one.step(np.zeros((2, 2)))[0] for one in (env, other))
    assert np.array_equal(after["pose"], expected["pose"])
    other.close()
    env.close()
    env.close()
    with pytest.raises(ClosedEnvironmentError, match="make it again"):
        env.step(np.zeros((2, 2)))


def test_names_that_are_not_there_are_named():
    class Misspelt(LookAround):
        def reward(self, before, now):
            return now["posse"][:, 0], False, {}

    env = morse.gym.TaskEnv(Misspelt)
    with pytest.raises(ValueError, match=r"have the shape \(3,\), expected \(2,\)"):
        env.step(np.zeros(3))
    env.reset(seed=0)
    with pytest.raises(KeyError, match="no data 'posse'; did you mean 'pose'"):
        env.step(np.zeros(2))
    for copied in (copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="pass a function that makes it"):
            copied(env)
        with pytest.raises(TypeError, match="send its scene"):
            copied(env.task.many)
        with pytest.raises(TypeError, match="send its scene"):
            copied(env.task.many[0])
    env.close()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"action": None}, "has no attribute 'action'"),
        ({"scene": None}, "has no attribute 'scene'"),
        ({"observation": 3}, "'observation' is a Read, a Touch or a space"),
        ({"observation": morse.gym.Read("robot.camera", "imago")}, "no field 'imago'"),
        ({"action": "robot.motion"}, "action is a morse.gym.Command"),
        ({"action": []}, "action is a morse.gym.Command or a list of them"),
        ({"ticks": 0}, "'ticks' of Wrong is at least 1, not 0"),
        ({"ticks": 2.5}, "'ticks' of Wrong is an integer, not 2.5"),
        ({"limit": "60"}, "'limit' of Wrong is an integer, not '60'"),
    ],
)
def test_mistakes_in_a_task_are_named(change, message):
    with pytest.raises((TypeError, KeyError, ValueError), match=message):
        morse.gym.TaskEnv(type("Wrong", (Picture,), change))


def test_mistakes_of_a_caller_are_named():
    with pytest.raises(ValueError, match="two finite numbers"):
        morse.gym.Command("robot.motion", v=(1.0, 0.0))
    with pytest.raises(ValueError, match="render_mode is 'rgb_array'"):
        morse.gym.TaskEnv(Reach, render_mode="human")
    with pytest.raises(ValueError, match="1 to 2 workers"):
        morse.gym.vector(Reach, 2, workers=3)
    with pytest.raises(ValueError, match="'NextStep', 'SameStep', 'Disabled', not 'never'"):
        morse.gym.vector(Reach, 2, autoreset_mode="never")
    with pytest.raises(TypeError, match=r"gymnasium\.make_vec knows tasks by their names"):
        morse.gym.vector("morse/Reach-v0", 2)


def test_a_name_that_imports_the_tasks():
    code = "import gymnasium; gymnasium.make('morse.gym:morse/Reach-v0').close()"
    outcome = python("-c", code)
    assert outcome.returncode == 0, outcome.stderr


def test_a_missing_extra_is_named():
    code = "import sys; sys.modules['gymnasium'] = None; import morse.gym"
    outcome = python("-c", code)
    assert 'pip install "gymnasium>=1.1,<2" "pettingzoo>=1.25"' in outcome.stderr.splitlines()[-1]


@pytest.mark.parametrize("workers", [0, 2])
def test_a_page_shows_a_row_of_any_process(workers):
    env = morse.gym.vector(LookAround, 4, workers=workers)
    try:
        env.reset(seed=1)
        url = env.show(3).url
        assert urllib.request.urlopen(url, timeout=60.0).status == 200
        env.step(env.action_space.sample())
        with pytest.raises(IndexError, match="row"):
            env.show(4)
    finally:
        env.close()
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(url, timeout=60.0)


def test_a_page_shows_a_single_environment_and_agents():
    agents = morse.gym.parallel(Meet, ["r0", "r1"])
    agents.reset(seed=1)
    assert urllib.request.urlopen(agents.show().url, timeout=60.0).status == 200
    agents.step({"r0": np.zeros(2), "r1": np.zeros(2)})
    with pytest.raises(ValueError, match="the action of 'r1' is missing"):
        agents.step({"r0": np.zeros(2)})
    agents.close()
    env = gymnasium.make("morse/Reach-v0")
    env.reset(seed=1)
    assert urllib.request.urlopen(env.unwrapped.show().url, timeout=60.0).status == 200
    env.close()


SPAWNED = """
import morse.system.workers
morse.system.workers.kind_of_start = lambda: "spawn"  # as on systems that cannot copy processes
import morse.gym
from morse.gym.reach import Reach
"""


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("env = morse.gym.vector(Reach, 2, workers=2)", "below `if __name__ == '__main__':`"),
        (
            "if __name__ == '__main__':\n    def local():\n        class Mine(Reach): pass\n        return Mine\n"
            "    env = morse.gym.vector(local(), 2, workers=2)",
            "a class at the top of a file",
        ),
        ("if __name__ == '__main__':\n    morse.gym.vector(Reach, 2, workers=1).close()", ""),
    ],
)
def test_processes_that_are_not_copies(tmp_path, program, message):
    script = tmp_path / "program.py"
    script.write_text(f"{SPAWNED}{program}\n")
    outcome = python(script)
    assert message in (outcome.stderr.splitlines() or [""])[-1]
    assert bool(message) == bool(outcome.returncode)


def _stepped(env):
    env.reset(seed=3)
    for _ in range(4):
        env.step(np.zeros(env.action_space.shape, np.float32))


def test_a_sensor_that_fails_is_an_error():
    """Training went on with what it had measured last."""
    for make in (lambda: morse.gym.TaskEnv(Fragile), lambda: morse.gym.vector(Fragile, 3)):
        env = make()
        with pytest.raises(ValueError, match="too frail") as caught:
            _stepped(env)
        assert any("robot.frail failed in tick" in note for note in caught.value.__notes__)
        env.close()
    env = morse.gym.vector(Fragile, 2, workers=2)
    with pytest.raises(RuntimeError, match="in the process of the rows 1 to 1: ValueError: too frail"):
        _stepped(env)
    env.close()


def test_a_sensor_that_fails_is_an_error_of_several_agents():
    """Their world went on without the sensor."""
    env = morse.gym.parallel(Fragile, ["robot"])
    env.reset(seed=3)
    still = {"robot": np.zeros(env.action_space("robot").shape, np.float32)}
    with pytest.raises(ValueError, match="too frail"):
        list(map(env.step, [still] * 4))
    env.close()


def test_agents_are_rows_as_those_of_a_batch():
    """Mistakes of a task with agents are those of a batch: nobody is placed if one pose is wrong."""
    env = morse.gym.parallel(Meet, agents=["r0", "r1"])
    env.reset(seed=1)
    rows, places = env._episodes.many, env._episodes.many.read("{agent}.pose", "x", "y")
    before = places.copy()
    with pytest.raises(ValueError, match="finite"):
        rows.place([0, 1], "{agent}", [[1.0, 1.0, 0.0], [1.0, np.nan, 0.0]])
    rows.measure([0, 1])
    assert np.array_equal(places, before)
    with pytest.raises(TypeError, match="pose is a sensor: use read"):
        rows.command("{agent}.pose", "x")
    with pytest.raises(ValueError, match="mass has the shape"):
        rows.vary("{agent}", rows=[0, 1], mass=[1.0, 2.0, 3.0])
    env.close()


def test_a_sensor_that_fails_at_the_end_is_an_error_of_close(monkeypatch):
    for make in (lambda: morse.gym.TaskEnv(Fragile), lambda: morse.gym.vector(Fragile, 3)):
        monkeypatch.setattr(Frail, "fails", "")
        env = make()
        _stepped(env)
        monkeypatch.setattr(Frail, "fails", "while it ends")
        with pytest.raises(OSError, match="no end"):
            env.close()
