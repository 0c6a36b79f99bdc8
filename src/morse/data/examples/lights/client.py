"""Shows an arrow before each turn, and red when the robot stops."""

from pymorse import Morse

ARROW = ["  #    ", " #     ", "#######", " #     ", "  #    "]
AMBER, RED, DARK = [1.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]


def picture(lines, colour):
    """Rows of colours from rows of letters."""
    return [[colour if letter == "#" else DARK for letter in line] for line in lines]


def main():
    """Returns the heading after a turn to the left and after a turn to the right, rad."""
    headings = []
    with Morse() as simu:
        robot = simu.robot
        robot.lamp.toggle(True).result()
        for lines, rate in ((ARROW, 0.5), ([line[::-1] for line in ARROW], -0.5)):
            robot.leds.set_pattern(picture(lines, AMBER)).result()
            robot.leds.blink(0.4).result()
            simu.sleep(0.8)
            robot.motion.publish({"v": 0.4, "w": rate})
            simu.sleep(2.0)
            robot.motion.publish({"v": 0.0, "w": 0.0})
            simu.sleep(0.1)
            headings.append(robot.pose.get()["yaw"])
        robot.leds.blink(0.0).result()
        robot.leds.set_all(*RED).result()
    return headings


if __name__ == "__main__":
    print("Turned to %.2f rad, and back to %.2f rad." % tuple(main()))
