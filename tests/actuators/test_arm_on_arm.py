"""An arm that is mounted on the tip of another arm: both move its links."""

import numpy as np
import pytest
from arms import tip_of

SCENE = """
robot = FakeRobot()
lower = KukaLWR()
robot.append(lower)
upper = KukaLWR()
lower.append(upper)
tip = Pose()
upper.append(tip)
"""


@pytest.mark.parametrize("first", ["lower", "upper"])
def test_the_tip_is_where_both_arms_put_it(simulate, first):
    sim = simulate(SCENE, sockets=False)
    arms = {"lower": sim.context.component("robot.lower"), "upper": sim.context.component("robot.lower.upper")}
    angles = {"lower": [0.3, -0.7, 0.2, 0.9, -0.4, 0.5, 0.1], "upper": [-0.5, 0.4, 0.8, -0.6, 0.3, 0.2, -0.9]}
    for name in sorted(arms, key=lambda name: name != first):
        arms[name].local_data.update(zip(arms[name].joints, angles[name], strict=True))
        sim.step(90)
    for _ in range(3):
        # both at once
        for name, arm in arms.items():
            angles[name] = [angle * 0.9 for angle in angles[name]]
            arm.local_data.update(zip(arm.joints, angles[name], strict=True))
        sim.step(20)
    assert arms["upper"].joint_values == pytest.approx(angles["upper"])
    placed = tip_of(angles["lower"]) @ tip_of(angles["upper"])
    tip = sim.context.component("robot.lower.upper.tip").local_data
    assert [tip[axis] for axis in "xyz"] == pytest.approx(placed[:3, 3].tolist(), abs=2e-3)
    assert np.linalg.norm(placed[:3, 3]) > 1.0
