"""Patrols; below 50 % the robot returns to the station and stays there until it has 80 %."""

from pymorse import Morse

STATION, PATROL = (-4.0, 0.0), [(0.0, 2.0), (0.0, -2.0)]


def main():
    """Returns the charge when the robot turned back, when it arrived, and when it left, %."""
    with Morse() as simu:
        goal, battery, places = simu.robot.goal, simu.robot.battery, PATROL * 20
        while battery.get()["charge"] > 50.0:
            goal.goto(*places.pop(0), 0.0, 0.5, 2.0).result()
        low = battery.get()["charge"]
        goal.goto(*STATION, 0.0, 0.3, 2.0).result()
        arrived = battery.get()["charge"]
        while (data := battery.get())["charge"] < 80.0:
            assert data["status"] == "Charging", data
        return low, arrived, data["charge"]


if __name__ == "__main__":
    print("Turned back at %.0f %%, arrived with %.0f %%, left with %.0f %%." % main())
