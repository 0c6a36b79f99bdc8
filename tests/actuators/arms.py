"""The arm of the tests, and its forward kinematics."""

import math

import numpy as np

SCENE = """
robot = FakeRobot()
{before}
arm = KukaLWR()
{more}
robot.append(arm)
joints = ArmaturePose()
arm.append(joints)
tip = Pose()
arm.append(tip)
"""
TARGET = "ik_target.robot.arm.kuka_7"
#: heights of the joints above the foot while the arm points upward, and that of the tip, m
HEIGHTS = (0.0, 0.3105, 0.5105, 0.7105, 0.9105, 1.1005, 1.1785)
TIP = 1.3105
#: odd joints rotate about the arm, even ones about -Y, +Y, -Y
AXES = ("z", "-y", "z", "y", "z", "-y", "z")


def turned(axis: str, angle: float) -> np.ndarray:
    """4x4 of a rotation about Z or Y."""
    if axis.startswith("-"):
        axis, angle = axis[1:], -angle
    c, s = math.cos(angle), math.sin(angle)
    rotation = [[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    result = np.eye(4)
    result[:3, :3] = rotation
    return result


def lifted(height: float) -> np.ndarray:
    """4x4 of a translation along Z."""
    result = np.eye(4)
    result[2, 3] = height
    return result


def tip_of(angles) -> np.ndarray:
    """4x4 of the tip in the frame of the arm, as the product of the links."""
    result, below = np.eye(4), 0.0
    for height, axis, angle in zip(HEIGHTS, AXES, angles, strict=True):
        result = result @ lifted(height - below) @ turned(axis, angle)
        below = height
    return result @ lifted(TIP - below)


def load(simulate, more="", before=""):
    sim = simulate(SCENE.format(more=more, before=before), sockets=False)
    sim.step(2)
    return sim


def values(sim):
    sim.step(2)
    data = sim.robot.arm.joints.get()
    return [data[f"kuka_{i}"] for i in range(1, 8)]


def place(sim):
    """The position of the tip in the world."""
    sim.step(2)
    data = sim.robot.arm.tip.get()
    return [data["x"], data["y"], data["z"]]
