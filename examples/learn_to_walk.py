"""A robot with four legs learns to walk over rough ground: augmented random search with numpy alone.

    python examples/learn_to_walk.py                  # walks with the weights of learn_to_walk.json over unseen ground
    python examples/learn_to_walk.py --learn          # learns them again, in about four minutes on two quiet cores
    python examples/learn_to_walk.py --learn --rounds 10 --weights mine.json --picture curve.svg
    python examples/learn_to_walk.py --view walk.webp # a picture of the robot while it walks

The task is `morse.gym.walk`. The search is that of Mania, Guy and Recht, "Simple random search provides a competitive
approach to reinforcement learning" (2018), with a momentum: a linear policy is disturbed in random directions, to both
sides, and moves towards those that walk farther. The legs of the left and of the right side have the same weights.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

# small matrices: more threads only wait for each other
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import learn_to_drive
import numpy as np

import morse.gym
from morse.gym.walk import Walk

WEIGHTS = Path(__file__).with_suffix(".json")
ROWS, WORKERS = 64, 2  # simulations, of which each pair tries one direction; processes
ROUNDS, LENGTH = 40, 120  # of the search; actions of an episode of it
PERIOD = Walk.ticks / 60.0  # of an action, s
NOISE, RATE, MOMENTUM = 0.1, 0.1, 0.5  # of the weights; noise and rate end at a third of it
# what the right side sees of the observation of the left side: half a period later, left and right exchanged
MIRROR = np.array([-1.0, -1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0])
SCALE = np.array([1.0, 1.0, 0.2, 0.2, 0.3, 1.0, 1.0, 1.0])
OUTPUTS, INPUTS = 4, 11  # hip of front and rear leg, knees of them; observation, second harmonic of the clock, one


class Trot(Walk):
    """The ground of the search; the robot of each pair of rows has the same."""

    def __init__(self):
        super().__init__(layouts=np.repeat(np.arange(ROWS // 2), 2).tolist())


def features(seen, scale=SCALE):
    """(N, 8) observations to (N, 11) inputs of the policy."""
    sine, cosine = seen[:, :1], seen[:, 1:2]
    ones = np.ones((len(seen), 1))
    return np.hstack([np.clip(seen / scale, -3.0, 3.0), 2.0 * sine * cosine, cosine**2 - sine**2, ones])


def actions(weights, seen):
    """The actions, -1 to 1, of one policy (4, 11) or of one for each row (N, 4, 11)."""
    chosen = np.empty((len(seen), 2 * OUTPUTS))
    for side, sight in enumerate((seen, seen * MIRROR)):
        chosen[:, side::2] = (weights @ features(sight)[:, :, None])[:, :, 0]
    return chosen


def walk(envs, weights, length, seed, act=actions):
    """Walk an episode in each row, and return the sums of the rewards, how far each came (m), and who stays up."""
    low, high = envs.single_action_space.low, envs.single_action_space.high
    seen, _ = envs.reset(seed=seed)
    rewards, way, up = np.zeros(len(seen)), np.zeros(len(seen)), np.ones(len(seen), bool)
    for _ in range(length):
        seen, news, ended, late, infos = envs.step(learn_to_drive.scaled(act(weights, seen), low, high))
        rewards += up * news
        way[up] = infos["way"][up]
        up &= ~ended
        if late.any():
            break
    return rewards, way, up


def search(task, act, first, rounds, length, seed, tell, noise=NOISE, rate=RATE, period=PERIOD, form="{:5.2f} m/s"):
    """Return weights, and the learning curve: actions, seconds, mean speed ahead (m/s).

    Args:
        act: a function like `actions`.
        first: the shape of the weights, which begin with zero; or the weights to begin with.
        length: actions of an episode.
        period: time of an action (s); None for a curve of the mean way itself.
        form: how a value of the curve is told.
    """
    envs = morse.gym.vector(task, ROWS, workers=WORKERS)
    rng, weights = np.random.default_rng(seed), np.zeros(first) if isinstance(first, tuple) else first
    shape = weights.shape
    drift, curve, begin = np.zeros_like(weights), [], time.perf_counter()
    for number in range(rounds):
        size = 1.0 - number / rounds / 1.5
        aside = rng.standard_normal((ROWS // 2, *shape))
        tried = weights + size * noise * np.stack([aside, -aside], axis=1).reshape(ROWS, *shape)
        rewards, way, _ = walk(envs, tried, length, 1000 * number, act)
        slope = ((rewards[0::2] - rewards[1::2])[:, None, None] * aside).mean(axis=0) / (rewards.std() + 1e-6)
        drift = MOMENTUM * drift + slope
        weights = weights + size * rate * drift
        value = float(way.mean()) / (period * length if period else 1.0)
        curve.append(((number + 1) * ROWS * length, time.perf_counter() - begin, value))
        tell(("{:8d} actions, {:4.0f} s, " + form).format(*curve[-1]))
    envs.close()
    return weights, curve


def train(rounds=ROUNDS, seed=1, tell=print):
    """Return the weights (4, 11), and the learning curve, see `search`."""
    return search(Trot, actions, (OUTPUTS, INPUTS), rounds, LENGTH, seed, tell)


def judge(weights, layouts=range(1000, 1016), seed=9):
    """Return how far (m) the robot walks in six seconds over each of these layouts of the ground, and who stays up."""
    envs = morse.gym.vector(Walk(layouts), len(layouts))
    _, way, up = walk(envs, weights, Walk.limit, seed)
    envs.close()
    return way, up


def keep(weights, path):
    """Write weights to a file."""
    rows = [json.dumps(row) for row in np.round(weights, 4).tolist()]
    path.write_text("[\n" + ",\n".join(rows) + "\n]\n", encoding="utf-8")


def view(weights, path, layout=1000):
    """Save a picture of the robot after three seconds."""
    from PIL import Image

    task = Walk([layout])
    envs = morse.gym.vector(task, 1)
    walk(envs, weights, 90, 9)
    simulation = task.many[0]
    pose = simulation.walker.pose.get()
    picture = simulation.picture(960, 600, location=[pose["x"] + 0.9, pose["y"] - 1.3, 0.7], rotation=[1.25, 0.0, 0.6])
    Image.fromarray(picture).save(path)
    envs.close()


def main(arguments=None):
    """Learn, test, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--learn", action="store_true", help="learn, and save the weights")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--weights", type=Path, default=WEIGHTS)
    parser.add_argument("--picture", type=Path, help="write the learning curve to this SVG file")
    parser.add_argument("--view", type=Path, help="write a picture of the robot to this file")
    options = parser.parse_args(arguments)
    if options.learn:
        weights, curve = train(options.rounds, options.seed)
        keep(weights, options.weights)
    weights = np.array(json.loads(options.weights.read_text(encoding="utf-8")))
    way, up = judge(weights)
    print(f"{way.mean():.2f} m in six seconds over unseen ground, at least {way.min():.2f} m; {up.mean():.0%} stay up")
    if options.learn and options.picture:
        labels = {"unit": "{:.2f}", "title": "actions; mean speed of the disturbed policies, m/s"}
        speed = float(way.mean()) / (PERIOD * Walk.limit)
        options.picture.write_text(learn_to_drive.picture(curve, speed, "unseen ground", **labels), encoding="utf-8")
    if options.view:
        view(weights, options.view)
    return way, up


if __name__ == "__main__":
    main()
