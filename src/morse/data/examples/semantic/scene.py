"""Semantic cameras: a robot looks around in a room, and lists the visible objects by name."""

from morse.builder import *

robot = Morsy()

motion = MotionVW()
robot.append(motion)

camera = SemanticCamera()
camera.translate(x=0.3, z=1.0)
camera.properties(cam_far=12.0)
robot.append(camera)

robot.add_default_interface("socket")

for number, (name, kind) in enumerate((("Jam", "Food"), ("Milk", "Food"), ("Knife", "Cutlery"))):
    table = PassiveObject("props/objects", "SmallTable")
    table.name = "Table%d" % (number + 1)
    table.location = (2.2 * (1 - number), 2.2 * (number % 2 * 2 - 1) + (2.2 if number == 0 else 0.0), 0.0)
    thing = PassiveObject("props/kitchen_objects", name)
    thing.setgraspable()
    thing.properties(Object=True, Type=kind, Description="on table %d" % (number + 1))
    thing.location = (table.location[0], table.location[1], 0.8)

env = Environment("laas/grande_salle")
env.set_camera_location([-4.0, -4.0, 3.5])
env.set_camera_rotation([1.1, 0.0, -0.8])
env.show(images=[camera], select=camera)
