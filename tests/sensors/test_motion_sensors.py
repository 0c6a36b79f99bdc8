"""Velocity, acceleration and attitude against the physics of a circle, a fall and a tilt."""

import math

import numpy as np
import pytest
from messages import published

import morse
from morse.core.kinds import bind
from morse.wire.encoding import to_json

G = 9.81
DRIVEN = """
robot = ATRV()
motion = MotionVW()
robot.append(motion)
{parts}
env = Environment("empty", fastmode=True)
"""
HELD = """
robot = FakeRobot()
robot.translate(z=1.0)
robot.rotate({roll}, {pitch}, {yaw})
{move}
{parts}
env = Environment("empty", fastmode=True)
"""
MODES = ("Velocity", "Position")


def part(kind, mode=None, x=0.0, z=0.0, name="sensor"):
    setting = f"{name}.properties(ComputationMode='{mode}')" if mode else ""
    return f"{name} = {kind}()\n{name}.translate(x={x}, z={z})\n{setting}\nrobot.append({name})\n"


def driving(simulate, parts, v, w, seconds=1.5):
    simulation = simulate(DRIVEN.format(parts=parts), sockets=False)
    simulation.sleep(0.5)
    simulation.context.component("robot.motion").local_data.update(v=v, w=w)
    simulation.sleep(seconds)
    return simulation


def held(simulate, parts, *, roll=0.0, pitch=0.0, yaw=0.0, move=""):
    return simulate(HELD.format(parts=parts, roll=roll, pitch=pitch, yaw=yaw, move=move), sockets=False)


@pytest.mark.parametrize("mode", MODES)
def test_velocity_on_a_circle(simulate, mode):
    data = driving(simulate, part("Velocity", mode), v=1.0, w=0.5).context.component("robot.sensor").local_data
    assert data["linear_velocity"] == pytest.approx([1.0, 0.0, 0.0], abs=0.01)
    assert data["angular_velocity"] == pytest.approx([0.0, 0.0, 0.5], abs=0.005)
    yaw = 0.5 * 1.5
    assert data["world_linear_velocity"] == pytest.approx([math.cos(yaw), math.sin(yaw), 0.0], abs=0.02)


def test_the_lever_arm_counts_for_positions_not_for_the_velocity_of_the_body(simulate):
    parts = part("Velocity", "Velocity", x=0.5, name="body") + part("Velocity", "Position", x=0.5, name="place")
    simulation = driving(simulate, parts, v=0.0, w=1.0)
    assert simulation.context.component("robot.body").local_data["linear_velocity"] == pytest.approx(
        [0.0, 0.0, 0.0], abs=0.01
    )
    assert simulation.context.component("robot.place").local_data["linear_velocity"] == pytest.approx(
        [0.0, 0.5, 0.0], abs=0.01
    )


@pytest.mark.parametrize("mode", MODES)
def test_centripetal_acceleration_on_a_circle(simulate, mode):
    data = driving(simulate, part("Accelerometer", mode), v=1.0, w=0.5).context.component("robot.sensor").local_data
    # v^2 / r = v w, to the left; no gravity
    assert data["acceleration"] == pytest.approx([0.0, 0.5, 0.0], abs=0.02)
    assert data["velocity"] == pytest.approx([1.0, 0.0, 0.0], abs=0.01)
    assert data["distance"] == pytest.approx(1.0 / 60.0, rel=0.01)
    assert data["angular_acceleration"] == pytest.approx([0.0, 0.0, 0.0], abs=0.05)


@pytest.mark.parametrize("mode", MODES)
def test_centripetal_acceleration_on_a_lever_arm(simulate, mode):
    data = (
        driving(simulate, part("Accelerometer", mode, x=0.5), v=0.0, w=1.0).context.component("robot.sensor").local_data
    )
    assert data["acceleration"] == pytest.approx([-0.5, 0.0, 0.0], abs=0.02)


def test_rates_below_that_of_the_ticks(simulate):
    simulation = driving(simulate, part("Accelerometer") + "sensor.frequency(25)\n", v=1.0, w=0.5)
    assert simulation.context.component("robot.sensor").local_data["acceleration"] == pytest.approx(
        [0.0, 0.5, 0.0], abs=0.03
    )


@pytest.mark.parametrize("mode", ["Automatic", *MODES])
def test_an_imu_at_rest_feels_that_the_floor_carries_it(simulate, mode):
    simulation = simulate(DRIVEN.format(parts=part("IMU", mode, z=0.8)), sockets=False)
    simulation.sleep(3.0)
    data = simulation.context.component("robot.sensor").local_data
    assert data["linear_acceleration"] == pytest.approx([0.0, 0.0, G], abs=0.01)
    assert data["angular_velocity"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


@pytest.mark.parametrize(
    ("angles", "felt"),
    [
        ({"pitch": math.radians(30)}, [-G * 0.5, 0.0, G * math.cos(math.radians(30))]),
        ({"roll": math.radians(90)}, [0.0, G, 0.0]),
        ({"roll": math.pi, "yaw": 1.0}, [0.0, 0.0, -G]),
    ],
)
def test_a_tilted_imu(simulate, angles, felt):
    simulation = held(simulate, part("IMU"), **angles)
    simulation.sleep(0.1)
    assert simulation.context.component("robot.sensor").local_data["linear_acceleration"] == pytest.approx(
        felt, abs=1e-6
    )


def test_a_falling_imu_feels_nothing_but_the_drag(simulate):
    script = DRIVEN.format(parts=part("IMU")).replace("ATRV()\n", "ATRV()\nrobot.translate(z=100.0)\n", 1)
    simulation = simulate(script.replace('Environment("empty", fastmode=True)', 'Environment("empty")'), sockets=False)
    simulation.context.component("robot.motion").active = False
    simulation.sleep(1.0)
    data = simulation.context.component("robot.sensor").local_data
    # the damping of the model keeps 1 - 0.025 of the velocity per second; after a fall of one second that is 9.7 m/s
    drag = -math.log(1.0 - 0.025) * 9.7
    assert data["linear_acceleration"] == pytest.approx([0.0, 0.0, drag], abs=0.02)


@pytest.mark.parametrize("mode", MODES)
def test_an_imu_on_a_lever_arm(simulate, mode):
    data = driving(simulate, part("IMU", mode, x=0.5), v=0.0, w=1.0).context.component("robot.sensor").local_data
    assert data["linear_acceleration"] == pytest.approx([-0.5, 0.0, G], abs=0.03)
    assert data["angular_velocity"] == pytest.approx([0.0, 0.0, 1.0], abs=0.01)


def test_a_turned_imu_has_axes_of_its_own(simulate):
    parts = part("IMU", "Position") + "sensor.rotate(y=math.pi / 2)\n"
    data = driving(simulate, parts, v=0.0, w=1.0).context.component("robot.sensor").local_data
    # its X axis points down
    assert data["angular_velocity"] == pytest.approx([-1.0, 0.0, 0.0], abs=0.01)
    assert data["linear_acceleration"] == pytest.approx([-G, 0.0, 0.0], abs=0.02)


def test_gyroscope_and_attitude_give_the_same_angles(simulate):
    parts = part("Gyroscope", name="gyro") + part("Attitude", name="attitude")
    simulation = held(simulate, parts, roll=0.1, pitch=0.2, yaw=2.0)
    simulation.sleep(0.1)
    gyro, attitude = (
        simulation.context.component("robot.gyro").local_data,
        simulation.context.component("robot.attitude").local_data,
    )
    assert [gyro[name] for name in ("roll", "pitch", "yaw")] == pytest.approx([0.1, 0.2, 2.0], abs=1e-9)
    assert list(attitude["rotation"]) == pytest.approx([0.1, 0.2, 2.0], abs=1e-9)
    assert b'"rotation": {"yaw": ' in to_json(attitude)


@pytest.mark.parametrize("mode", MODES)
def test_attitude_gives_the_rates_of_the_body(simulate, mode):
    move = "motion = MotionXYW()\nrobot.append(motion)\n"
    simulation = held(simulate, part("Attitude", mode), roll=math.pi / 2, move=move)
    simulation.context.component("robot.motion").local_data.update(w=0.4)
    simulation.sleep(0.5)
    data = simulation.context.component("robot.sensor").local_data
    assert data["angular_velocity"] == pytest.approx([0.0, 0.0, 0.4], abs=1e-6)


def test_attitude_against_north(simulate):
    setting = part("Attitude") + "sensor.properties(UseAngleAgainstNorth=True)\n"
    script = HELD.format(parts=setting, roll=0.0, pitch=0.1, yaw=3.0, move="")
    simulation = simulate(script + "env.properties(angle_against_north=0.5)\n", sockets=False)
    simulation.sleep(0.1)
    attitude = simulation.context.component("robot.sensor")
    # 0.5 rad beyond the -X axis of the world is more than half a turn
    assert list(attitude.local_data["rotation"]) == pytest.approx([0.0, 0.1, 3.5 - 2 * math.pi], abs=1e-9)
    assert bind(attitude)[0].gather().frame == "enu"


def test_what_they_say_as_message_kinds(simulate):
    parts = part("IMU", name="imu") + part("Velocity", name="velocity") + part("Accelerometer", name="accelerometer")
    parts += part("Gyroscope", name="gyroscope")
    simulation = held(simulate, parts, yaw=1.0, pitch=math.radians(30))
    simulation.sleep(0.1)
    (imu,) = bind(
        simulation.context.component("robot.imu")
    )  # no magnetometer, because the world has no geographic position
    assert imu.gather().linear_acceleration == pytest.approx([-G / 2, 0.0, G * math.sqrt(0.75)], abs=1e-6)
    assert [
        bind(simulation.context.component(f"robot.{name}"))[0].kind.name
        for name in ("velocity", "accelerometer", "gyroscope")
    ] == [
        "twist",
        "accel",
        "attitude",
    ]
    w, x, y, z = bind(simulation.context.component("robot.gyroscope"))[0].gather().orientation
    s, c = math.sin(math.radians(15)), math.cos(math.radians(15))
    expected = [c * math.cos(0.5), -s * math.sin(0.5), s * math.cos(0.5), c * math.sin(0.5)]
    assert [w, x, y, z] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("kind", ["IMU", "Velocity", "Accelerometer", "Attitude"])
def test_a_mode_that_is_none_is_refused(simulate, kind):
    with pytest.raises(Exception, match=r"'ComputationMode' of .* did you mean 'Velocity'"):
        held(simulate, part(kind, "Velo"))


def test_they_go_on_from_a_saved_state(simulate):
    parts = part("IMU", "Position", x=0.3) + part("Velocity", "Position", name="velocity")
    simulation = driving(simulate, parts, v=1.0, w=0.5, seconds=0.5)
    state = simulation.save()

    def ahead():
        simulation.sleep(0.2)
        return [to_json(simulation.context.component(f"robot.{name}").local_data) for name in ("sensor", "velocity")]

    first = ahead()
    simulation.restore(state)
    assert ahead() == first


BALL = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
ARM = f"""<robot name="arm"><link name="world"/>
<link name="post"><inertial><mass value="5"/>{BALL}</inertial></link>
<joint name="stand" type="fixed"><parent link="world"/><child link="post"/><origin xyz="0 0 1"/></joint>
<link name="link"><inertial><mass value="1"/>{BALL}</inertial></link>
<joint name="hinge" type="continuous"><parent link="post"/><child link="link"/><axis xyz="0 0 1"/></joint>
<link name="tip"/><joint name="end" type="fixed"><parent link="link"/><child link="tip"/><origin xyz="0.8 0 0"/></joint>
<gazebo reference="tip"><sensor name="imu" type="imu"><update_rate>60</update_rate></sensor></gazebo></robot>"""
TURNED = """
robot = Robot({file!r})
joints = Armature(armature_name="arm_joints")
joints.control("velocity")
robot.append(joints)
env = Environment("empty", fastmode=True)
"""


def test_a_steady_arm_feels_the_centripetal_acceleration_alone(simulate, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    simulation = simulate(TURNED.format(file=str(path)), sockets=False)
    simulation.context.component("robot.joints").local_data["hinge"] = 3.0
    simulation.step(300)
    forces = []
    for _ in range(7):
        simulation.step(1)
        data = simulation.robot.imu.get()
        forces.append(data["linear_acceleration"])
        assert data["angular_velocity"] == pytest.approx([0.0, 0.0, 3.0], abs=1e-3)
    for force in forces:
        assert force == pytest.approx([-(3.0**2) * 0.8, 0.0, G], abs=1e-3)


# -- a robot that is placed elsewhere has not moved there: sensors of motion measure what happens afterwards

PERIOD = 1.0 / 60.0


def moved(mode):
    def scene():
        from morse.builder import ATRV, IMU, Accelerometer, Environment, MotionVW, Odometry, Velocity

        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        for part in (Accelerometer("accelerometer"), IMU("imu"), Velocity("velocity")):
            part.properties(ComputationMode=mode)
            robot.append(part)
        robot.append(Odometry("odometry"))
        for level in ("raw", "differential"):
            odometry = Odometry(level)
            odometry.level(level)
            robot.append(odometry)
        Environment("empty")

    return scene


@pytest.mark.parametrize("mode", ["Velocity", "Position"])
@pytest.mark.parametrize("is_read", [False, True])
@pytest.mark.parametrize("ticks", [0, 1, 30])
def test_no_sensor_takes_a_placement_for_a_motion(mode, is_read, ticks):
    with morse.load(moved(mode)) as sim:
        robot = sim.robot
        robot.motion.publish({"v": 1.0, "w": 0.0})
        sim.step(ticks)
        if is_read:
            assert robot.odometry.data["x"] == pytest.approx(ticks * PERIOD, abs=1e-3)
        sim.place("robot", [5.0, -5.0, 1.0])
        sim.measure()
        if is_read:
            data = robot.odometry.data
            assert [data[name] for name in ("x", "y", "yaw")] == pytest.approx([5.0, -5.0, 1.0], abs=1e-6)
            for name in ("vx", "vy", "vz", "wx", "wy", "wz"):
                assert data[name] == pytest.approx(0.0, abs=1e-6)
            for sensor, fields in {
                "accelerometer": ("distance", "velocity", "acceleration", "angular_acceleration"),
                "imu": ("angular_velocity",),
                "velocity": ("linear_velocity", "angular_velocity"),
                "raw": ("dS",),
                "differential": ("dx", "dy", "dyaw"),
            }.items():
                for field in fields:
                    value = np.asarray(robot.parts[sensor].data[field])
                    assert value == pytest.approx(np.zeros(value.shape), abs=1e-6), (sensor, field)
            assert np.linalg.norm(robot.imu.data["linear_acceleration"]) == pytest.approx(9.81, abs=0.01)
        sim.step(2)
        data = robot.odometry.data
        assert [data["vx"], data["vy"], data["wz"]] == pytest.approx([1.0, 0.0, 0.0], abs=0.01)
        assert robot.raw.data["dS"] == pytest.approx(PERIOD, rel=0.02)
        assert robot.accelerometer.data["distance"] == pytest.approx(PERIOD, rel=0.02)
        assert robot.velocity.data["linear_velocity"] == pytest.approx([1.0, 0.0, 0.0], abs=0.02)


# -- iMUs with the errors of their data sheets -----------------------------------------------------

SCRIPT = """
robot = FakeRobot()
imu = {kind}()
{setting}
robot.append(imu)
env = Environment("empty", fastmode=True)
"""


def at_rest(simulate, kind="IMU", setting="", seconds=20.0, seed=None):
    simulation = simulate(SCRIPT.format(kind=kind, setting=setting), seed=seed, sockets=False)
    messages = published(simulation.context.component("robot.imu"))
    simulation.sleep(seconds)
    fields = ("angular_velocity", "linear_acceleration")
    return simulation, [np.array([message[field] for message in messages]) for field in fields]


@pytest.mark.parametrize(
    # data sheets: deg/s/√Hz, and µg/√Hz along X, Y and Z
    ("kind", "degrees", "micro_g"),
    [("ADIS16448", 0.0135, (230.0,) * 3), ("BMI088", 0.014, (160.0, 160.0, 190.0)), ("VN100", 0.0035, (140.0,) * 3)],
)
def test_real_devices(simulate, kind, degrees, micro_g):
    simulation, (gyro, force) = at_rest(simulate, kind, seconds=40.0)
    # white noise of a given density, sixty times per second; biases hardly change within seconds
    turning, pushing = (np.diff(values, axis=0).std(axis=0) / math.sqrt(120) for values in (gyro, force))
    assert turning == pytest.approx([math.radians(degrees)] * 3, rel=0.06)
    assert pushing == pytest.approx(np.array(micro_g) * 9.80665e-6, rel=0.06)
    assert force.mean(axis=0) == pytest.approx([0.0, 0.0, 9.81], abs=0.03)
    message = bind(simulation.context.component("robot.imu"))[0].gather()
    white = np.diag(message.linear_acceleration_covariance)
    assert white[2] / white[0] == pytest.approx((micro_g[2] / micro_g[0]) ** 2, rel=0.1)


def test_an_ideal_one(simulate):
    simulation, (gyro, force) = at_rest(simulate, seconds=0.5)
    assert not gyro.any()
    assert force == pytest.approx(np.tile([0.0, 0.0, 9.81], (len(force), 1)))
    assert bind(simulation.context.component("robot.imu"))[0].gather().angular_velocity_covariance is None


def test_the_same_seed_gives_the_same_errors(simulate):
    runs = [at_rest(simulate, "BMI088", seconds=0.5, seed=seed)[1][0] for seed in (1, 1, 2)]
    assert np.array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


def test_the_message_says_how_large_they_are(simulate):
    setting = "imu.properties(GyroNoiseDensity=1e-3, AccelNoiseDensity=2e-3)"
    message = bind(at_rest(simulate, setting=setting, seconds=0.1)[0].context.component("robot.imu"))[0].gather()
    assert message.angular_velocity_covariance == pytest.approx(np.eye(3) * 60e-6)
    assert message.linear_acceleration_covariance == pytest.approx(np.eye(3) * 240e-6)


def test_errors_go_on_from_a_saved_state(simulate):
    simulation, _ = at_rest(simulate, "ADIS16448", seconds=0.5)
    state = simulation.save()
    simulation.sleep(0.2)
    first = list(simulation.context.component("robot.imu").local_data["angular_velocity"])
    simulation.restore(state)
    simulation.sleep(0.2)
    assert simulation.context.component("robot.imu").local_data["angular_velocity"] == first


def test_another_noise_while_it_runs(simulate):
    simulation, _ = at_rest(simulate, seconds=0.1)
    simulation.context.component("robot.imu").set_property("GyroNoiseDensity", 0.1)
    simulation.sleep(0.1)
    assert any(simulation.context.component("robot.imu").local_data["angular_velocity"])


@pytest.mark.parametrize("setting", ["GyroNoiseDensity=-1.0", "AccelBiasInstability='low'", "BiasCorrelationTime=0.0"])
def test_what_is_no_noise(simulate, setting):
    with pytest.raises(Exception, match=f"'{setting.split('=')[0]}' of IMU is"):
        at_rest(simulate, setting=f"imu.properties({setting})")


# -- angles of wheels against the distance that they roll ------------------------------------------

WHEEL_ENCODERS_SCRIPT = """
robot = {robot}()
motion = MotionVWDiff()
robot.append(motion)
encoders = WheelEncoders()
{setting}
robot.append(encoders)
pose = Pose()
robot.append(pose)
env = Environment("empty", fastmode=True)
"""
RADIUS, TRACK = 0.0977, 0.342


def driven(simulate, v, w, setting="", robot="Pioneer3DX"):
    simulation = simulate(WHEEL_ENCODERS_SCRIPT.format(robot=robot, setting=setting), sockets=False)
    simulation.sleep(0.5)
    start = list(simulation.context.component("robot.encoders").local_data["position"])
    simulation.context.component("robot.motion").local_data.update(v=v, w=w)
    simulation.sleep(2.0)
    return simulation, start


def test_wheels_that_roll_ahead(simulate):
    simulation, start = driven(simulate, 0.5, 0.0)
    data, way = (
        simulation.context.component("robot.encoders").local_data,
        simulation.context.component("robot.pose").local_data["x"],
    )
    assert way == pytest.approx(1.0, abs=0.1)
    assert len(data["wheels"]) == 2
    for before, after in zip(start, data["position"], strict=True):
        assert (after - before) * RADIUS == pytest.approx(way, rel=0.02)
    assert data["velocity"] == pytest.approx([0.5 / RADIUS] * 2, rel=0.05)


def test_wheels_that_turn_a_robot(simulate):
    simulation, _ = driven(simulate, 0.0, 0.5)
    encoders = simulation.context.component("robot.encoders")
    speeds = dict(zip(encoders.local_data["wheels"], encoders.local_data["velocity"], strict=True))
    (left,) = (speed for name, speed in speeds.items() if "left" in name.lower() or name.upper().endswith("L"))
    (right,) = (speed for name, speed in speeds.items() if "right" in name.lower() or name.upper().endswith("R"))
    assert left < 0.0 < right
    assert right == pytest.approx(-left, rel=0.05)


def test_whole_steps(simulate):
    setting = "encoders.properties(StepsPerTurn=16)"
    simulation, _ = driven(simulate, 0.5, 0.0, setting)
    exact, _ = driven(simulate, 0.5, 0.0, "encoders.properties(StepsPerTurn=0)")
    data, angles = (
        simulation.context.component("robot.encoders").local_data,
        exact.context.component("robot.encoders").local_data["position"],
    )
    step = math.tau / 16
    for ticks, position, angle in zip(data["ticks"], data["position"], angles, strict=True):
        assert position == pytest.approx(ticks * step)
        assert 0.0 <= angle - position < step


def test_as_a_message_kind(simulate):
    simulation, _ = driven(simulate, 0.5, 0.0)
    message = bind(simulation.context.component("robot.encoders"))[0].gather()
    assert message.kind.name == "joints"
    assert list(message.names) == simulation.context.component("robot.encoders").local_data["wheels"]
    assert message.velocity == pytest.approx([0.5 / RADIUS] * 2, rel=0.05)


def test_four_wheels(simulate):
    simulation, _ = driven(simulate, 0.5, 0.0, robot="SegwayRMP400")
    assert len(simulation.context.component("robot.encoders").local_data["position"]) == 4


def test_a_robot_without_wheels(simulate):
    with pytest.raises(Exception, match="has no driven wheels: append wheel encoders to a robot whose wheels turn"):
        simulate(
            WHEEL_ENCODERS_SCRIPT.format(robot="ATRV", setting="").replace("MotionVWDiff", "MotionVW"), sockets=False
        )


def test_they_go_on_from_a_saved_state_wheel_encoders(simulate):
    simulation, _ = driven(simulate, 0.5, 0.2)
    state = simulation.save()
    simulation.sleep(0.2)
    first = simulation.context.component("robot.encoders").local_data["ticks"][:]
    simulation.restore(state)
    simulation.sleep(0.2)
    assert simulation.context.component("robot.encoders").local_data["ticks"] == first
