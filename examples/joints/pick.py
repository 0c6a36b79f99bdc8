"""An arm picks a box by friction, sets it down at another place, and weighs it at its wrist.

python pick.py [PICTURE]
"""

import math
import sys
from pathlib import Path

import morse

#: m, kg: half the side of the box, its mass; where it stands and where it goes; from the hand to between the fingers
HALF, MASS = 0.025, 0.3
START, GOAL, GRASP = (0.42, 0.12), (0.3, -0.3), [0.0, 0.0, 0.09]
DOWN = [math.pi, 0.0, 0.0]


def scene():
    """The arm, and a box in front of it."""
    from morse.builder import Armature, ArmaturePose, Cube, Environment, ForceTorqueSensor, Robot

    picker = Robot(str(Path(__file__).with_name("picker.urdf")))
    arm = Armature(armature_name="picker_joints")
    arm.properties(RotationSpeed=1.2)
    picker.append(arm)
    arm.append(ArmaturePose("joints"))
    picker.append(ForceTorqueSensor("wrist"), "hand")
    box = Cube("box")
    box.scale = (HALF, HALF, HALF)
    box.translate(*START, HALF)
    box.set_color(0.1, 0.4, 0.9)
    box.set_rigid_body()
    box.set_mass(MASS)
    Environment("empty")


def main(picture=None):
    """Return where the box is (x, y, z, m), its height in the air (m), and its weight at the wrist (N)."""
    with morse.load(scene) as sim:
        arm, box = sim.picker.arm, sim.context.world.objects_by_name["box"]

        def hand(x, y, z):
            """Bring the middle of the fingers to a place, downward."""
            arm.reach("hand", [x, y, z], DOWN, None, GRASP).result(20.0)

        def fingers(gap):
            """Move the fingers until each is this far from the middle, or has met something."""
            arm.publish({"left": gap, "right": gap})
            sim.step(60)

        def load():
            sim.step(60)
            force = sim.picker.wrist.get()["force"]
            return math.hypot(*force)

        fingers(0.05)
        hand(*START, 0.2)
        empty = load()
        hand(*START, HALF)
        fingers(0.0)
        hand(*START, 0.2)
        full, height = load(), box.world_pose()[0][2]
        if picture:
            from PIL import Image

            Image.fromarray(sim.picture(960, 600, location=[1.0, -0.6, 0.6], rotation=[1.25, 0.0, 0.85])).save(picture)
        hand(*GOAL, 0.2)
        hand(*GOAL, HALF + 0.001)
        fingers(0.05)
        hand(*GOAL, 0.2)
        return tuple(box.world_pose()[0]), height, full - empty


if __name__ == "__main__":
    (x, y, z), lifted, weight = main(*sys.argv[1:])
    print(f"The box is at {x:.3f}, {y:.3f}, {z:.3f}; it was {lifted:.3f} m high, and weighs {weight:.2f} N.")
