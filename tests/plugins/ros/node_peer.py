"""A process that becomes a node as simulations do, and tells what the master knows about it."""

import sys
import time

import rosgraph

from morse.plugins.ros.node import join


def main() -> None:
    rospy = join()
    from std_msgs.msg import String

    taken: list[str] = []
    rospy.Publisher("/said", String, queue_size=1)
    rospy.Subscriber("/heard", String, lambda message: taken.append(message.data))
    print("ready", flush=True)
    sys.stdin.readline()  # there is another master now
    master = rosgraph.Master("/test")
    end = time.monotonic() + 60.0
    known: list[list[str]] = [[], []]
    while time.monotonic() < end and ("/said" not in known[0] or "/heard" not in known[1]):
        time.sleep(0.05)
        published, subscribed, _ = master.getSystemState()
        known = [[topic for topic, _ in published], [topic for topic, _ in subscribed]]
    print("/said" in known[0], "/heard" in known[1], flush=True)


main()
