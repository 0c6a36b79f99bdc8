"""The scene of @env@ starts, and its robot drives.

Run the tests in the folder of the project (`python -m pip install pytest` once):    python -m pytest
"""

from pathlib import Path

SCENE = Path(__file__).parents[1] / "default.py"


def test_the_robot_drives(simulate):
    # without sockets, the scene runs in the process of the test, and its time passes only in sleep, step and get
    simulation = simulate(SCENE, sockets=False)
    before = simulation.robot.pose.get()
    simulation.robot.motion.publish({"v": 1.0, "w": 0.0})
    simulation.sleep(1.0)
    after = simulation.robot.pose.get()
    assert (after["x"] - before["x"]) ** 2 + (after["y"] - before["y"]) ** 2 > 0.5**2
