from morse.builder import *
from ranger_sim.builder.robots import Ranger

robot = Ranger()
robot.translate(-3.0, 0.0, 0.0)

battery = Battery()
battery.properties(DischargingRate = 2.0)
robot.append(battery)

station = Zone(type = 'Charging')
station.size = [0.8, 0.8, 1.0]
station.translate(-3.0, 0.0, 0.0)

basket = PassiveObject('props/objects', 'BlueToyTrashbin')
basket.translate(3.0, 3.0, 0.0)

robot.add_default_interface('socket')

env = Environment('ranger_sim/environments/playroom', fastmode = False)
env.set_camera_location([-6.0, -6.5, 6.0])
env.set_camera_rotation([0.95, 0, -0.7])
