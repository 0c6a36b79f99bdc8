"""The scene of the moving picture on the front page, and of the run in the documentation."""

from morse.builder import *

robot = Morsy()
robot.translate(-1.0, -2.0, 0.0)

motion = MotionVW()
robot.append(motion)

imu = IMU()
robot.append(imu)

laser = Hokuyo()
laser.translate(z=0.6)
laser.properties(laser_range=8.0, resolution=2.0)
robot.append(laser)

camera = VideoCamera()
camera.translate(x=0.4, z=0.9)
camera.look_at(4.0, 0.0, 0.4)
camera.properties(cam_width=256, cam_height=192)
camera.frequency(10)
robot.append(camera)

env = Environment("sandbox")
env.set_camera_location([-5.2, -6.0, 3.9])
env.set_camera_rotation([1.0, 0.0, -0.8])
env.set_camera_focal_length(26)
env.show(
    rays=[laser],
    images=[camera],
    plots=["robot.imu.angular_velocity"],
    overlays=["trails"],
    follow=robot,
    layout=["plots"],
)
