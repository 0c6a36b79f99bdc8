"""Pan-tilt units: a camera head follows another robot."""

from morse.builder import *

robot = ATRV()

ptu = PTU()
ptu.translate(x=0.22, z=0.72)  # on the mast
robot.append(ptu)

camera = VideoCamera()
camera.properties(cam_width=128, cam_height=96, capturing=False)
ptu.append(camera)

robot.add_default_interface("socket")

other = Morsy()
other.translate(3.0, 3.0, 0.0)

motion = MotionVW()
other.append(motion)

pose = Pose()
other.append(pose)

other.add_default_interface("socket")

env = Environment("indoors-1/indoor-1")
env.set_camera_location([-4.0, -3.0, 3.5])
env.set_camera_rotation([1.2, 0.0, -0.9])
env.set_camera_focal_length(34)
env.show(overlays=["frustums", "trails"])
