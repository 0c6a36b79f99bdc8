"""An arm learns to bring its hand to a place: augmented random search with numpy alone.

    python examples/learn_to_reach.py                 # reaches with the weights of learn_to_reach.json
    python examples/learn_to_reach.py --learn         # learns them again
    python examples/learn_to_reach.py --learn --rounds 10 --weights mine.json --picture curve.svg

The arm is that of `joints/pick.py`. The search is that of `learn_to_walk`. Nothing of the policy knows the lengths of
the links: 48 weights say how three joints turn, given where the place is, seen from the hand, and how the arm stands.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import ClassVar

import learn_to_drive
import learn_to_walk
import numpy as np
from gymnasium import spaces

import morse.gym

PICKER = Path(__file__).with_name("joints") / "picker.urdf"
WEIGHTS = Path(__file__).with_suffix(".json")
ROUNDS, LENGTH = 60, 60  # of the search; actions of an episode of it
NOISE = RATE = 0.2  # of the weights
JOINTS, LIMITS = ("turn", "shoulder", "elbow"), np.array([3.1, 2.2, 2.7])  # rad
STRIDE = 0.3  # largest turn that an action asks for, rad
NEAR, TOLERANCE = (0.3, 0.6, 1.2, 0.1, 0.5), 0.02  # places: radius (m), azimuth (rad), height (m); m
FAR = 0.1  # of an error that counts as large, m


def bench():
    """The arm on the ground; a sensor says where its hand is."""
    from morse.builder import Armature, ArmaturePose, Environment, Pose, Robot

    picker = Robot(str(PICKER), name="picker")
    arm = Armature("arm", armature_name="picker_joints")
    arm.properties(RotationSpeed=2.0)
    picker.append(arm)
    arm.append(ArmaturePose("angles"))
    picker.append(Pose("hand"), "hand")
    Environment("empty")


class Reach(morse.gym.Task):
    """Bring the hand to a place before the arm, and hold it there.

    The reward of an action is the distance that remains, m, and 0.1 if it is more than 2 cm, with the opposite sign.
    The observation is (6,): the angles of the joints, rad, and the way from the hand to the place, x, y, z, m.
    """

    scene = staticmethod(bench)
    ticks, limit = learn_to_walk.Walk.ticks, LENGTH
    action = morse.gym.Command("picker.arm", **{name: (-most, most) for name, most in zip(JOINTS, LIMITS, strict=True)})
    observation = spaces.Box(-10.0, 10.0, (6,), np.float32)
    data: ClassVar = {
        "hand": morse.gym.Read("picker.hand", "x", "y", "z"),
        "angles": morse.gym.Read("picker.arm.angles", *JOINTS),
    }

    def start(self, rows, rngs):
        """Choose places."""
        if "goal" not in self.values:
            self.values["goal"] = np.zeros((len(self.many), 3))
        least, most, aside, low, high = NEAR
        for row, rng in zip(rows, rngs, strict=True):
            radius, azimuth = rng.uniform(least, most), rng.uniform(-aside, aside)
            self.values["goal"][row] = radius * np.cos(azimuth), radius * np.sin(azimuth), rng.uniform(low, high)

    def observe(self, data):
        """See the class."""
        return np.hstack([data["angles"], data["goal"] - data["hand"]]).astype(np.float32)

    def reward(self, before, now):
        """See the class; the infos have ``way``, whether the hand is within 2 cm of the place."""
        far = np.linalg.norm(now["goal"] - now["hand"], axis=1)
        return -far - 0.1 * np.tanh(far / TOLERANCE), np.zeros(len(far), bool), {"way": (far < TOLERANCE).astype(float)}


def actions(weights, seen):
    """The actions, -1 to 1, of one policy (3, 16) or of one for each row (N, 3, 16)."""
    angles, (x, y, z) = seen[:, :3], np.clip(seen[:, 3:] / FAR, -1.0, 1.0).T
    turn, lean = angles[:, 0], angles[:, 1]
    bend = lean + angles[:, 2]
    # the way in the plane of the arm, and across it
    ahead, across = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    way, posture = (
        np.stack([ahead, across, z]),
        np.stack([np.ones_like(turn), *(f(a) for a in (lean, bend) for f in (np.sin, np.cos))]),
    )
    inputs = np.concatenate([(way[:, None] * posture).reshape(15, -1), np.ones((1, len(seen)))]).T
    return (angles + STRIDE * np.clip((weights @ inputs[:, :, None])[:, :, 0], -1.0, 1.0)) / LIMITS


def train(rounds=ROUNDS, seed=1, tell=print):
    """Return the weights (3, 16), and the learning curve: actions, seconds, share that is there at the end."""
    return learn_to_walk.search(Reach, actions, (3, 16), rounds, LENGTH, seed, tell, NOISE, RATE, None, "{:4.0%}")


def judge(weights, rows=64, seed=9):
    """Return the share of new places of which the hand is within 2 cm after two seconds."""
    envs = morse.gym.vector(Reach, rows)
    _, there, _ = learn_to_walk.walk(envs, weights, Reach.limit, seed, actions)
    envs.close()
    return float(there.mean())


def main(arguments=None):
    """Learn, test, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--learn", action="store_true", help="learn, and save the weights")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--weights", type=Path, default=WEIGHTS)
    parser.add_argument("--picture", type=Path, help="write the learning curve to this SVG file")
    options = parser.parse_args(arguments)
    if options.learn:
        weights, curve = train(options.rounds, options.seed)
        learn_to_walk.keep(weights, options.weights)
    share = judge(np.array(json.loads(options.weights.read_text(encoding="utf-8"))))
    print(f"the hand is within 2 cm of {share:.0%} of the places after two seconds")
    if options.learn and options.picture:
        title = "actions; share of disturbed policies that are there"
        options.picture.write_text(learn_to_drive.picture(curve, share, "new places", title=title), encoding="utf-8")
    return share


if __name__ == "__main__":
    main()
