"""The state of components on /diagnostics, decoded by rosbags."""

from collections.abc import Callable
from typing import Any

PARTS = """
robot.append(Pose('pose'))
scan = Hokuyo('scan'); scan.frequency(10); robot.append(scan)
robot.append(MotionVW('motion'))
"""


def states(desk: Any) -> dict[str, Any]:
    return {one.name: one for one in desk.last("/diagnostics").status}


def values(state: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in state.values}


def test_each_component_has_a_state(start: Callable[..., Any]) -> None:
    sim, desk = start(PARTS)
    sim.step(90)
    kind, _, publisher = desk.publishers["/diagnostics"]
    assert kind == "diagnostic_msgs/msg/DiagnosticArray"
    assert len(publisher.sent) == 2, "at the beginning of each second"
    seen = states(desk)
    assert set(seen) == {f"morse: {name}" for name in ("simulation", "robot", *("robot." + n for n in NAMES))}
    scan = seen["morse: robot.scan"]
    assert (scan.level, scan.message, scan.hardware_id) == (scan.OK, "active", "robot")
    assert values(scan)["frequency (Hz)"] == "10.0"
    assert "real-time factor" in values(seen["morse: simulation"])

    sim.context.component("robot.pose").default_action = lambda: 1 / 0
    sim.context.component("robot.motion").active = False
    sim.step(60)
    seen = states(desk)
    assert seen["morse: robot.pose"].level == scan.ERROR
    assert "error" in seen["morse: robot.pose"].message
    assert seen["morse: robot.motion"].level == scan.WARN
    assert seen["morse: robot.scan"].level == scan.OK
    assert "robot.pose failed" in seen["morse: simulation"].message


def test_it_can_be_left_out(start: Callable[..., Any]) -> None:
    sim, desk = start(PARTS, "env.configure_stream_manager('ros2', diagnostics=False)")
    sim.step(2)
    assert "/diagnostics" not in desk.publishers


NAMES = ("pose", "scan", "motion")
