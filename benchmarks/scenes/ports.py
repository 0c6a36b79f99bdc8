"""A robot with a pose, an actuator that every middleware can command, and joints; arguments: ``with=yarp``."""

import sys

from morse.builder import *

NAMES = dict(word.split("=") for word in sys.argv[1:] if "=" in word)
MIDDLEWARE = NAMES["with"]

robot = Robot(name="robot")
pose = Pose("pose")
pose.add_stream("socket")
motion = MotionVW("motion")
motion.add_stream("socket")
robot.append(pose)
robot.append(motion)
if MIDDLEWARE == "mavlink":
    motion.add_stream("mavlink", device=f"udpin:127.0.0.1:{NAMES['port']}")
elif MIDDLEWARE not in ("socket", "view", "multinode"):
    motion.add_stream(MIDDLEWARE)
    pose.add_stream(MIDDLEWARE)

env = Environment("empty", fastmode=True)
if MIDDLEWARE in ("rosbridge", "foxglove"):
    env.configure_stream_manager(MIDDLEWARE, port=0)
elif MIDDLEWARE == "mqtt":
    env.configure_stream_manager("mqtt", port=int(NAMES["port"]))
elif MIDDLEWARE == "ros2":
    env.configure_stream_manager("ros2", backend="cyclonedds", domain_id=int(NAMES["port"]))
elif MIDDLEWARE == "multinode":
    env.configure_multinode(server_port=int(NAMES["port"]))
