"""A robot that a client describes neither ends the simulation nor disturbs other robots."""

import pytest

import morse
from morse.builder import ATRV, IMU, Environment, Pose
from pymorse import MorseServiceFailed

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


SENSORS = {
    "camera": "<camera><image><width>16</width><height>16</height></image></camera>",
    "imu": "",
    "contact": "<contact><collision>c</collision></contact>",
}


def with_sensors(kind: str, count: int) -> str:
    sensor = f'<sensor name="s{{}}" type="{kind}"><update_rate>1</update_rate>{SENSORS[kind]}</sensor>'
    return (
        '<sdf version="1.7"><model name="m"><link name="base"><collision name="c"><geometry><box><size>1 1 1</size>'
        f"</box></geometry></collision>{''.join(map(sensor.format, range(count)))}</link></model></sdf>"
    )


@pytest.mark.parametrize("kind", SENSORS)
@pytest.mark.parametrize("count", [200, 2000])
def test_what_a_client_spawns_has_a_budget_of_components(kind: str, count: int) -> None:
    with morse.load(scene) as simulation:
        before = simulation.state_hash()
        with pytest.raises(MorseServiceFailed, match="more than 200 robots, sensors and actuators"):
            simulation.rpc("simulation", "spawn", "guest", with_sensors(kind, count), [5.0, 0.0, 2.0])
        assert simulation.state_hash() == before
        assert "guest" not in simulation.world.objects_by_name
        simulation.rpc("simulation", "spawn", "guest", with_sensors(kind, 3), [5.0, 0.0, 2.0])
        assert len([name for name in simulation.context.components if name.startswith("guest.")]) == 3


def test_a_program_spawns_more_than_a_client() -> None:
    with morse.load(scene) as simulation:
        simulation.spawn("guest", with_sensors("imu", 210), (5.0, 0.0, 2.0))
        assert len([name for name in simulation.context.components if name.startswith("guest.")]) == 210


@pytest.mark.parametrize("step", ["1e-12", "1e-4", "0.00049"])
def test_the_text_of_a_client_does_not_set_a_short_time_step(step: str) -> None:
    with morse.load(scene) as simulation:
        before = simulation.world.model.opt.timestep
        with pytest.raises(MorseServiceFailed, match=r"clients may spawn descriptions with 0\.0005 s or more"):
            simulation.rpc("simulation", "spawn", "guest", STEP.format(step=step), [5.0, 0.0, 2.0])
        assert simulation.world.model.opt.timestep == before
        simulation.rpc("simulation", "spawn", "guest", STEP.format(step="0.0005"), [5.0, 0.0, 2.0])
        assert simulation.world.model.opt.timestep == pytest.approx(0.0005, rel=0.03)


def test_a_recording_repeats_what_a_client_was_refused() -> None:
    with morse.load(scene) as simulation, morse.load(scene) as other:
        with simulation.record_inputs() as recording:
            simulation.step(2)
            with pytest.raises(MorseServiceFailed):
                simulation.rpc("simulation", "spawn", "guest", with_sensors("imu", 300), [5.0, 0.0, 2.0])
            simulation.step(2)
        other.replay(recording)
        assert other.state_hash() == simulation.state_hash()
