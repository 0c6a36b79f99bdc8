"""A robot that a client describes neither ends the simulation nor disturbs other robots."""

import pytest

import morse
from morse.builder import ATRV, IMU, Environment, Pose

STEP = """<mujoco><option timestep="{step}"/><worldbody><body name="b"><freejoint/><geom size="0.1"/></body></worldbody>
</mujoco>"""
SCANNER = """<robot name="r"><link name="a"/><gazebo reference="a"><sensor name="scan" type="gpu_lidar"><ray><scan>
<horizontal><samples>{samples}</samples>{more}</horizontal></scan></ray></sensor></gazebo></robot>"""

FAN = "<min_angle>-1</min_angle><max_angle>1</max_angle>"


def scene() -> None:
    robot = ATRV("robot")
    robot.append(Pose("pose"))
    robot.append(IMU("imu"))
    Environment("empty")


@pytest.mark.parametrize("step", ["1e-12", "1e-300", "1e-5", "0.002", "1e9"])
def test_the_time_step_of_a_text_takes_a_limited_time(step: str) -> None:
    with morse.load(scene, on_failure="raise") as simulation:
        simulation.spawn("guest", STEP.format(step=step), (5.0, 0.0, 2.0))
        model = simulation.world.model
        assert model.opt.timestep >= 0.99e-4
        simulation.step(6)
        # it has fallen for a tenth of a second: g t^2 / 2
        z = simulation.world.objects_by_name["guest"].world_pose()[0][2]
        assert 2.0 - z == pytest.approx(0.049, abs=0.01)
        simulation.delete("guest")
        simulation.step(2)


@pytest.mark.parametrize("samples", ["1", "0", "-3", "1.5", "100000000", "nan"])
@pytest.mark.parametrize(
    "more", ["", "<min_angle>-1</min_angle><max_angle>1</max_angle>", "<resolution>0</resolution>"]
)
def test_sensors_come_and_go_between_measurements(samples: str, more: str) -> None:
    with morse.load(scene, on_failure="raise") as simulation:
        for _ in range(3):
            simulation.spawn("guest", SCANNER.format(samples=samples, more=more), (5.0, 0.0, 0.0))
            simulation.step(1)
            simulation.delete("guest")
        simulation.step(2)
        assert simulation.robot.imu.get()["timestamp"] == pytest.approx(simulation.clock.time)
