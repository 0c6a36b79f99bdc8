"""A dog trots by four coupled oscillators: 10 s, without a look at the world.

python trot.py [PICTURE]

The oscillators are those of Righetti and Ijspeert, "Pattern generators with sensory feedback for the control of
quadruped locomotion" (ICRA 2008), without the feedback: of each, x moves the foot ahead and back, and y > 0 is the time
in the air.
"""

import math
import sys
from pathlib import Path

import morse

LEGS = ("front_left", "front_right", "rear_left", "rear_right")
#: the coupling of a trot: diagonal legs together
COUPLING = ((0, -1, -1, 1), (-1, 0, 1, -1), (-1, 1, 0, -1), (1, -1, -1, 0))
#: angular frequencies of stance and swing, rad/s; gains; steepness of the change between the two
STANCE, SWING, GAIN, STEEP = 18.0, 18.0, 20.0, 20.0
#: m: half the step, lift of a foot, height of the hips, length of thigh and shin
REACH, LIFT, HEIGHT, LINK = 0.045, 0.045, 0.28, 0.2
RATE, SECONDS = 60, 10


def scene():
    """The dog on the ground, with sensors on its feet."""
    from morse.builder import Armature, ContactForce, Environment, Pose, Robot

    dog = Robot(str(Path(__file__).with_name("dog.xml")), keyframe="home")
    joints = Armature(armature_name="dog_joints")
    joints.properties(RotationSpeed=20.0)
    dog.append(joints)
    dog.append(Pose("pose"))
    for leg in LEGS:
        dog.append(ContactForce(leg), f"{leg}_shin")
    Environment("empty")


def step(state, seconds):
    """The oscillators after some time: x and y of each."""
    small = 1e-3
    for _ in range(round(seconds / small)):
        pull = [sum(k * y for k, (_, y) in zip(row, state, strict=True)) for row in COUPLING]
        rates = []
        for (x, y), other in zip(state, pull, strict=True):
            omega = STANCE / (math.exp(STEEP * y) + 1.0) + SWING / (math.exp(-STEEP * y) + 1.0)
            rest = GAIN * (1.0 - x * x - y * y)
            rates.append((rest * x - omega * y, rest * y + omega * x + other))
        state = [(x + small * dx, y + small * dy) for (x, y), (dx, dy) in zip(state, rates, strict=True)]
    return state


def angles(ahead, height):
    """Hip and knee that bring a foot this far ahead of the hip and below it."""
    reach = math.hypot(ahead, height)
    bend = math.acos(min(reach / (2.0 * LINK), 1.0))
    return math.atan2(-ahead, height) + bend, -2.0 * bend


def command(state, strength):
    """The angles of all joints."""
    setpoints = {}
    for leg, (x, y) in zip(LEGS, state, strict=True):
        swing, knee = angles(-strength * REACH * x, HEIGHT - strength * LIFT * max(y, 0.0))
        setpoints |= {f"{leg}_aside": 0.0, f"{leg}_swing": swing, f"{leg}_knee": knee}
    return setpoints


def main(picture=None):
    """Return the way (m), the smallest height of the trunk (m) and its largest tilt (rad), and the feet's force (N)."""
    with morse.load(scene) as sim:
        state = [(1.0, 0.1), (-1.0, 0.1), (-1.0, 0.0), (1.0, 0.0)]
        sim.dog.joints.publish(command(state, 0.0))
        sim.step(2 * RATE)
        weight = sum(getattr(sim.dog, leg).get()["force"][2] for leg in LEGS)
        start, heights, tilts = sim.dog.pose.get(), [], []
        for tick in range(SECONDS * RATE):
            state = step(state, 1.0 / RATE)
            sim.dog.joints.publish(command(state, min(tick / RATE, 1.0)))
            sim.step()
            pose = sim.dog.pose.get()
            heights.append(pose["z"])
            tilts.append(max(abs(pose["roll"]), abs(pose["pitch"])))
            if picture and tick == 5 * RATE:
                from PIL import Image

                view = {"location": [pose["x"] + 0.6, pose["y"] - 0.85, 0.5], "rotation": [1.3, 0.0, 0.6]}
                Image.fromarray(sim.picture(960, 600, **view)).save(picture)
        way = math.hypot(pose["x"] - start["x"], pose["y"] - start["y"])
        return way, min(heights), max(tilts), weight


if __name__ == "__main__":
    way, lowest, tilt, weight = main(*sys.argv[1:])
    print(f"Trotted {way:.2f} m; lowest {lowest:.3f} m, tilt {tilt:.2f} rad; the feet carry {weight:.2f} N.")
