"""What is known of nodes is not computed again when another object comes or goes, and follows every change."""

from pathlib import Path
from typing import Any

import pytest

import morse
from morse.mathutils import Matrix
from morse.physics.poses.poses import relative_pose
from morse.scene import Node
from morse.scene.frames import rigid_frame

SCENE = """
from morse.builder import *
for number in range(6):
    robot = ATRV(f"robot{number}")
    robot.translate(3.0 * number, 5.0, 0.0)
    robot.append(Pose("pose"))
env = Environment("empty", fastmode=True)
"""


def chain() -> tuple[Node, Node, Node]:
    """A node, its parent, and the parent of the parent."""
    top, middle, leaf = Node("top"), Node("middle"), Node("leaf")
    top.attach(middle)
    middle.attach(leaf)
    leaf.location = [1.0, 0.0, 0.0]
    return leaf, middle, top


def test_a_frame_is_computed_once() -> None:
    leaf, middle, _ = chain()
    first = rigid_frame(leaf)
    assert rigid_frame(leaf) is first
    assert relative_pose(leaf, rigid_frame(middle))[0] is relative_pose(leaf, rigid_frame(middle))[0]


def test_a_frame_follows_the_node_and_all_nodes_above_it() -> None:
    leaf, middle, top = chain()
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.0)
    leaf.location[2] = 0.5  # in place
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.5)
    top.location = [0.0, 2.0, 0.0]
    assert tuple(rigid_frame(leaf).position) == (1.0, 2.0, 0.5)
    middle.scale = [3.0, 1.0, 1.0]
    assert tuple(rigid_frame(leaf).position) == (3.0, 2.0, 0.5)
    assert relative_pose(leaf, rigid_frame(top))[0] == pytest.approx([3.0, 0.0, 0.5])
    middle.rotation_euler = [0.0, 0.0, 3.141592653589793]
    assert tuple(rigid_frame(leaf).position) == pytest.approx((-3.0, 2.0, 0.5))
    middle.parent_inverse = Matrix.Translation((0.0, 0.0, 7.0))
    assert tuple(rigid_frame(leaf).position) == pytest.approx((-3.0, 2.0, 7.5))
    leaf.detach()
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.5)
    assert relative_pose(leaf, rigid_frame(top))[0] == pytest.approx([1.0, -2.0, 0.5])


def test_only_the_frames_of_what_comes_are_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.py").write_text(SCENE, encoding="utf-8")
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.spawn("before", "FakeRobot", (20.0, 0.0, 0.0))
        simulation.delete("before")
        computed: list[Any] = []
        from morse.scene import frames

        compute = frames._frame_of
        monkeypatch.setattr(frames, "_frame_of", lambda world: computed.append(world) or compute(world))
        simulation.spawn("newcomer", "FakeRobot", (20.0, 0.0, 0.0))
        came = sum(1 for _ in simulation.scene.find("newcomer").walk())
        assert len(computed) == came
        simulation.delete("newcomer")
        assert len(computed) == came
        simulation.step()
        x, y, _ = simulation.world.game_object("robot3").worldPosition
        assert (x, y) == pytest.approx((9.0, 5.0), abs=1e-3)


def test_a_restart_reads_no_signature_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.py").write_text(SCENE, encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(tmp_path / "scene.py", sockets=True, interfaces=["socket"]) as simulation:
        read: list[Any] = []
        from morse.core.validation import arguments

        signature = arguments.signature_of
        monkeypatch.setattr(arguments, "signature_of", lambda method: read.append(method) or signature(method))
        simulation.restart(seed=1)
        assert read == []
        assert (
            "get_local_data"
            in simulation.call("simulation", "details").result()["robots"][0]["components"]["robot0.pose"]["services"]
        )
