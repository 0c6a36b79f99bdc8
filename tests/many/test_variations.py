"""Masses and frictions that are changed while a simulation runs."""

import mujoco
import numpy as np
import pytest
from many_scenes import block, body

import morse

G = 9.81


def pushed():
    """A crate that stands still, and a robot that a force pushes."""
    from morse.builder import Environment, ForceTorque, Robot

    robot = Robot(name="robot")
    body(robot, mass=2.0)
    robot.append(ForceTorque("push"))
    block("Crate", 4.0, 0.0, 0.5, 0.5, static=False)
    Environment("empty")


def slide(sim, name, speed=3.0):
    """The distance that an object slides on the floor, m."""
    obj = sim.world.objects_by_name[name]
    obj.set_velocity([0.0, speed, 0.0], [0.0, 0.0, 0.0])
    begin = list(obj.worldPosition)
    sim.step(180)
    return float(np.hypot(*(np.array(obj.worldPosition) - begin)[:2]))


def test_friction_determines_how_far_a_crate_slides():
    with morse.load(pushed) as sim:
        for friction in (0.3, 0.6):
            sim.restart()
            sim.step(30)
            sim.set_friction("Crate", friction)
            assert slide(sim, "Crate") == pytest.approx(3.0**2 / (2.0 * friction * G), rel=0.1)


SLED = """<mujoco><worldbody><body name="sled" pos="0 0 0.2"><freejoint/>
<geom type="box" size="0.1 0.1 0.02" mass="1"/>
<body name="foot" pos="0 0 -0.15"><joint name="turn" axis="0 0 1"/>
<geom type="box" size="0.5 0.5 0.05" mass="4"/></body>
</body></worldbody></mujoco>"""


def test_the_friction_of_a_robot_is_that_of_its_feet_too(tmp_path):
    (tmp_path / "sled.xml").write_text(SLED)

    def scene():
        from morse.builder import Environment, Robot

        Robot(str(tmp_path / "sled.xml"), name="robot")
        Environment("empty")

    with morse.load(scene) as sim:
        for friction in (0.3, 0.6):
            sim.restart()
            sim.step(30)
            sim.set_friction("robot", friction)
            assert slide(sim, "robot") == pytest.approx(3.0**2 / (2.0 * friction * G), rel=0.1)


def test_mass_determines_the_acceleration_and_the_weight():
    with morse.load(pushed) as sim:
        robot = sim.robot.component.bge_object
        for mass in (2.0, 8.0):
            sim.restart()
            sim.robot.set_mass(mass)
            assert robot.mass == mass
            sim.place("robot", [0.0, 0.0, 30.0, 0.0, 0.0, 0.0])
            sim.robot.push.publish({"force": [16.0, 0.0, 0.0], "torque": [0.0, 0.0, 0.0]})
            sim.step(30)
            assert robot.velocity()[0][0] == pytest.approx(16.0 / mass * 0.5, rel=0.05)


def test_they_are_part_of_the_state_and_a_restart_forgets_them():
    with morse.load(pushed) as sim:
        fresh = sim.state_hash()
        sim.robot.set_mass(5.0)
        sim.set_friction("Crate", 0.2)
        varied, state = sim.state_hash(), sim.save()
        assert varied != fresh
        sim.restart()
        assert sim.state_hash() == fresh
        sim.restore(state)
        assert sim.state_hash() == varied
        assert sim.robot.component.bge_object.mass == 5.0


def test_they_survive_a_newcomer():
    with morse.load(pushed) as sim:
        sim.robot.set_mass(5.0)
        sim.set_friction("Crate", 0.2)
        sim.spawn("second", "ATRV", (-4.0, 0.0, 0.2))
        assert sim.robot.component.bge_object.mass == 5.0
        sim.step(30)
        assert slide(sim, "Crate", 1.5) == pytest.approx(1.5**2 / (2.0 * 0.2 * G), rel=0.15)


def test_one_value_for_each_row():
    with morse.batch(pushed, 3) as many:
        many.vary("robot", mass=[1.0, 2.0, 4.0])
        many.vary("Crate", rows=[2], friction=0.1)
        assert [sim.robot.component.bge_object.mass for sim in many] == [1.0, 2.0, 4.0]
        with pytest.raises(ValueError, match="expected one number or"):
            many.vary("robot", mass=[1.0, 2.0])


@pytest.mark.parametrize(
    ("name", "mass", "friction", "message"),
    [
        ("robot", 0.0, None, "the mass of 'robot' is 0.0, expected"),
        ("robot", -1.0, None, "expected"),
        ("robot", float("nan"), None, "nan"),
        ("Crate", None, -0.1, "the friction of 'Crate' is -0.1, expected 0 to 100"),
        ("Create", 1.0, None, "no object 'Create'; did you mean 'Crate'"),
    ],
)
def test_mistakes_are_named(name, mass, friction, message):
    change, value = ("set_mass", mass) if friction is None else ("set_friction", friction)
    with morse.load(pushed) as sim, pytest.raises((ValueError, KeyError), match=message):
        getattr(sim, change)(name, value)


def test_a_replay_contains_them():
    with morse.load(pushed) as sim:
        recording = sim.record_inputs()
        sim.step(10)
        sim.robot.set_mass(3.0)
        sim.place("robot", [1.0, 1.0, 0.5])
        sim.step(20, measure=True)
        sim.measure()
        sim.step(3)
        end = sim.state_hash()
        stopped = recording.stop()
    with morse.load(pushed) as sim:
        sim.replay(stopped)
        assert sim.state_hash() == end


def test_load_records(tmp_path):
    with morse.load(pushed, record=tmp_path / "run.mcap", keep_last=1.0) as sim:
        sim.step(10)
    from morse.recording.recording import Recording

    with Recording(tmp_path / "run.mcap") as recording:
        assert recording.last_tick() == 10
    with pytest.raises(ValueError, match="keep_last is a number"):
        morse.load(pushed, keep_last=-1.0)


def lit():
    """A lamp above a crate, a robot with a lamp, and a camera that sees the crate."""
    from morse.builder import Cube, Environment, Light, Robot, VideoCamera

    robot = Robot(name="robot")
    body(robot, mass=2.0)
    robot.append(Light("torch"))
    eye = VideoCamera("eye")
    eye.properties(cam_width=16, cam_height=16)
    eye.translate(z=0.5)
    robot.append(eye)
    crate = Cube("Crate")
    crate.scale, crate.location = (0.5, 2.0, 2.0), (4.0, 0.0, 1.0)
    crate._bpy_object.game.physics_type = "STATIC"
    Environment("empty")


def middle(sim):
    """The mean colour in the middle of the image."""
    sim.step(1, measure=True)
    return sim.robot.eye.data["image"][6:10, 6:10, :3].mean(axis=(0, 1))


def test_colours_and_lights_are_seen_saved_and_restored():
    with morse.load(lit) as sim:
        plain, fresh = middle(sim), sim.state_hash()
        sim.set_color("Crate", [1.0, 0.0, 0.0])
        red = middle(sim)
        assert red[0] > red[1] + 50 > 50
        assert sim.robot.torch.component.bge_object.childrenRecursive[0].node.light.energy == 1.0
        sim.set_light("robot", 20.0)
        bright = middle(sim)
        assert bright[0] > red[0] + 5
        state, end = sim.save(), sim.state_hash()
        sim.restart()
        assert np.array_equal(middle(sim), plain)
        assert sim.state_hash() == fresh
        sim.restore(state)
        assert sim.state_hash() == end
        assert np.allclose(middle(sim), bright, atol=1.0)
        sim.spawn("second", "ATRV", (-40.0, 0.0, 0.2))
        assert np.allclose(middle(sim), bright, atol=1.0)
    with morse.batch(lit, 2) as many:
        many.vary("Crate", color=[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        assert middle(many[0])[0] > middle(many[1])[0] + 50
        with pytest.raises(ValueError, match="the colour of 'Crate' is"):
            many.vary("Crate", color=[2.0, 0.0, 0.0])
        with pytest.raises(ValueError, match="'Crate' has no lamp"):
            many.vary("Crate", light=2.0)


def test_a_restart_restores_the_lamp_of_a_light():
    with morse.load(lit) as sim:
        sim.step(1)
        fresh = sim.state_hash()
        sim.robot.torch.set_property("energy", 7.0)
        sim.robot.torch.publish({"emit": False})
        sim.step(2)
        changed, state = sim.state_hash(), sim.save()
        sim.restart()
        sim.step(1)
        assert sim.state_hash() == fresh
        sim.restore(state)
        lamp = sim.robot.torch.component.bge_object.childrenRecursive[0]
        assert (lamp.visible, lamp.node.light.energy, sim.state_hash()) == (False, 7.0, changed)


def test_a_replay_contains_colours_and_restarts_of_robots():
    with morse.load(lit) as sim:
        recording = sim.record_inputs()
        sim.step(2)
        sim.set_color("Crate", [1.0, 0.0, 0.0])
        sim.set_light("robot", 3.0)
        sim.step(2)
        sim.robot.restart(5)
        sim.step(2)
        end, stopped = sim.state_hash(), recording.stop()
    with morse.load(lit) as sim:
        sim.replay(stopped)
        assert sim.state_hash() == end


SEESAW = """
<mujoco><option timestep="0.002"/><worldbody>
  <body name="beam" pos="0 0 1"><joint name="tip" axis="0 1 0"/><geom type="sphere" size="0.05" mass="1"/>
    <body name="left" pos="0.5 0 0"><joint name="left" axis="0 0 1"/><geom type="sphere" size="0.02" mass="0.5"/></body>
    <body name="right" pos="-0.5 0 0"><joint name="right" axis="0 0 1"/>
      <geom type="sphere" size="0.02" mass="0.5"/></body>
  </body>
</worldbody></mujoco>
"""


def test_masses_of_links(tmp_path):
    def seesaw():
        from morse.builder import Environment, Robot

        Robot(str(path), name="seesaw")
        Environment("empty")

    path = tmp_path / "seesaw.xml"
    path.write_text(SEESAW)
    with morse.batch(seesaw, 3) as many:
        many.vary("left", mass=[0.5, 0.7, 1.5])
        many.step(6)
        speeds = [float(one.world.data.qvel[0]) for one in many]
        # balanced; then the torque (m - m') g a over the moment of inertia (m + m') a² and that of the spheres
        assert speeds[0] == pytest.approx(0.0, abs=1e-9)
        for speed, mass in zip(speeds[1:], (0.7, 1.5), strict=True):
            spheres = 0.4 * (1.0 * 0.05**2 + (mass + 0.5) * 0.02**2)
            expected = (mass - 0.5) * 9.81 * 0.5 / ((mass + 0.5) * 0.25 + spheres) * 0.1
            assert speed == pytest.approx(expected, rel=0.01)
        heavy, light = many[2].world.model, many[0].world.model
        assert heavy.body_subtreemass[1] == pytest.approx(light.body_subtreemass[1] + 1.0)
        # as the engine computes it for a file with these masses
        other = mujoco.MjModel.from_xml_string(SEESAW.replace('mass="0.5"', 'mass="1.5"', 1))
        assert heavy.dof_invweight0[:3] == pytest.approx(other.dof_invweight0, rel=1e-9)
        state = many.save(2)[0]
        many.restart()
        assert many[2].world.game_object("left").mass == pytest.approx(0.5)
        many.restore([2], [state])
        assert many[2].world.game_object("left").mass == pytest.approx(1.5)
        with pytest.raises(ValueError, match="set that of one of its links: beam, left, right"):
            many.vary("seesaw", mass=2.0)
