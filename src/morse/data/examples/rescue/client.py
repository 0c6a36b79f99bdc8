"""Drives to the nearest visible victim and heals, until no victim is left."""

from pymorse import Morse


def main():
    """Returns the names of the healed victims, in order."""
    healed = []
    with Morse() as simu:
        robot = simu.robot
        while victims := [one for one in robot.finder.get()["victim_dict"].items() if one[1]["severity"] > 0]:
            name, victim = victims[0]  # the nearest one is the first
            print("%s lies at (%.1f, %.1f)" % (name, victim["coordinate"]["x"], victim["coordinate"]["y"]))
            robot.goal.goto(victim["coordinate"]["x"], victim["coordinate"]["y"], 0.0, 2.0, 1.5).result()
            healed.append(robot.finder.heal().result())
    return healed


if __name__ == "__main__":
    print("Healed: %s." % ", ".join(main()))
