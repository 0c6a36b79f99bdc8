"""People: a person fetches a cup from a table, and raises a hand."""

from morse.builder import *

person = Human()

walk = Waypoint()
walk.properties(ObstacleAvoidance=False)
person.append(walk)

pose = Pose()
person.append(pose)

person.add_interface("socket")
person.add_service("socket")  # its own services: grasp
person.add_default_interface("socket")

table = PassiveObject("props/furnitures", "IKEA_table_TORSBY")
table.translate(x=2.6, y=-0.78)

cup = PassiveObject("props/kitchen_objects", "Cup_Blue")
cup.name = "cup"
cup.setgraspable()
cup.translate(x=2.46, y=-0.45, z=0.76)

env = Environment("indoors-1/indoor-1")
env.set_camera_location([4.6, -2.6, 2.0])
env.set_camera_rotation([1.25, 0.0, 0.75])
env.set_camera_focal_length(28)
