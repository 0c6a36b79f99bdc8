"""Legs: a robot from a URDF file stands by its motors, and walks."""

from pathlib import Path

from morse.builder import *

walker = Robot(str(Path(__file__).with_name("walker.urdf")))
walker.translate(z=0.5)

legs = Armature(armature_name="walker_joints")
legs.properties(RotationSpeed=3.0)
walker.append(legs)

joints = ArmaturePose()
joints.frequency(20)
legs.append(joints)

pose = Pose()
walker.append(pose)

walker.add_default_interface("socket")

env = Environment("indoors-1/boxes")
env.set_camera_location([1.9, -1.1, 0.7])
env.set_camera_rotation([1.3, 0.0, 0.7])
env.show(plots=["walker.pose.x"], follow=walker)
