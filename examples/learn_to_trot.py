"""The ant of Gymnasium learns to trot from nothing: augmented random search with numpy alone.

    python examples/learn_to_trot.py                  # trots with the weights of learn_to_trot.json
    python examples/learn_to_trot.py --learn          # learns them again, in 40 s of processor time
    python examples/learn_to_trot.py --learn --rounds 10 --weights mine.json --picture curve.svg
    python examples/learn_to_trot.py --film trot.webp # a film of the robot

The robot is the MJCF file of the package ``gymnasium``. The search is that of `learn_to_walk`. The actions are
setpoints of the joints. The legs of a diagonal have the same clock, those of the other diagonal the opposite one, and
left and right are exchanged: any gait with these weights is a trot, and how the legs move in it is found by the search.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import ClassVar

import gymnasium
import learn_to_drive
import learn_to_walk
import numpy as np
from gymnasium import spaces

import morse.gym

ANT = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / "ant.xml"
WEIGHTS = Path(__file__).with_suffix(".json")
ROUNDS, LENGTH = 30, 120  # of the search; actions of an episode of it
NOISE = RATE = 0.15  # of the weights
PACE = 2.0  # steps of each leg in a second
HEIGHT, TILT, LOW = 0.6, 1.0, 0.2  # at the start, m; of a fall, rad and m
OUTPUTS, INPUTS = 4, 11  # hips and ankles of the front and the rear leg of a diagonal; see `learn_to_walk.features`
SCALE = np.array([1.0, 1.0, 0.3, 0.3, 0.5, 3.0, 3.0, 3.0])
# the legs in the order front left, front right, rear left, rear right
HIPS, ANKLES = ("hip_1", "hip_4", "hip_2", "hip_3"), ("ankle_1", "ankle_4", "ankle_2", "ankle_3")
SWING, BENT, STRAIGHT = math.radians(30.0), math.radians(70.0), math.radians(30.0)


def meadow():
    """The ant on flat ground, with motors that hold its joints at their setpoints."""
    from morse.builder import Armature, Environment, Pose, Robot

    ant = Robot(str(ANT), name="ant")
    legs = Armature("legs", armature_name="ant_joints")
    legs.control("position")
    legs.gains(600.0, 40.0)
    legs.properties(RotationSpeed=20.0)
    ant.append(legs)
    ant.append(Pose("pose"))
    Environment("empty")


class Trot(morse.gym.Task):
    """Go ahead, along X; a fall ends the episode.

    The reward is the way ahead less half of the way aside, m, and -2 for a fall. The observation is (8,): sine and
    cosine of the phase of a clock; roll, pitch and yaw, rad; their rates, rad/s.
    """

    scene = staticmethod(meadow)
    ticks, limit = learn_to_walk.Walk.ticks, 180
    action = morse.gym.Command(
        "ant.legs",
        **dict.fromkeys(HIPS, (-SWING, SWING)),
        **dict.fromkeys(ANKLES[:2], (STRAIGHT, BENT)),
        **dict.fromkeys(ANKLES[2:], (-BENT, -STRAIGHT)),
    )
    observation = spaces.Box(-10.0, 10.0, (8,), np.float32)
    data: ClassVar = {"pose": morse.gym.Read("ant.pose", "x", "y", "z", "roll", "pitch", "yaw")}

    def start(self, rows, rngs):
        """Stand with a random yaw, and a little tilt."""
        if "phase" not in self.values:
            self.values |= {"phase": np.zeros(len(self.many)), "rates": np.zeros((len(self.many), 3))}
        self.values["phase"][rows] = self.values["rates"][rows] = 0.0
        tilts = [rng.uniform(-1.0, 1.0, 3) * (0.05, 0.05, 0.2) for rng in rngs]
        self.many.place(rows, "ant", [[0.0, 0.0, HEIGHT, *tilt] for tilt in tilts])

    def observe(self, data):
        """See the class."""
        phase, rates = self.values["phase"], np.clip(self.values["rates"], -10.0, 10.0)
        return np.column_stack([np.sin(phase), np.cos(phase), data["pose"][:, 3:], rates]).astype(np.float32)

    def reward(self, before, now):
        """See the class; the infos have ``way``, how far ahead the robot is, m."""
        step = now["pose"] - before["pose"]
        turned = (step[:, 3:] + math.pi) % (2.0 * math.pi) - math.pi
        self.values["rates"][:] = turned / learn_to_walk.PERIOD
        self.values["phase"] += 2.0 * math.pi * PACE * learn_to_walk.PERIOD
        fallen = (np.abs(now["pose"][:, 3:5]).max(axis=1) > TILT) | (now["pose"][:, 2] < LOW)
        return step[:, 0] - 0.5 * np.abs(step[:, 1]) - 2.0 * fallen, fallen, {"way": now["pose"][:, 0]}


def actions(weights, seen):
    """The actions, -1 to 1, of one policy (4, 11) or of one for each row (N, 4, 11)."""
    chosen = np.empty((len(seen), 2 * OUTPUTS))
    for side, sight in enumerate((seen, seen * learn_to_walk.MIRROR)):
        hips_and_ankles = (weights @ learn_to_walk.features(sight, SCALE)[:, :, None])[:, :, 0]
        # the hips of the right side, and the ankles of the rear legs, turn the other way
        left = 1.0 - 2.0 * side
        chosen[:, [side, 3 - side, 4 + side, 7 - side]] = hips_and_ankles * (left, -left, 1.0, -1.0)
    return chosen


def train(rounds=ROUNDS, seed=1, tell=print):
    """Return the weights (4, 11), and the learning curve, see `learn_to_walk.search`."""
    return learn_to_walk.search(Trot, actions, (OUTPUTS, INPUTS), rounds, LENGTH, seed, tell, NOISE, RATE)


def judge(weights, rows=16, seed=9):
    """Return how far (m) the robot trots in six seconds from poses that are new to it, and who stays up."""
    envs = morse.gym.vector(Trot, rows)
    _, way, up = learn_to_walk.walk(envs, weights, Trot.limit, seed, actions)
    envs.close()
    return way, up


def film(weights, path, begin=60, frames=60):
    """Save a film of two seconds, from the side, at half the speed."""
    from PIL import Image

    task, pictures = Trot(), []
    envs = morse.gym.vector(task, 1)
    low, high = envs.single_action_space.low, envs.single_action_space.high
    seen, _ = envs.reset(seed=9)
    for number in range(begin + frames):
        seen, *_ = envs.step(learn_to_drive.scaled(actions(weights, seen), low, high))
        if number >= begin and number % 2 == 0:
            x = task.many[0].ant.pose.get()["x"]
            pictures.append(task.many[0].picture(600, 375, location=[x + 1.2, -2.6, 1.4], rotation=[1.15, 0.0, 0.42]))
    envs.close()
    first, *others = [Image.fromarray(one) for one in pictures]
    first.save(path, save_all=True, append_images=others, duration=133, loop=0, quality=45, method=6)


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
    way, up = judge(weights)
    print(f"{way.mean():.2f} m in six seconds, at least {way.min():.2f} m; {up.mean():.0%} stay up")
    if options.learn and options.picture:
        labels = {"unit": "{:.2f}", "title": "actions; mean speed of the disturbed policies, m/s"}
        speed = float(way.mean()) / (learn_to_walk.PERIOD * Trot.limit)
        options.picture.write_text(learn_to_drive.picture(curve, speed, "from other poses", **labels), encoding="utf-8")
    if options.film:
        film(weights, options.film)
    return way, up


if __name__ == "__main__":
    main()
