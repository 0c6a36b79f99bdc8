#! /usr/bin/env python3
"""Drive the robot of @env@ with the keys W, A, S and D, and print where it is.

Start the simulation first, in another terminal:    morse run @env@
"""

from pymorse import Morse

print("Use WASD to drive the robot (each followed by Enter), Ctrl+C to leave")

with Morse() as simu:
    # names are those of default.py: simu.<robot>.<component>
    motion = simu.robot.motion
    pose = simu.robot.pose

    v = 0.0  # linear speed, m/s
    w = 0.0  # angular speed, rad/s

    try:
        while True:
            key = input("WASD? ").strip().lower()

            if key == "w":
                v += 0.1
            elif key == "s":
                v -= 0.1
            elif key == "a":
                w += 0.1
            elif key == "d":
                w -= 0.1
            else:
                continue

            # pose.get() waits for the next measurement
            print("The robot is at:", pose.get())

            motion.publish({"v": v, "w": w})
    except (KeyboardInterrupt, EOFError):
        print("\nBye!")
