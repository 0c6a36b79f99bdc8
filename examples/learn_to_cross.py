"""Three robots learn not to meet where their ways cross: the learner of learn_to_drive.py, one policy for all robots.

    python examples/learn_to_cross.py --picture curve.svg       # about a minute and a half of processor time

The task is `morse.gym.crossing`. Sixteen worlds of three robots are the rows of the learner.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import learn_to_drive
import numpy as np

import morse.gym
from morse.gym.crossing import AGENTS, Crossing

WORLDS, LENGTH = 16, 32  # worlds; actions of each robot between two updates


class Worlds:
    """Worlds of several robots as a vector of environments, with one row for each robot.

    The row of a robot whose episode has ended rests, without reward, until its world begins anew.
    """

    def __init__(self, count):
        self.worlds = [morse.gym.parallel(Crossing, AGENTS) for _ in range(count)]
        self.single_observation_space = self.worlds[0].observation_space(AGENTS[0])
        self.single_action_space = self.worlds[0].action_space(AGENTS[0])
        self.seen = np.zeros((count, len(AGENTS), *self.single_observation_space.shape), np.float32)

    def note(self, world, observations):
        for agent, seen in observations.items():
            self.seen[world, AGENTS.index(agent)] = seen

    def reset(self, seed):
        """Begin the episodes of all worlds."""
        for number, world in enumerate(self.worlds):
            self.note(number, world.reset(seed=seed + number)[0])
        return self.seen.reshape(-1, self.seen.shape[-1]).copy(), {}

    def step(self, actions):
        """As a vector of environments; ``infos`` have ``is_success``, and ``ends`` for the episodes that end now."""
        actions = actions.reshape(len(self.worlds), len(AGENTS), -1)
        shape = len(self.worlds), len(AGENTS)
        rewards, over, reached = np.zeros(shape), np.ones(shape, bool), np.zeros(shape, bool)
        ends = np.zeros(shape, bool)
        for number, world in enumerate(self.worlds):
            seen, gains, ended, late, infos = world.step({a: actions[number, AGENTS.index(a)] for a in world.agents})
            self.note(number, seen)
            for agent, gain in gains.items():
                row = number, AGENTS.index(agent)
                rewards[row], over[row] = gain, ended[agent] or late[agent]
                ends[row], reached[row] = over[row], infos[agent]["is_success"]
            if not world.agents:
                self.note(number, world.reset()[0])
        infos = {"is_success": reached.ravel(), "ends": ends.ravel()}
        late = np.zeros(over.size, bool)
        return self.seen.reshape(over.size, -1).copy(), rewards.ravel(), over.ravel(), late, infos

    def close(self):
        """End the simulations."""
        for world in self.worlds:
            world.close()


class Team(learn_to_drive.Driver):
    """One policy for all robots."""

    def collect(self, envs, seen, length):
        """As for one robot; only episodes that end in a step count."""
        outcomes, step = [], envs.step

        def noted(actions):
            result = step(actions)
            outcomes.extend(result[4]["is_success"][result[4]["ends"]].tolist())
            return result

        envs.step = noted
        story, seen, _ = super().collect(envs, seen, length)
        envs.step = step
        return story, seen, outcomes


def train(steps, seed=1, tell=print, worlds=WORLDS):
    """Return a policy, and the learning curve: actions, processor time in s, share of robots that reach their goals."""
    envs = Worlds(worlds)
    team = Team(envs.single_observation_space.shape[0], envs.single_action_space.shape[0], seed)
    seen, _ = envs.reset(seed=seed)
    curve, reached, begin, rows = [], [], time.process_time(), worlds * len(AGENTS)
    for done in range(0, steps, rows * LENGTH):
        story, seen, news = team.collect(envs, seen, LENGTH)
        team.learn(story, learn_to_drive.RATE * (1.0 - done / steps))
        reached = (reached + news)[-300:]
        curve.append((done + rows * LENGTH, time.process_time() - begin, float(np.mean(reached or [0.0]))))
        if len(curve) % 5 == 0:
            tell("{:8d} actions, {:5.1f} s of processor time, {:4.0%} reach the goal".format(*curve[-1]))
    envs.close()
    return team, curve


def success(team, episodes=4, worlds=WORLDS):
    """Return the share of robots that reach their goals, from starts that the policy has never seen."""
    envs, reached = Worlds(worlds), []
    low, high = envs.single_action_space.low, envs.single_action_space.high
    seen, _ = envs.reset(seed=12345)
    while len(reached) < episodes * worlds * len(AGENTS):
        seen, _, _, _, infos = envs.step(learn_to_drive.scaled(team.policy(seen), low, high))
        reached += infos["is_success"][infos["ends"]].tolist()
    envs.close()
    return float(np.mean(reached))


def main(arguments=None):
    """Learn, test, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=120_000, help="number of actions of all robots")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--picture", type=Path, help="write the learning curve to this SVG file")
    options = parser.parse_args(arguments)
    team, curve = train(options.steps, options.seed)
    result = success(team)
    print(f"{result:.0%} reach the goal from new starts, after {curve[-1][1]:.0f} s of processor time")
    if options.picture:
        picture = learn_to_drive.picture(curve, result).replace("new arenas", "new starts")
        options.picture.write_text(picture, encoding="utf-8")
    return result


if __name__ == "__main__":
    main()
