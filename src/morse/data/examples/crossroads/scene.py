"""Traffic: a robot waits at a crossroads until the cars have red, and crosses the road."""

from morse.builder import *

ASPHALT, PAVING, LINE, GRASS = (0.16, 0.16, 0.17), (0.55, 0.53, 0.5), (0.85, 0.85, 0.82), (0.25, 0.36, 0.18)
HOUSES = ((0.72, 0.55, 0.42), (0.78, 0.74, 0.66), (0.6, 0.64, 0.66), (0.66, 0.42, 0.36))


def slab(name, x, y, size, height, color, depth=0.2):
    """A flat box whose upper side has a height, m."""
    box = Cube(name)
    box.scale = (size[0] / 2, size[1] / 2, depth / 2)
    box.translate(x, y, height - depth / 2)
    box.set_color(*color)
    box.static()


# all lies on the ground of the world, whose upper side is at 0
slab("grass", 0, 0, (240, 240), 0.01, GRASS, 1.0)
slab("street west-east", 0, 0, (240, 7), 0.03, ASPHALT)
slab("street south-north", 0, 0, (7, 240), 0.032, ASPHALT)
for x in (-1, 1):
    for y in (-1, 1):
        slab(f"corner {x} {y}", x * 8.5, y * 8.5, (10, 10), 0.033, PAVING)
        slab(f"path {x} {y}", x * 61.5, y * 5.0, (96, 3), 0.034, PAVING)
        if (x, y) != (1, -1):  # the side from which the camera looks
            slab(f"house {x} {y}", x * 22, y * 20, (16, 14), 9.0, HOUSES[x + 1 + (y + 1) // 2], 9.0)
for stripe in range(6):
    slab(f"stripe {stripe}", 6.5, -2.75 + 1.1 * stripe, (3, 0.55), 0.036, LINE)

times = {"west_east": 0.0, "south_north": 15.0}
phases = [("green", 11), ("yellow", 2), ("red", 16), ("red-yellow", 1)]
lights = {}
for number, (street, x, y, turn) in enumerate(
    [
        ("west_east", 9.0, 4.2, 0.0),
        ("west_east", -9.0, -4.2, 3.14159),
        ("south_north", -4.2, 9.0, 1.5708),
        ("south_north", 4.2, -9.0, -1.5708),
    ]
):
    light = TrafficLight(f"light_{number}", phases=phases, offset=times[street])
    light.translate(x, y, 0.0)
    light.rotate(z=turn)
    lights[number] = light

cars = Traffic("cars", deviation=0.08, acceleration=1.4)
cars.translate(z=0.03)  # on the streets
cars.road("westward", [(110, 1.75), (-110, 1.75)], 9, speed=11.0)
cars.road("eastward", [(-110, -1.75), (110, -1.75)], 9, speed=11.0)
cars.road("southward", [(-1.75, 110), (-1.75, -110)], 6, speed=11.0)
cars.road("northward", [(1.75, -110), (1.75, 110)], 6, speed=11.0)
for road, number in (("westward", 0), ("eastward", 1), ("southward", 2), ("northward", 3)):
    cars.stop(road, 101.0, lights[number])

people = Crowd("people", 14)
people.translate(z=0.034)  # on the paths
people.start([(6, -6.3), (100, -4.2)], 7, goals=[(95, -5.2), (8, -5.2)], then="repeat")
people.start([(-100, 4.2), (-6, 6.3)], 7, goals=[(-95, 5.2), (-8, 5.2)], then="repeat")

robot = SegwayRMP400()
robot.translate(6.5, -7.5, 0.2)
robot.rotate(z=1.5708)
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
lights[0].add_service("socket")
cars.add_service("socket")

env = Environment("empty")
env.sun("2026-09-22T16:00:00+02:00", latitude=43.6, longitude=1.44)
env.set_camera_location([15.0, -16.0, 6.5])
env.set_camera_rotation([1.24, 0.0, 0.6])
