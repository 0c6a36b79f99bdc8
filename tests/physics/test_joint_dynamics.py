"""Joints that the physics moves, against the formulas of textbooks."""

import math
from dataclasses import replace

import numpy as np
import pytest
from linkages import HEIGHT, Linkage
from worlds import box, rigid, scene

from morse.physics import World
from morse.scene import Control, JointKind, PhysicsType

TICK = 1.0 / 60.0


def test_a_pendulum_swings_in_its_period() -> None:
    hanging, swing = -math.pi / 2.0, 0.1
    chain = Linkage(start=hanging + swing, mass=2.0, length=0.5, inertia=0.1)
    angles = []
    for _ in range(480):
        chain.step()
        angles.append(chain.positions[0] - hanging)
    seen = np.array(angles)
    down = np.flatnonzero((seen[:-1] > 0.0) & (seen[1:] <= 0.0))
    times = down + seen[down] / (seen[down] - seen[down + 1])
    # I = m l^2 + I_c; the second factor is that of the first term for a finite swing
    period = 2.0 * math.pi * math.sqrt((2.0 * 0.25 + 0.1) / (2.0 * 9.81 * 0.5)) * (1.0 + swing**2 / 16.0)
    assert np.diff(times).mean() * TICK == pytest.approx(period, rel=1e-4)
    assert seen.max() == pytest.approx(swing, rel=0.02)


def test_a_double_pendulum_keeps_its_energy() -> None:
    # the integrator is of first order: its loss is in proportion to the time step
    chain = Linkage(2, start=0.5, mass=1.0, length=0.4, inertia=0.02, steps=40)

    def energy() -> float:
        total = 0.0
        for link in chain.links:
            obj = chain.world.object_of(link)
            (_, _, z), r = obj.world_pose()
            (vx, vy, vz), (_, w, _) = obj.velocity()
            # the centre of mass is 0.4 m along X of the link, which turns about Y
            cx, cz = 0.4 * r[0], 0.4 * r[6]
            speed = (vx + w * cz) ** 2 + vy**2 + (vz - w * cx) ** 2
            total += 0.5 * speed + 0.5 * 0.02 * w * w + 9.81 * (z + cz)
        return total

    chain.step()
    before, lowest = energy(), 9.81 * (2 * HEIGHT - 0.4 - 0.8)
    chain.step(300)
    assert energy() - lowest == pytest.approx(before - lowest, rel=0.02)


def test_the_torque_that_holds_a_link_is_its_weight_times_its_arm() -> None:
    chain = Linkage(2, control=Control.POSITION, mass=1.5, length=0.4)
    chain.step(60)
    assert chain.positions == pytest.approx([0.0, 0.0], abs=3e-3)
    far, near = 1.5 * 9.81 * 0.4, 1.5 * 9.81 * (0.4 + 0.8)
    assert chain.efforts == pytest.approx([near, far], rel=1e-4)
    assert chain.velocities == pytest.approx([0.0, 0.0], abs=1e-6)


def test_the_force_that_holds_a_lift_is_its_weight() -> None:
    chain = Linkage(control=Control.POSITION, kind=JointKind.PRISMATIC, mass=4.0, gravity=9.81)
    # the axis is horizontal: no weight
    chain.step(60)
    assert chain.efforts == pytest.approx([0.0], abs=1e-9)
    chain.tell(0.2)
    chain.step(60)
    assert chain.positions == pytest.approx([0.2], abs=1e-4)
    place, _ = chain.world.object_of(chain.links[0]).world_pose()
    assert place == pytest.approx([0.0, -0.2, HEIGHT], abs=1e-4)


@pytest.mark.parametrize("ratio", [0.3, 0.7])
def test_the_step_response_of_a_motor_with_known_gains(ratio: float) -> None:
    inertia, frequency = 2.0 * 0.25 + 0.1, 8.0
    gain, slowing = inertia * frequency**2, 2.0 * ratio * frequency * inertia
    chain = Linkage(
        control=Control.POSITION, gravity=0.0, mass=2.0, length=0.5, inertia=0.1, gain=gain, slowing=slowing
    )
    chain.tell(0.2)
    damped = frequency * math.sqrt(1.0 - ratio**2)
    for tick in range(1, 90):
        chain.step()
        time = tick * TICK
        decay = math.exp(-ratio * frequency * time)
        wave = math.cos(damped * time) + ratio / math.sqrt(1.0 - ratio**2) * math.sin(damped * time)
        assert chain.positions[0] == pytest.approx(0.2 * (1.0 - decay * wave), abs=0.2 * 0.02)


def test_a_constant_torque_accelerates() -> None:
    chain = Linkage(gravity=0.0, mass=2.0, length=0.5, inertia=0.1)
    chain.tell(0.3)
    chain.step(60)
    rate = 0.3 / (2.0 * 0.25 + 0.1)
    assert chain.velocities == pytest.approx([rate], rel=1e-6)
    assert chain.positions == pytest.approx([0.5 * rate], rel=0.01)
    assert chain.efforts == pytest.approx([0.3])


@pytest.mark.parametrize("effort", [math.inf, 30.0])
def test_a_speed_is_kept_against_gravity(effort: float) -> None:
    chain = Linkage(control=Control.VELOCITY, effort=effort)
    chain.tell(1.0)
    chain.step(120)
    # the weight needs 9.81 N m; a motor that has 30 N m lags by 0.1 rad/s at most
    lag = 0.1 * 9.81 / 30.0
    assert chain.positions[0] == pytest.approx(2.0, abs=2.0 * lag + 0.02)
    assert chain.velocities[0] == pytest.approx(1.0, abs=lag)


def test_a_motor_at_its_largest_effort_does_not_chatter() -> None:
    chain = Linkage(control=Control.VELOCITY, effort=2.0, gravity=0.0, mass=0.01, inertia=1e-5)
    chain.tell(8.0)
    speeds = []
    for _ in range(90):
        chain.step()
        speeds.append(chain.velocities[0])
    assert np.diff(speeds).min() > -1e-9, "it never overshoots"
    assert speeds[-1] == pytest.approx(8.0, abs=1e-3)


def test_damping_slows_and_dry_friction_stops() -> None:
    inertia = 2.0 * 0.25 + 0.1
    chain = Linkage(gravity=0.0, mass=2.0, length=0.5, inertia=0.1, damping=0.9)
    chain.tell(0.45)
    chain.step(600)
    assert chain.velocities == pytest.approx([0.5], rel=1e-3), "where damping equals the torque"
    chain = Linkage(gravity=0.0, mass=2.0, length=0.5, inertia=0.1, friction=0.2)
    chain.tell(0.1)
    chain.step(60)
    # the engine lets it creep
    assert abs(chain.velocities[0]) < 1e-3
    chain.tell(0.5)
    chain.step(60)
    assert chain.velocities == pytest.approx([0.3 / inertia], rel=0.01)


def test_a_spring_pulls_to_its_rest() -> None:
    chain = Linkage(gravity=0.0, stiffness=5.0, rest=0.4, damping=3.0)
    chain.step(600)
    assert chain.positions == pytest.approx([0.4], abs=1e-3)


def test_limits_stop_a_joint_and_a_motor_has_a_largest_effort() -> None:
    chain = Linkage(control=Control.POSITION, effort=3.0, build=False)
    (bone,) = chain.arm.bones
    chain.arm.bones = (replace(bone, low=-0.7, high=0.7),)
    chain.world = World(chain.scene)
    chain.step(240)
    # 9.81 N m pull it down, and the motor has 3 N m
    assert chain.efforts == pytest.approx([3.0])
    assert chain.positions == pytest.approx([-0.7], abs=0.01)


def test_a_joint_follows_another() -> None:
    chain = Linkage(2, follows=True, control=Control.POSITION)
    assert chain.joints.positions(("joint1",)) == pytest.approx([0.0])
    chain.joints.tell(("joint0",), (0.6,))
    chain.step(120)
    assert chain.positions == pytest.approx([0.6, 0.3], abs=5e-3)


def test_the_velocity_of_a_link_is_the_change_of_its_pose() -> None:
    chain = Linkage(2, start=0.5, mass=1.0, steps=100)
    obj = chain.world.object_of(chain.links[1])
    chain.step(30)
    before = np.array(obj.world_pose()[0])
    first = np.array(obj.velocity()[0])
    chain.step()
    after, second = np.array(obj.world_pose()[0]), np.array(obj.velocity()[0])
    assert (after - before) / TICK == pytest.approx((first + second) / 2.0, abs=0.01)


# -- joints that the physics moves are saved, restored, reset, and survive changes of the scene ----


def test_a_state_goes_on_with_the_same_bits() -> None:
    one, other = (Linkage(2, start=0.4, mass=1.0) for _ in range(2))
    one.tell(0.3, -0.2)
    one.step(50)
    state = one.world.get_state()
    one.step(50)
    other.world.set_state(state)
    other.step(50)
    assert other.positions == one.positions
    assert other.velocities == one.velocities
    assert other.efforts == one.efforts == pytest.approx([0.3, -0.2])


def test_a_reset_brings_the_joints_back_and_the_motors_hold_them() -> None:
    chain = Linkage(2, start=0.4, control=Control.POSITION)
    chain.tell(1.0, 1.0)
    chain.step(60)
    assert chain.positions[0] > 0.9
    chain.world.reset()
    assert chain.positions == pytest.approx([0.4, 0.0])
    chain.step(120)
    assert chain.positions == pytest.approx([0.4, 0.0], abs=5e-3)


def test_objects_that_come_and_go_leave_joints_alone() -> None:
    chain, alone = (Linkage(2, start=0.4, mass=1.0) for _ in range(2))
    for each in (chain, alone):
        each.tell(0.1, 0.1)
        each.step(20)
    crate = rigid("crate", box(1, 1, 1), at=(9, 9, 9))
    chain.world.add([crate])
    joints = chain.joints
    chain.step(20)
    chain.world.remove([chain.world.object_of(crate)])
    chain.step(20)
    alone.step(40)
    assert chain.positions == pytest.approx(alone.positions, abs=1e-12)
    assert joints.positions(chain.names) == chain.positions, "a handle stays valid"


def test_a_linkage_comes_into_a_running_world_and_goes() -> None:
    world = World(scene(rigid("crate", box(1, 1, 1), at=(9, 9, 9))))
    world.step()
    chain = Linkage(2, control=Control.POSITION, build=False)
    chain.world = world
    world.add([chain.root])
    world.step()
    assert chain.positions == pytest.approx([0.0, 0.0], abs=0.01)
    chain.step(60)
    assert chain.positions == pytest.approx([0.0, 0.0], abs=5e-3)
    world.remove([world.object_of(chain.root)])
    assert not world.joints


def test_a_robot_is_placed_with_its_links() -> None:
    chain = Linkage(start=0.3, control=Control.POSITION, build=False)
    chain.root.body.type = PhysicsType.RIGID_BODY
    chain.root.shapes = [box(0.5, 0.5, 0.5)]
    world = chain.world = World(chain.scene)
    tip = world.object_of(chain.links[0])
    before = np.array(tip.world_pose()[0])
    world.object_of(chain.root).set_pose((1.0, 2.0, 3.0), (1, 0, 0, 0, 1, 0, 0, 0, 1))
    assert np.array(tip.world_pose()[0]) == pytest.approx(before + np.array([1.0, 2.0, 3.0]))


def test_a_bolted_robot_does_not_move() -> None:
    chain = Linkage(control=Control.POSITION)
    chain.tell(1.0)
    chain.step(60)
    assert chain.world.object_of(chain.root).world_pose()[0] == pytest.approx([0.0, 0.0, 0.0])


def test_a_joint_that_diverges_is_put_back_and_named() -> None:
    chain = Linkage(2, mass=1.0)
    chain.step(5)
    chain.world.data.qvel[0] = math.inf
    chain.step()
    assert np.isfinite(chain.positions).all()
    assert chain.world.recoveries[0].body.startswith("link")
    chain.step(5)
    assert np.isfinite(chain.velocities).all()


def test_masses_that_no_joint_can_have_are_made_usable() -> None:
    chain = Linkage(3, control=Control.POSITION, build=False)
    for link in chain.links:
        link.inertial = replace(link.inertial, mass=0.0, inertia=(0.0,) * 9)
    chain.world = World(chain.scene)
    chain.step(60)
    assert chain.positions == pytest.approx([0.0, 0.0, 0.0], abs=0.01)
