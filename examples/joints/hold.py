"""A hand with three fingers grasps a ball, lifts it, and holds it by friction.

python hold.py [PICTURE]
"""

import sys
from pathlib import Path

import morse

#: m, kg
RADIUS, MASS = 0.035, 0.1
FINGERS = ("front", "left", "right")
SECONDS = 5


def scene():
    """The hand above a ball."""
    from morse.builder import Armature, ContactForce, Environment, Robot, Sphere

    hand = Robot(str(Path(__file__).with_name("hand.xml")))
    joints = Armature(armature_name="hand_joints")
    joints.properties(RotationSpeed=1.5, LinearSpeed=0.15)
    hand.append(joints)
    for finger in FINGERS:
        hand.append(ContactForce(finger), f"{finger}_upper")
    ball = Sphere("ball")
    ball.scale = (RADIUS, RADIUS, RADIUS)
    ball.translate(z=RADIUS)
    ball.set_color(0.1, 0.4, 0.9)
    ball.set_rigid_body()
    ball.set_mass(MASS)
    Environment("empty")


def main(picture=None):
    """Return how far the ball was lifted and has slipped in five seconds (m), and what the fingers carry (N)."""
    with morse.load(scene) as sim:
        joints, ball = sim.hand.joints, sim.context.world.objects_by_name["ball"]

        def close(base, tip, lift):
            """Move the fingers and the slide."""
            angles = {f"{finger}_base": base for finger in FINGERS} | {f"{finger}_tip": tip for finger in FINGERS}
            joints.publish({**angles, "lift": lift})
            sim.step(90)

        def height():
            return ball.world_pose()[0][2]

        close(-0.3, 0.0, 0.0)
        close(-0.3, 0.0, -0.04)
        before = height()
        # the springs of the motors press where the fingers cannot go
        close(0.35, 0.2, -0.04)
        close(0.35, 0.2, 0.2)
        sim.step(90)
        lifted = height()
        sim.step(SECONDS * 60)
        if picture:
            from PIL import Image

            Image.fromarray(sim.picture(960, 600, location=[0.35, -0.35, 0.5], rotation=[1.3, 0.0, 0.78])).save(picture)
        load = sum(getattr(sim.hand, finger).get()["force"][2] for finger in FINGERS)
        return lifted - before, lifted - height(), load


if __name__ == "__main__":
    lifted, slip, load = main(*sys.argv[1:])
    print(f"Lifted by {lifted:.3f} m, slipped by {slip:.5f} m in 5 s; the fingers carry {load:.2f} N.")
