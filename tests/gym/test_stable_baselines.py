"""The vector for Stable-Baselines3: its interface."""

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from gym_tasks import LookAround

import morse.gym


@pytest.fixture
def baselines():
    pytest.importorskip("stable_baselines3", reason="it is installed in the nightly run: pip install stable-baselines3")
    vectors = []

    def make(*words, **more):
        vectors.append(morse.gym.baselines(*words, **more))
        return vectors[-1]

    yield make
    for vector in vectors:
        vector.close()


def test_without_the_library_the_error_says_what_to_install():
    try:
        import stable_baselines3  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="pip install stable-baselines3"):
            _ = morse.gym.baselines


@pytest.mark.parametrize("workers", [0, 2])
@pytest.mark.peer("stable-baselines3", does="its vector has the rows of ours")
def test_rows_are_those_of_the_vector(baselines, workers):
    ours, theirs = morse.gym.vector(LookAround, 4), baselines(LookAround, 4, workers=workers)
    theirs.seed(5)
    first, _ = ours.reset(seed=5)
    _same(theirs.reset(), first)
    ended = 0
    for step in range(2 * LookAround.limit):
        actions = np.full((4, 2), 0.1 * (step % 5), np.float32)
        now, rewards, over, late, infos = ours.step(actions)
        observations, theirs_rewards, done, rows = theirs.step(actions)
        _same(observations, now)
        assert theirs_rewards.tolist() == rewards.astype(np.float32).tolist()
        assert done.tolist() == (over | late).tolist()
        for row in np.flatnonzero(done):
            ended += 1
            assert rows[row]["TimeLimit.truncated"] == (late[row] and not over[row])
            _same(rows[row]["terminal_observation"], infos["final_obs"][row])
    ours.close()
    assert ended >= 4


def _same(here, there):
    assert here.keys() == there.keys()
    for name, value in there.items():
        assert np.array_equal(here[name], value), name
