"""A client that only uses roslibpy; prints the received data."""

import json
import sys
import threading

import roslibpy

ros = roslibpy.Ros("127.0.0.1", int(sys.argv[1]))
ros.run(timeout=50)
seen: dict = {"topics": ros.get_topics(), "odom_type": ros.get_topic_type("/robot/odometry")}
enough = threading.Event()


def odometry(message):
    seen.setdefault("odometry", []).append(message)
    if message["pose"]["pose"]["position"]["x"] > 0.3:
        enough.set()


topics = {
    "/robot/odometry": ("nav_msgs/msg/Odometry", odometry),
    "/robot/scan": ("sensor_msgs/LaserScan", lambda m: seen.update(scan=m)),  # the name in ROS 1
    "/robot/camera/image": ("sensor_msgs/msg/Image", lambda m: seen.update(image=m)),
    "/tf_static": ("tf2_msgs/msg/TFMessage", lambda m: seen.update(tf_static=m)),
    "/clock": ("rosgraph_msgs/msg/Clock", lambda m: seen.update(clock=m)),
}
for name, (kind, take) in topics.items():
    roslibpy.Topic(ros, name, kind).subscribe(take)
wheels = roslibpy.Topic(ros, "/robot/cmd_vel", "geometry_msgs/msg/Twist")
wheels.advertise()
wheels.publish(roslibpy.Message({"linear": {"x": 0.5}, "angular": {"z": 0.0}}))
assert enough.wait(50), seen.keys()
while not {"scan", "image", "tf_static", "clock"} <= seen.keys():
    enough.wait(0.1)
    enough.clear()


def call(name, arguments):
    return roslibpy.Service(ros, name, "").call(roslibpy.ServiceRequest(arguments), timeout=50)


seen["services"] = ros.get_services()
seen["stopped"] = dict(call("/robot/motion/set_speed", {"v": 0.0, "w": 0.25}))
seen["arrived"] = dict(call("/robot/waypoint/goto", {"x": 0.5, "y": 0.0, "z": 0.0, "tolerance": 5.0}))
try:
    call("/robot/motion/set_speed", {"fast": 1})
except Exception as error:
    seen["refused"] = str(error)


def goal(arguments, cancelled):
    action = roslibpy.ActionClient(ros, "/robot/waypoint/goto", "")
    results = []
    number = action.send_goal(roslibpy.Goal(arguments), results.append, lambda _: None, results.append)
    if cancelled:
        action.cancel_goal(number)
    action.wait_goal(number, timeout=50)
    return results[0]["status"].name, results[0]["values"]


near = {"x": 0.5, "y": 0.0, "z": 0.0, "tolerance": 5.0}
seen["goals"] = [goal(near, False), goal({**near, "x": 500.0}, True), goal({"far": 1}, False)]
print(json.dumps(seen))
ros.close()
