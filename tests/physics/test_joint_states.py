"""Joints that the physics moves are saved, restored, reset, and survive changes of the scene."""

import math
from dataclasses import replace

import numpy as np
import pytest
from linkages import Linkage
from worlds import box, rigid, scene

from morse.physics import World
from morse.scene import Control, PhysicsType


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
