"""Normals and velocities of the surfaces that rays hit."""

import math

import numpy as np
import pytest

SCENE = """
robot = ATRV()
laser = Sick()
laser.translate(z=1.0)
laser.rotate(z={turn})
laser.properties(scan_window=60.0, resolution=0.5)
robot.append(laser)
{objects}
Environment("empty", fastmode=True)
"""
SOLIDS = {
    "IcoSphere": lambda points: points,
    "Sphere": lambda points: points,
    "Cylinder": lambda points: points * (1.0, 1.0, 0.0),
}


def bundle(simulation):
    rays = simulation.context.components["robot.laser"].rays
    rays.refresh()
    return rays


def world(simulation, rays):
    body = simulation.context.components["robot.laser"].bge_object
    return np.array(body.worldPosition), np.array(body.worldOrientation)


@pytest.mark.parametrize("solid", sorted(SOLIDS))
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_normals_of_round_solids_point_away_from_their_axis(load, solid, turn):
    """A sphere of 1 m, and an upright cylinder: the radius at the hit, in the frame of the sensor."""
    text = f"solid = {solid}('solid'); solid.translate(4.0, 1.0, 1.0); solid.static()"
    simulation = load(SCENE.format(turn=turn, objects=text))
    simulation.step()
    rays = bundle(simulation)
    hit = rays.hit >= 0
    assert hit.sum() > 10
    position, rotation = world(simulation, rays)
    points = rays.points[hit] @ rotation.T + position - (4.0, 1.0, 1.0)
    radii = SOLIDS[solid](points)
    expected = radii / np.linalg.norm(radii, axis=1)[:, None] @ rotation
    assert rays.normals[hit] == pytest.approx(expected, abs=0.3 if solid == "IcoSphere" else 0.01)  # flat faces
    assert (np.einsum("ij,ij->i", rays.normals[hit], rays.directions[hit]) < 0.0).all()
    assert not rays.normals[~hit].any()


def test_the_normal_of_a_turned_wall_is_that_of_its_side(load):
    text = "wall = Cube('wall'); wall.scale = (0.1, 3.0, 3.0); wall.translate(5.0, 0.0, 1.0); wall.rotate(z=0.4)"
    text += "; wall.static()"
    simulation = load(SCENE.format(turn=0.0, objects=text))
    simulation.step()
    rays = bundle(simulation)
    ahead = len(rays) // 2
    _, rotation = world(simulation, rays)
    assert rays.normals[ahead] == pytest.approx(np.array([-math.cos(0.4), -math.sin(0.4), 0.0]) @ rotation, abs=1e-3)


def test_velocities_are_those_of_the_points_of_a_body(load):
    """Of the hull of another robot that drives a circle: v + w x r, over the ground, in the axes of the sensor."""
    text = """
other = ATRV("other"); other.translate(5.0, 0.0, 0.1); drive = MotionVW("drive"); other.append(drive)
wall = Cube("wall"); wall.scale = (0.1, 9.0, 3.0); wall.translate(9.0, 0.0, 1.0); wall.static()
"""
    simulation = load(SCENE.format(turn=0.2, objects=text).replace("laser.translate(z=1.0)", "laser.translate(z=0.3)"))
    simulation.other.drive.publish({"v": 1.0, "w": 0.5})
    simulation.sleep(0.5)
    rays = bundle(simulation)
    position, rotation = world(simulation, rays)
    body = simulation.context.robots["other"].bge_object
    on_robot = np.array([(rays.object_of(ray) or body).name.startswith("other") for ray in range(len(rays))])
    on_robot &= rays.hit >= 0
    assert on_robot.sum() > 5
    points = rays.points[on_robot] @ rotation.T + position
    spin = np.cross(np.array(body.worldAngularVelocity), points - np.array(body.worldPosition))
    expected = (np.array(body.worldLinearVelocity) + spin) @ rotation
    assert rays.velocities[on_robot] == pytest.approx(expected, abs=1e-9)
    assert np.linalg.norm(expected, axis=1).max() > 0.9
    on_wall = (rays.hit >= 0) & ~on_robot
    assert on_wall.any()
    assert not rays.velocities[on_wall].any()
