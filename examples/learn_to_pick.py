"""An arm learns to pick up a box: augmented random search with numpy alone.

    python examples/learn_to_pick.py                 # picks with the weights of learn_to_pick.json
    python examples/learn_to_pick.py --learn         # learns them again
    python examples/learn_to_pick.py --learn --rounds 10 --weights mine.json --picture curve.svg
    python examples/learn_to_pick.py --film pick.webp

The arm is that of `joints/pick.py`, the search that of `learn_to_walk`. As in `learn_to_reach`, nothing of the policy
knows the lengths of the links. 48 weights say how three joints turn, and begin with those that `learn_to_reach` has
found; four say how high the hand comes, how near the fingers close, and how fast it lifts, and begin with zero. What is
given: the hand points down.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import ClassVar

import learn_to_drive
import learn_to_reach
import learn_to_walk
import numpy as np
from gymnasium import spaces

import morse.gym

WEIGHTS = Path(__file__).with_suffix(".json")
ROUNDS, LENGTH = 40, 100  # of the search; actions of an episode of it
NOISE = RATE = 0.1  # of the weights
HALF = 0.025  # the side of the box, m
PLACES = (0.38, 0.5, 0.6)  # of the box: radius, m; azimuth, rad
FINGERS, OPEN = ("left", "right"), 0.05  # m
GRASP = 0.095  # from the hand to the middle between the fingers, m
UP, LIFTED = 0.2, 0.12  # where the box is brought, and what counts as picked: height, m
ARM = (*learn_to_reach.JOINTS, "pitch")


def bench():
    """The arm, and a box before it."""
    from morse.builder import Armature, ArmaturePose, Environment, Pose, Robot

    picker = Robot(str(learn_to_reach.PICKER), name="picker")
    arm = Armature("arm", armature_name="picker_joints")
    arm.properties(RotationSpeed=2.0, LinearSpeed=0.2)
    picker.append(arm)
    arm.append(ArmaturePose("angles"))
    picker.append(Pose("hand"), "hand")
    box = Robot(str(learn_to_reach.PICKER.with_name("box.urdf")), name="box")
    box.translate(PLACES[0], 0.0, HALF)
    box.append(Pose("pose"))
    Environment("empty")


class Pick(morse.gym.Task):
    """Pick up the box, and hold it.

    The reward of an action is that of `learn_to_reach` for the way from between the fingers to the box, and three times
    the height of the box above the ground, m. The observation is (8,): the angles of turn, shoulder and elbow, rad; the
    way to the box, x, y, z, m; how far a finger is from the middle, m; the height of the box above the ground, m.
    """

    scene = staticmethod(bench)
    ticks, limit = learn_to_walk.Walk.ticks, LENGTH
    action = morse.gym.Command("picker.arm", turn=(-3.1, 3.1), shoulder=(-2.2, 2.2), elbow=(-2.7, 2.7),
                               pitch=(-2.2, 2.2), left=(0.0, OPEN), right=(0.0, OPEN))  # fmt: skip
    observation = spaces.Box(-10.0, 10.0, (8,), np.float32)
    data: ClassVar = {
        "hand": morse.gym.Read("picker.hand", "x", "y", "z"),
        "box": morse.gym.Read("box.pose", "x", "y", "z"),
        "angles": morse.gym.Read("picker.arm.angles", *learn_to_reach.JOINTS, "left"),
    }

    def start(self, rows, rngs):
        """Put the box at a place."""
        poses = []
        for rng in rngs:
            radius, azimuth = rng.uniform(*PLACES[:2]), rng.uniform(-PLACES[2], PLACES[2])
            poses.append([radius * math.cos(azimuth), radius * math.sin(azimuth), HALF, 0.0, 0.0, azimuth])
        self.many.place(rows, "box", poses)

    def observe(self, data):
        """See the class."""
        way = data["box"] - data["hand"] + (0.0, 0.0, GRASP)
        angles, height = data["angles"], data["box"][:, 2:] - HALF
        return np.hstack([angles[:, :3], way, angles[:, 3:], height]).astype(np.float32)

    def reward(self, before, now):
        """See the class; the infos have ``way``, whether the box is picked."""
        far = np.linalg.norm(now["box"] - now["hand"] + (0.0, 0.0, GRASP), axis=1)
        height = np.clip(now["box"][:, 2] - HALF, 0.0, UP)
        held = height > LIFTED
        return 3.0 * height - far - 0.1 * np.tanh(far / 0.02), np.zeros(len(far), bool), {"way": held.astype(float)}


def actions(weights, seen):
    """The actions, -1 to 1, of one policy (1, 52) or of one for each row (N, 1, 52)."""
    weights = np.broadcast_to(weights, (len(seen), 1, 52))[:, 0]
    arm, (above, near, width, lift) = weights[:, :48].reshape(-1, 3, 16), 4.0 * weights[:, 48:].T
    way, gap, height = seen[:, 3:6].copy(), seen[:, 6], seen[:, 7]
    aside, far = np.hypot(way[:, 0], way[:, 1]), np.linalg.norm(way, axis=1)
    closes = (near - width * far / 0.02 > 0.0) | (height > 0.01)
    holds = closes & (gap < 1.3 * HALF)
    way[:, 2] += np.where(holds, np.clip(lift, 0.0, 1.0) * (UP - height), 0.1 * above * np.clip(aside / 0.05, 0.0, 1.0))
    goals = learn_to_reach.actions(arm, np.hstack([seen[:, :3], way])) * learn_to_reach.LIMITS
    pitch = math.pi - goals[:, 1] - goals[:, 2]
    fingers = np.where(closes, -1.0, 1.0)
    return np.column_stack([goals / learn_to_reach.LIMITS, pitch / 2.2, fingers, fingers])


def train(rounds=ROUNDS, seed=1, tell=print):
    """Return the weights (1, 52), and the learning curve: actions, seconds, share of boxes in the air at the end."""
    first = np.zeros((1, 52))
    first[0, :48] = np.array(json.loads(learn_to_reach.WEIGHTS.read_text(encoding="utf-8"))).ravel()
    return learn_to_walk.search(Pick, actions, first, rounds, LENGTH, seed, tell, NOISE, RATE, None, "{:4.0%}")


def judge(weights, rows=64, seed=9):
    """Return the share of boxes at new places that are in the air after three seconds."""
    envs = morse.gym.vector(Pick, rows)
    _, held, _ = learn_to_walk.walk(envs, weights, Pick.limit, seed, actions)
    envs.close()
    return float(held.mean())


def film(weights, path):
    """Save a film of three seconds."""
    from PIL import Image

    task, pictures = Pick(), []
    envs = morse.gym.vector(task, 1)
    low, high = envs.single_action_space.low, envs.single_action_space.high
    seen, _ = envs.reset(seed=9)
    for number in range(LENGTH - 1):
        seen, *_ = envs.step(learn_to_drive.scaled(actions(weights, seen), low, high))
        if number % 3 == 0:
            view = {"location": [1.1, -0.8, 0.7], "rotation": [1.2, 0.0, 0.8]}
            pictures.append(task.many[0].picture(600, 400, **view))
    envs.close()
    first, *others = [Image.fromarray(one) for one in pictures]
    first.save(path, save_all=True, append_images=others, duration=100, loop=0, quality=35, method=6)


def main(arguments=None):
    """Learn, test, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--learn", action="store_true", help="learn, and save the weights")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--weights", type=Path, default=WEIGHTS)
    parser.add_argument("--picture", type=Path, help="write the learning curve to this SVG file")
    parser.add_argument("--film", type=Path, help="write a film of the robot to this file")
    options = parser.parse_args(arguments)
    if options.learn:
        weights, curve = train(options.rounds, options.seed)
        learn_to_walk.keep(weights, options.weights)
    weights = np.array(json.loads(options.weights.read_text(encoding="utf-8")))
    share = judge(weights)
    print(f"{share:.0%} of the boxes are in the air after three seconds")
    if options.learn and options.picture:
        title = "actions; share of disturbed policies that hold the box"
        options.picture.write_text(learn_to_drive.picture(curve, share, "new places", title=title), encoding="utf-8")
    if options.film:
        film(weights, options.film)
    return share


if __name__ == "__main__":
    main()
