"""Search and rescue: a robot searches for victims, drives to them, and heals them."""

from morse.builder import *

robot = ATRV()
robot.translate(z=0.15)  # the meadow is uneven

goal = Waypoint()
goal.properties(ObstacleAvoidance=False)
robot.append(goal)

finder = SearchAndRescue()
finder.translate(x=0.3, z=0.6)
finder.properties(Abilities="1,2,3", Heal_range=3.0, Angle=120.0, Distance=12.0)
robot.append(finder)

robot.add_default_interface("socket")

for number, (x, y) in enumerate(((5.0, 2.0), (9.0, -1.5))):
    victim = Victim("victim%d" % (number + 1))
    victim.translate(x, y, 0.0)

env = Environment("land-1/trees")
env.set_camera_location([-3.0, -5.0, 5.0])
env.set_camera_rotation([1.05, 0.0, -0.8])
env.set_camera_focal_length(34)
env.show(select=finder, overlays=["cones", "trails"], follow=robot)
