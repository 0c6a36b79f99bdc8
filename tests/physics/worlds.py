"""Small scenes of primitives for tests of the physics."""

import math

import numpy as np

from morse.physics import World
from morse.scene import (
    BodySettings,
    CollisionShape,
    ComponentDeclaration,
    Node,
    PhysicsType,
    Scene,
    ShapeKind,
)


def node(name, shape, *, at=(0, 0, 0), turned=(0, 0, 0), kind=PhysicsType.STATIC, **settings) -> Node:
    made = Node(name, location=list(at), rotation_euler=list(turned))
    made.body = BodySettings(type=kind, **settings)
    made.shapes = [shape] if shape is not None else []
    return made


def box(x, y, z) -> CollisionShape:
    """A box of these edge lengths."""
    return CollisionShape(ShapeKind.BOX, (x / 2, y / 2, z / 2))


def sphere(radius) -> CollisionShape:
    return CollisionShape(ShapeKind.SPHERE, (radius,))


def ground(*, tilt=0.0, friction=None) -> Node:
    """A slab whose upper side passes through the origin, tilted about Y."""
    c, s = math.cos(tilt), math.sin(tilt)
    return node("Ground", box(40, 40, 1), at=(-0.5 * s, 0, -0.5 * c), turned=(0, tilt, 0), friction=friction)


def rigid(name, shape, *, at, mass=1.0, **settings) -> Node:
    settings = {"linear_damping": 0.0, "angular_damping": 0.0} | settings
    return node(name, shape, at=at, kind=PhysicsType.RIGID_BODY, mass=mass, **settings)


def robot(name="robot", shape=None, *, at=(0, 0, 0.25), mass=10.0, **settings) -> Node:
    made = rigid(name, shape or box(0.5, 0.4, 0.5), at=at, mass=mass, **settings)
    made.properties["GroundRobot"] = True
    return made


def scene(*roots: Node, robots=(), gravity=9.81) -> Scene:
    made = Scene(roots=list(roots))
    made.settings.gravity = gravity
    made.components = [ComponentDeclaration(r, "robot", "morse.core.robot.Robot", r) for r in robots]
    return made


def world(*roots: Node, robots=(), gravity=9.81) -> World:
    return World(scene(*roots, robots=robots, gravity=gravity))


def run(world: World, seconds: float, each_tick=None) -> None:
    for _ in range(round(seconds * 60)):
        if each_tick is not None:
            each_tick()
        world.step()


def bits(state):
    """The complete state as text, with all bits."""
    if isinstance(state, dict):
        return "{" + ",".join(f"{key}:{bits(state[key])}" for key in sorted(state)) + "}"
    if isinstance(state, (list, tuple)):
        return "[" + ",".join(map(bits, state)) + "]"
    if isinstance(state, np.ndarray):
        return f"{state.dtype}{state.shape}{state.tobytes().hex()}"
    return state.hex() if isinstance(state, float) else repr(state)
