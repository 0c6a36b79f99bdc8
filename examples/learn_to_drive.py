"""A robot learns to drive to a goal among boxes by its laser scanner: proximal policy optimisation with numpy alone.

    python examples/learn_to_drive.py                   # about a minute on two quiet cores
    python examples/learn_to_drive.py --steps 20000 --picture curve.svg
    python examples/learn_to_drive.py --depth           # by a depth camera, which sees what is ahead

The tasks are those of `morse.gym.reach`. The robot learns in 64 arenas, and is then tested in 64 others, which it has
never seen.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from itertools import pairwise
from pathlib import Path

# small matrices: more threads only wait for each other
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import morse.gym
from morse.gym.reach import Reach, ReachDepth

ROWS, LENGTH = 64, 32  # simulations; actions of each between two updates
DISCOUNT, TRACE = 0.98, 0.95  # of rewards per action; of the generalised advantage estimation
CLIP, PASSES, PARTS = 0.2, 6, 8  # of the ratio of probabilities; passes over the data of an update, in parts
RATE, ENTROPY = 1e-3, 0.002
SECTORS = 36  # of the observation; distance, cosine and sine of the bearing of the goal, and the yaw rate follow


class Network:
    """Layers of tanh and a linear last one, trained by Adam.

    Args:
        sizes: numbers of inputs, of units of each layer, and of outputs.
        gain: size of the weights of the last layer at the start.
        extra: further parameters, trained with the weights.
    """

    def __init__(self, rng, sizes, gain, extra=()):
        self.layers = len(sizes) - 1
        self.weights = []
        for below, above in pairwise(sizes):
            self.weights += [rng.standard_normal((below, above)) / np.sqrt(below), np.zeros(above)]
        self.weights[-2] *= gain
        self.weights += extra
        self.means = [np.zeros_like(weight) for weight in self.weights]
        self.squares = [np.zeros_like(weight) for weight in self.weights]
        self.updates = 0

    def __call__(self, values):
        """(M, inputs) to (M, outputs)."""
        self.values = [values]
        for layer in range(self.layers):
            values = values @ self.weights[2 * layer] + self.weights[2 * layer + 1]
            if layer < self.layers - 1:
                values = np.tanh(values)
                self.values.append(values)
        return values

    def learn(self, slope, rate, extra=()):
        """Change the weights, given the gradient of the loss by the outputs of the last call."""
        slopes = list(extra)
        for layer in reversed(range(self.layers)):
            slopes[:0] = [self.values[layer].T @ slope, slope.sum(axis=0)]
            if layer:
                slope = slope @ self.weights[2 * layer].T * (1.0 - self.values[layer] ** 2)
        size = np.sqrt(sum(float((one**2).sum()) for one in slopes))
        self.updates += 1
        for weight, mean, square, one in zip(self.weights, self.means, self.squares, slopes, strict=True):
            one = one * min(1.0, 0.5 / (size + 1e-9))
            mean += 0.1 * (one - mean)
            square += 0.001 * (one**2 - square)
            steady = mean / (1.0 - 0.9**self.updates), square / (1.0 - 0.999**self.updates)
            weight -= rate * steady[0] / (np.sqrt(steady[1]) + 1e-8)


def mirrored(seen, actions):
    """What a robot sees and does in the mirror image of an arena: a second lesson for nothing."""
    seen, actions = seen.copy(), actions.copy()
    seen[:, :SECTORS] = seen[:, SECTORS - 1 :: -1]
    seen[:, -2:] *= -1.0
    actions[:, 1] *= -1.0
    return seen, actions


def likelihood(policy, seen, actions):
    """Return the means of the actions, their deviations in standard deviations, and the log of their densities."""
    mean, log_spread = policy(seen), policy.weights[-1]
    deviation = (actions - mean) / np.exp(log_spread)
    return mean, deviation, -(0.5 * deviation**2 + log_spread).sum(axis=1)


class Driver:
    """A policy and what it expects of each situation."""

    def __init__(self, inputs, outputs, seed):
        self.rng = np.random.default_rng(seed)
        self.policy = Network(self.rng, [inputs, 64, 64, outputs], 0.01, [np.full(outputs, -0.5)])
        self.value = Network(self.rng, [inputs, 64, 64, 1], 1.0)

    def collect(self, envs, seen, length):
        """Drive, and return what was seen, done and reached; see `learn`."""
        low, high = envs.single_action_space.low, envs.single_action_space.high
        story = {name: [] for name in ("seen", "actions", "rewards", "over", "values")}
        reached = []
        for _ in range(length):
            mean = self.policy(seen)
            actions = mean + np.exp(self.policy.weights[-1]) * self.rng.standard_normal(mean.shape)
            story["seen"].append(seen)
            story["actions"].append(actions)
            story["values"].append(self.value(seen)[:, 0])
            seen, rewards, ended, late, infos = envs.step(scaled(actions, low, high))
            over = ended | late
            if (cut := np.flatnonzero(late & ~ended)).size:
                # the episode was cut off: what would have followed counts as expected
                rewards[cut] += DISCOUNT * self.value(np.stack(list(infos["final_obs"][cut])))[:, 0]
            story["rewards"].append(rewards)
            story["over"].append(over)
            reached += infos["is_success"][over].tolist()
        story["values"].append(self.value(seen)[:, 0])
        return {name: np.stack(values) for name, values in story.items()}, seen, reached

    def learn(self, story, rate):
        """Make the actions more likely that were better than expected."""
        rewards, values, goes_on = story["rewards"], story["values"], 1.0 - story["over"]
        gains, gain = np.zeros_like(rewards), 0.0
        for number in reversed(range(len(rewards))):
            surprise = rewards[number] + DISCOUNT * goes_on[number] * values[number + 1] - values[number]
            gains[number] = gain = surprise + DISCOUNT * TRACE * goes_on[number] * gain
        seen = story["seen"].reshape(-1, story["seen"].shape[-1])
        actions = story["actions"].reshape(len(seen), -1)
        seen, actions = (np.concatenate(pair) for pair in zip((seen, actions), mirrored(seen, actions), strict=True))
        targets = np.tile((gains + values[:-1]).ravel(), 2)
        gains = np.tile((gains.ravel() - gains.mean()) / (gains.std() + 1e-8), 2)
        before = likelihood(self.policy, seen, actions)[2]
        for _ in range(PASSES):
            for rows in np.array_split(self.rng.permutation(len(seen)), PARTS):
                _, deviation, now = likelihood(self.policy, seen[rows], actions[rows])
                ratio, better = np.exp(now - before[rows]), gains[rows]
                counts = np.where(better > 0.0, ratio < 1.0 + CLIP, ratio > 1.0 - CLIP)
                push = -(counts * ratio * better)[:, None] / len(rows)
                spread = (push * (deviation**2 - 1.0)).sum(axis=0) - ENTROPY
                self.policy.learn(push * deviation / np.exp(self.policy.weights[-1]), rate, [spread])
                error = self.value(seen[rows])[:, 0] - targets[rows]
                self.value.learn(error[:, None] / len(rows), rate)


def scaled(actions, low, high):
    """Map -1 to 1, and what is beyond, to the range of the commands."""
    return (low + (np.clip(actions, -1.0, 1.0) + 1.0) * 0.5 * (high - low)).astype(np.float32)


def train(steps, seed=1, tell=print, task=Reach):
    """Return a driver, and the learning curve: actions, processor time in s, share of episodes that reach the goal."""
    envs = morse.gym.vector(task(layouts=range(64)), ROWS)
    driver = Driver(envs.single_observation_space.shape[0], envs.single_action_space.shape[0], seed)
    seen, _ = envs.reset(seed=seed)
    curve, reached, begin = [], [], time.process_time()
    for done in range(0, steps, ROWS * LENGTH):
        story, seen, news = driver.collect(envs, seen, LENGTH)
        driver.learn(story, RATE * (1.0 - done / steps))
        reached = (reached + news)[-300:]
        curve.append((done + ROWS * LENGTH, time.process_time() - begin, float(np.mean(reached or [0.0]))))
        if len(curve) % 5 == 0:
            tell("{:8d} actions, {:5.1f} s of processor time, {:4.0%} reach the goal".format(*curve[-1]))
    envs.close()
    return driver, curve


def success(driver, layouts=range(1000, 1064), episodes=4, task=Reach):
    """Return the share of episodes that reach the goal in arenas that the driver has never seen."""
    envs = morse.gym.vector(task(layouts=layouts), len(layouts))
    space, reached = envs.single_action_space, [[] for _ in layouts]
    seen, _ = envs.reset(seed=12345)
    while min(map(len, reached)) < episodes:
        seen, _, ended, late, infos = envs.step(scaled(driver.policy(seen), space.low, space.high))
        for row in np.flatnonzero(ended | late).tolist():
            reached[row].append(infos["is_success"][row])
    envs.close()
    return float(np.mean([row[:episodes] for row in reached]))


def picture(curve, result, where="new arenas", unit="{:.0%}", title="actions; episodes that reach the goal"):
    """Return the learning curve as SVG; its scale ends at 1, or at the multiple of it that the curve needs."""
    width, height, left, bottom = 640, 320, 60, 44
    most, top = curve[-1][0], math.ceil(max(result, *(value for _, _, value in curve)))

    def at(actions, value):
        x, y = left + (width - left - 20) * actions / most, height - bottom - (height - bottom - 20) * value / top
        return f"{x:.1f},{y:.1f}"

    lines = []
    for value in np.linspace(0.0, top, 5):
        x, y = at(0, value).split(",")
        lines.append(f'<line x1="{x}" y1="{y}" x2="{width - 20}" y2="{y}" stroke="#8884"/>')
        lines.append(f'<text x="{left - 8}" y="{y}" dy="4" text-anchor="end">{unit.format(value)}</text>')
    for part in range(5):
        x, y = at(most * part / 4, 0.0).split(",")
        lines.append(f'<text x="{x}" y="{y}" dy="18" text-anchor="middle">{most * part // 4000} k</text>')
    path = " ".join(at(actions, value) for actions, _, value in curve)
    x, y = at(most, result).split(",")
    # on the other side of the dot than the curve
    label, aside = f"{where}: {unit.format(result)}", -12 if result > curve[-1][2] else 24
    lines += [
        f'<polyline points="{path}" fill="none" stroke="#2a78c8" stroke-width="2"/>',
        f'<circle cx="{x}" cy="{y}" r="5" fill="#d0582a"/>',
        f'<text x="{x}" y="{y}" dx="-10" dy="{aside}" text-anchor="end" fill="#d0582a">{label}</text>',
        f'<text x="{width / 2}" y="{height - 8}" text-anchor="middle">{title}</text>',
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif"'
    return f'{head} font-size="13" fill="#808890">' + "".join(lines) + "</svg>\n"


def main(arguments=None):
    """Learn, test, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=120_000, help="number of actions")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--picture", type=Path, help="write the learning curve to this SVG file")
    parser.add_argument("--depth", action="store_true", help="drive by a depth camera instead of the scanner")
    options = parser.parse_args(arguments)
    task = ReachDepth if options.depth else Reach
    driver, curve = train(options.steps, options.seed, task=task)
    result = success(driver, task=task)
    print(f"{result:.0%} reach the goal in new arenas, after {curve[-1][1]:.0f} s of processor time")
    if options.picture:
        options.picture.write_text(picture(curve, result), encoding="utf-8")
    return result


if __name__ == "__main__":
    main()
