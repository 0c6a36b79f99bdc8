"""Searches for the smallest error of the first heading with which a Kalman filter loses its robot.

pip install "filterpy>=2,<3"
python falsify_filter.py
"""

from drive_by_filter import drive, scene

from morse.many import Scenario, uniform


def run(sim, wrong=0.0):
    """Drive; the filter believes a heading that is wrong by an angle, rad."""
    found = drive(sim, wrong)
    return {"corners": found["corners"], "off": found["filter"]}


scenario = Scenario(scene, run, wrong=uniform(0.0, 3.1), seed=range(3))
scenario.always("off < 0.5", name="the filter knows where the robot is")
scenario.always("corners == 8", name="the robot passes all corners")

if __name__ == "__main__":
    print(scenario.falsify("results", budget=40, workers=2))
