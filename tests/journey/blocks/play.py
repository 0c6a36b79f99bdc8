from pymorse import Morse

with Morse() as simu:

    robot = simu.robot

    # across the room, and the ball with it
    robot.motion.publish({"v": 1.0, "w": 0.0})
    while robot.pose.get()["x"] < 1.5:
        pass

    # back, until the station charges the battery
    robot.motion.publish({"v": -1.0, "w": 0.0})
    while robot.battery.get()["status"] == "Discharging":
        pass

    robot.motion.publish({"v": 0.0, "w": 0.0})
    print("%(status)s, %(charge).0f %%" % robot.battery.get())
