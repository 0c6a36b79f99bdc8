"""Searches for starts from which the robot does not dock, and for starts from which it says so wrongly.

pip install opencv-python-headless
python falsify_docking.py
"""

from dock_at_marker import dock, scene

from morse.many import Scenario, uniform

scenario = Scenario(scene, dock, x=uniform(1.2, 3.5), y=uniform(-1.2, 1.2), yaw=uniform(-3.1, 3.1))
scenario.always("docked < 1 or distance < 0.65", name="it is there when it says so")
scenario.always("docked > 0", name="it arrives")

if __name__ == "__main__":
    print(scenario.falsify("results", runs=60, workers=2))
