"""Batteries and zones: a robot patrols, and returns to the charging station in time."""

from morse.builder import *

robot = Morsy()

goal = Waypoint()
goal.properties(ObstacleAvoidance=False)
robot.append(goal)

battery = Battery()
battery.properties(DischargingRate=6.0)  # a high rate for the example: % per second
robot.append(battery)

robot.add_default_interface("socket")

station = Zone(type="Charging")
station.size = [1.0, 1.0, 1.0]
station.translate(-4.0, 0.0, 0.0)

mat = Cube("mat")
mat.location = (-4.0, 0.0, 0.005)
mat.scale = (1.0, 1.0, 0.005)
mat.set_color(0.1, 0.6, 0.2)

env = Environment("indoors-1/boxes")
env.set_camera_location([4.0, -6.0, 4.2])
env.set_camera_rotation([1.12, 0.0, 0.7])
env.set_camera_focal_length(26)
env.show(plots=["robot.battery.charge"], overlays=["trails"])
