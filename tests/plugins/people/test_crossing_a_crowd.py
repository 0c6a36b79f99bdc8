"""The learning task of crossing a crowd, and the messages of people."""

import math
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import morse
import morse.gym  # registers the tasks
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode, encode

NAME = "morse/CrossCrowd-v0"


def _drive(env, seed, action):
    observation, _ = env.reset(seed=seed)
    while True:
        observation, _, terminated, truncated, info = env.step(action(observation))
        if terminated or truncated:
            return info


def _to_the_goal(observation):
    bearing = math.atan2(observation[2], observation[1])
    return np.array([1.2, np.clip(2.0 * bearing, -1.5, 1.5)], np.float32)


@pytest.mark.filterwarnings("ignore:.*recommend using a symmetric.*")
def test_the_checker_of_gymnasium_accepts_the_task():
    env = gymnasium.make(NAME)
    check_env(env.unwrapped, skip_render_check=True)
    env.close()


def test_the_measures_are_those_of_the_way():
    env = gymnasium.make(NAME, people=4)
    stand = np.zeros(2, np.float32)
    # the start is 1.5 m beside the streams: nobody comes into the personal space of a robot that waits
    observation, _ = env.reset(seed=3)
    for _ in range(20):
        observation, _, terminated, _, info = env.step(stand)
    assert not terminated
    assert info["time"] == pytest.approx(2.0)
    assert info["intrusion"] == info["collisions"] == 0.0
    assert observation[0] == pytest.approx(0.8, abs=0.05)
    nearest = observation[7] * 5.0
    assert 0.0 < info["closest"] <= nearest + 1e-6
    ends = [_drive(env, seed, _to_the_goal) for seed in range(6)]
    assert any(end["is_success"] for end in ends)
    for end in ends:
        assert end["is_success"] == (end["collisions"] == 0)
        assert end["intrusion"] <= end["time"] <= 30.0
        assert end["time"] > 3.0
        if end["intrusion"] == 0.0:
            assert end["closest"] > 0.9
    env.close()


def test_a_vector_has_the_rows_of_single_environments():
    many = gymnasium.make_vec(NAME, num_envs=2)
    one = gymnasium.make(NAME)
    observations, _ = many.reset(seed=[4, 5])
    action = np.tile(np.array([0.8, 0.1], np.float32), (2, 1))
    for _ in range(15):
        observations, *_ = many.step(action)
    for row, seed in enumerate((4, 5)):
        observation, _ = one.reset(seed=seed)
        for _ in range(15):
            observation, *_ = one.step(action[row])
        assert np.array_equal(observation, observations[row])
    many.close()
    one.close()


@pytest.mark.parametrize("people", [0, -3, 10**6])
def test_a_crowd_that_cannot_be_is_refused(people):
    with pytest.raises(ValueError, match="1 to 200"):
        gymnasium.make(NAME, people=people)


def test_trackers_publish_people_and_agents(tmp_path):
    """The fields of people_msgs and hunav_msgs, in a recording."""
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 2, deviation=0.0, groups=1.0)
crowd.start(places=[(2.0, 0.0), (2.0, 1.0)])
crowd.goals([(9.0, 0.5)])
robot = FakeRobot("robot")
tracker = PeopleTracker("tracker")
robot.append(tracker)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path, record=str(tmp_path / "run.mcap")) as sim:
        sim.step(60)
        truth = sim.people.data["positions"], sim.people.data["velocities"]
    found = {}
    with Recording(tmp_path / "run.mcap") as recording:
        for channel in recording.channels.values():
            for message in recording.messages({channel.number}):
                if "tracker" in channel.topic:
                    found[channel.type] = decode(channel.type, bytes(message.data))
    people = found["people_msgs/msg/People"]
    assert people["header"]["frame_id"] == "map"
    assert [one["name"] for one in people["people"]] == ["people 0", "people 1"]
    first = people["people"][0]
    assert (first["position"]["x"], first["position"]["y"]) == pytest.approx(truth[0][0, :2], abs=0.15)
    assert dict(zip(first["tagnames"], first["tags"], strict=True))["state"] == "walks"
    agent = found["hunav_msgs/msg/Agents"]["agents"][1]
    assert (agent["id"], agent["type"], agent["group_id"], agent["name"]) == (1, 1, 0, "people 1")
    assert agent["desired_velocity"] == pytest.approx(1.34)
    assert agent["linear_vel"] == pytest.approx(np.hypot(*truth[1][1, :2]), abs=0.15)
    turn = agent["position"]["orientation"]
    assert 2.0 * math.atan2(turn["z"], turn["w"]) == pytest.approx(agent["yaw"])
    kind = "hunav_msgs/msg/Agents"
    assert decode(kind, encode(kind, found[kind])) == found[kind]


@pytest.mark.parametrize(
    ("tasks", "said"),
    [
        ('{"my_lab/Park-v0": "my_lab.park:Park"}', "my_lab/Park-v0"),
        ('{"morse/Reach-v0": "my_lab.park:Park"}', "morse.gym.reach"),
        ('{"my_lab/Park-v0": 7}', "are left out"),
        ("[1, 2]", "expected a dictionary of names"),
        ("1 / 0", "are left out"),
    ],
)
def test_tasks_of_packages_are_registered_or_named(tmp_path, tasks, said):
    (tmp_path / "my_lab.py").write_text(f"TASKS = {tasks}\n", "utf-8")
    info = tmp_path / "my_lab-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text("[morse.tasks]\nmy_lab = my_lab:TASKS\n", "utf-8")
    program = (
        f"import sys; sys.path.append({str(tmp_path)!r})\nimport logging; logging.basicConfig()\n"
        "import morse.gym, gymnasium\n"
        "for name in ('my_lab/Park-v0', 'morse/Reach-v0', 'morse/CrossCrowd-v0'):\n"
        "    print(name in gymnasium.registry and (name, gymnasium.registry[name].entry_point.args))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert said in done.stdout + done.stderr
    assert "morse/CrossCrowd-v0" in done.stdout
