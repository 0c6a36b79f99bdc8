"""The services and the action of simulation_interfaces, called by a node of rclpy with the types of the package.

There is no wheel of the package: `.ci/ros2` compiles the definitions in the folder `simulation_interfaces`.
"""

import subprocess
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, lent, need, talk

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(Pose("pose"))
robot.add_default_interface("ros2")
zone = Zone("Charging")
zone.name = "dock"
zone.translate(x=3.0)
zone.size = (1.0, 2.0, 0.5)
env = Environment("empty", fastmode=True)
env.add_service("ros2")
env.configure_stream_manager("ros2", domain_id={domain}, backend="rclpy")
"""
OK, INCORRECT_STATE, FAILED = 1, 3, 4
SUCCEEDED, CANCELED = 4, 5  # action_msgs/GoalStatus
SPAWNABLES, STEPS_ACTION, PAUSED, ROBOT = 14, 33, 2, 1


@pytest.mark.peer("ros-jazzy-rclpy", does="spawns, moves, pauses and steps by simulation_interfaces")
@pytest.mark.timeout(200)
def test_a_node_spawns_moves_and_steps(tmp_path: Path) -> None:
    need("simulation_interfaces.srv", PYTHON)
    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
    with (tmp_path / "said").open("w") as told:
        simulation = subprocess.Popen(
            [PYTHON, "-m", "morse", "run", "--headless", "scene.py"],
            stdout=told, stderr=told, cwd=tmp_path, env={**lent(), "MORSE_SOCKET_PORT": "0"},
        )  # fmt: skip
    try:
        said = talk("simulation_interfaces_peer.py", lambda: None, PYTHON)
    finally:
        simulation.kill()
        simulation.wait()
    assert {SPAWNABLES, STEPS_ACTION} <= set(said["features"])
    assert {"ATRV", "Quadrotor", "props/crates"} <= set(said["spawnables"])
    assert said["spawned"] == [["second", OK], ["crates", OK], ["third", OK], ["", FAILED]]
    assert {"robot", "second", "crates", "third"} <= set(said["entities"])
    assert said["states"]
    assert said["put"] == said["deleted"] == said["paused"] == said["step"] == said["reset"] == OK
    assert said["place"] == pytest.approx(7.0, abs=0.05)
    assert all(0.19 < length < 0.6 for length in said["size"]), "a box of 0.4 x 0.3 x 0.2 m in any attitude"
    assert (said["noted"], said["blue"]) == (OK, ["third"])
    assert said["poses"] == [["dock", 3.0]]
    assert said["dock"] == [4.0, 2.0]
    assert (said["kind"], said["state"]) == (ROBOT, PAUSED)
    assert said["world"] == "empty"
    assert {"empty", "sandbox"} <= set(said["worlds"])
    assert said["steps of a running one"] == INCORRECT_STATE
    assert said["steps"] == [SUCCEEDED, OK]
    assert said["seconds"] == pytest.approx(2.0, abs=1e-6)
    assert said["progress"]
    assert all(done + left == 120 for done, left in said["progress"])
    assert said["two at once"] is False
    assert (said["canceling"], said["canceled"]) == (1, CANCELED)
