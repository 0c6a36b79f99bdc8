"""A humanoid stands, is pushed from four sides, and stands again: with its ankles and hips, without a step.

python stand.py [PICTURE]

What balances is the capture point of the linear inverted pendulum, x + v / sqrt(g / h): a body whose capture point
stays above the feet need not step (Pratt et al., "Capture point: a step toward humanoid push recovery", Humanoids
2006). The ankles move the pressure under the feet beyond it; the hips keep the trunk upright.
"""

import math
import sys
from pathlib import Path

import morse

RATE, PAUSE = 60, 4  # Hz, s between two pushes
LENGTH = 0.15  # of a push, s
#: the pushes: N along X (ahead) and Y (left)
PUSHES = ((100.0, 0.0), (-70.0, 0.0), (0.0, 110.0), (0.0, -110.0))
BEND = 0.3  # of the knees, rad
HEIGHT = 0.85  # of the centre of mass, m
OMEGA = math.sqrt(9.81 / HEIGHT)  # of the inverted pendulum, 1/s
ANKLE, EDGE, SOLE, HIP, DAMPING = 1.3, 0.3, 0.6, 0.3, 0.05  # rad/m, rad, rad/m, 1, s


def scene():
    """The humanoid on the ground."""
    from morse.builder import IMU, Armature, Environment, ExternalForce, Pose, Robot, Velocity

    humanoid = Robot(str(Path(__file__).with_name("humanoid.xml")), keyframe="home")
    joints = Armature(armature_name="humanoid_joints")
    joints.properties(RotationSpeed=20.0)
    humanoid.append(joints)
    humanoid.append(Pose("pose"))
    humanoid.append(Velocity("velocity"))
    humanoid.append(IMU("imu"))
    humanoid.append(ExternalForce("push"))
    Environment("empty")


def command(pose, velocity, rates):
    """The angles of all joints.

    Args:
        pose: of the trunk; ``x`` and ``y`` are those from its place, m.
        velocity: ahead and to the left, m/s.
        rates: of roll and pitch, rad/s.
    """
    ahead, aside = pose["x"] + velocity[0] / OMEGA, pose["y"] + velocity[1] / OMEGA
    pitch = HIP * pose["pitch"] + DAMPING * rates[1]
    roll = HIP * pose["roll"] + DAMPING * rates[0]
    setpoints = {}
    for side in ("left", "right"):
        setpoints |= {
            f"{side}_aside": roll,
            f"{side}_swing": -0.5 * BEND + pitch,
            f"{side}_knee": BEND,
            f"{side}_ankle": -0.5 * BEND + min(max(ANKLE * ahead, -EDGE), EDGE),
            f"{side}_sole": -SOLE * aside,
            f"{side}_shoulder": 0.2,
            f"{side}_elbow": -0.3,
        }
    return setpoints


def main(picture=None, pushes=PUSHES):
    """Return for each push the largest way of the trunk (m), and how far it is from its place 4 s later (m, rad)."""
    with morse.load(scene) as sim:
        robot, results, start = sim.humanoid, [], None
        for force in ((0.0, 0.0), *pushes):
            farthest = 0.0
            for tick in range(PAUSE * RATE):
                pose = robot.pose.data
                if start is None or (not any(force) and tick == PAUSE * RATE - 1):
                    start = dict(pose)
                here = {**pose, "x": pose["x"] - start["x"], "y": pose["y"] - start["y"]}
                velocity = robot.velocity.data["world_linear_velocity"]
                robot.joints.publish(command(here, velocity, robot.imu.data["angular_velocity"]))
                pushed = force if tick < LENGTH * RATE else (0.0, 0.0)
                robot.push.publish({"force": [*pushed, 0.0]})
                sim.step(1, measure=True)
                farthest = max(farthest, math.hypot(here["x"], here["y"]))
                if picture and force == pushes[0] and tick == LENGTH * RATE:
                    from PIL import Image

                    view = {"location": [1.6, -2.2, 1.2], "rotation": [1.4, 0.0, 0.63]}
                    Image.fromarray(sim.picture(960, 600, **view)).save(picture)
            left = math.hypot(here["x"], here["y"])
            results.append((farthest, left, max(abs(pose["roll"]), abs(pose["pitch"])), pose["z"]))
        return results


if __name__ == "__main__":
    for force, (farthest, left, tilt, height) in zip(((0.0, 0.0), *PUSHES), main(*sys.argv[1:]), strict=True):
        print(f"{force}: {farthest:.3f} m away; 4 s later {left:.3f} m, {tilt:.3f} rad, {height:.3f} m high")
