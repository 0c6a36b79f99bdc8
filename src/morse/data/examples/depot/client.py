"""Fetches three boxes from the end of a belt, one after the other, and stores each of them in a bay."""

import math

from pymorse import Morse

BAYS = [(6.0, -2.0), (6.0, -3.5), (6.0, -5.0)]
PICK = (-0.1, 0.2)


def place_of(simu, name):
    """The position of an object, m."""
    return simu.rpc("simulation", "get_scene_objects")[name][1]


def turn_to(robot, angle):
    """Turn to a direction, rad."""
    while True:
        left = math.remainder(angle - robot.pose.get()["yaw"], math.tau)
        if abs(left) < 0.03:
            break
        robot.motion.publish({"v": 0.0, "w": max(-1.0, min(1.0, 2.0 * left))})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def go(robot, x, y, speed=1.2, within=0.1):
    """Turn to a place and drive there, m."""
    at = robot.pose.get()
    turn_to(robot, math.atan2(y - at["y"], x - at["x"]))
    while True:
        at = robot.pose.get()
        apart = math.hypot(x - at["x"], y - at["y"])
        if apart < within:
            break
        left = math.remainder(math.atan2(y - at["y"], x - at["x"]) - at["yaw"], math.tau)
        robot.motion.publish({"v": min(speed, 0.3 + apart) * max(0.0, math.cos(left)), "w": 2.0 * left})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def fetch(simu, bay):
    """Order a box, wait for it at the end of the belt, and carry it to a bay."""
    robot = simu.robot
    simu.rpc("source", "dispense")
    go(robot, 1.2, 0.2)
    while not simu.rpc("last", "objects"):
        simu.sleep(0.2)
    (box,) = simu.rpc("last", "objects")
    while place_of(simu, box)[1] > 0.0:
        simu.sleep(0.2)
    go(robot, *PICK, speed=0.5)
    turn_to(robot, math.pi)
    if not robot.gripper.grab().result():
        raise RuntimeError(f"{box} is out of reach")
    robot.motion.publish({"v": -0.5, "w": 0.0})
    while robot.pose.get()["x"] < 1.0:
        pass
    go(robot, bay[0] - 3.0, bay[1])
    go(robot, bay[0] - 1.1, bay[1])
    robot.gripper.release().result()
    simu.sleep(0.5)
    robot.motion.publish({"v": -0.6, "w": 0.0})
    while robot.pose.get()["x"] > bay[0] - 2.0:
        pass
    robot.motion.publish({"v": 0.0, "w": 0.0})
    return box


def main():
    """Returns the positions of the stored boxes, m."""
    with Morse() as simu:
        return [place_of(simu, box) for box in [fetch(simu, bay) for bay in BAYS]]


if __name__ == "__main__":
    print("Stored %d boxes." % len(main()))
