"""Chains of links for tests of joints that the physics moves."""

import math

from worlds import scene

from morse.physics import World
from morse.scene import (
    Articulation,
    BodySettings,
    Bone,
    Control,
    Inertial,
    JointDynamics,
    JointKind,
    Node,
    NodeKind,
    PhysicsType,
)

#: Z axis of the bone along -Y of the armature: positive angles raise a link that points along X
_ACROSS = (1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
_SAME = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
#: of the first joint above the floor, m
HEIGHT = 3.0


class Linkage:
    """Links along X, each with its mass at its end, on joints about -Y.

    Args:
        count: number of links.
        length: of each, m.
        start: value of the first joint at the start, rad.
        mass: of each link, kg.
        inertia: about the centre of mass, kg m^2, of each link.
        kind: of the joints.
        follows: whether the second joint follows the first, times 0.5.
        steps: of the engine in a tick.
        dynamics: of all joints, see `morse.scene.JointDynamics`.
    """

    def __init__(
        self, count=1, *, length=0.5, start=0.0, mass=2.0, inertia=0.01, kind=JointKind.REVOLUTE, follows=False,
        control=Control.EFFORT, gravity=9.81, build=True, steps=4, **dynamics,
    ) -> None:  # fmt: skip
        self.names = tuple(f"joint{number}" for number in range(count))
        self.root = Node("post", body=BodySettings(type=PhysicsType.STATIC), shapes=[])
        self.arm = Node("arm", NodeKind.ARMATURE, location=[0.0, 0.0, HEIGHT], shapes=[])
        self.arm.articulation = Articulation(mass=count * mass, control=tuple((n, control) for n in self.names))
        self.root.attach(self.arm)
        bones, angle, place = [], 0.0, [0.0, 0.0, 0.0]
        moves = JointDynamics(control=control, **dynamics)
        tensor = (inertia, 0.0, 0.0, 0.0, inertia, 0.0, 0.0, 0.0, inertia)
        self.links = []
        for number, name in enumerate(self.names):
            value = start if number == 0 else 0.5 * start if follows else 0.0
            # the frame of the first bone is turned, those of the others are parallel to it
            where = (0.0, 0.0, 0.0) if number == 0 else (length, 0.0, 0.0)
            bones.append(
                Bone(
                    name, number - 1, where, _ACROSS if number == 0 else _SAME, 0.0, kind, axis=2, low=-100.0,
                    high=100.0,
                    value=value, dynamics=moves, leader=0 if follows and number else -1, factor=0.5,
                )
            )  # fmt: skip
            angle += value if kind is JointKind.REVOLUTE else 0.0
            link = Node(f"link{number}", location=list(place), rotation_euler=[0.0, -angle, 0.0], shapes=[], bone=name)
            link.inertial = Inertial(mass, (length, 0.0, 0.0), tensor)
            self.arm.attach(link)
            self.links.append(link)
            place = [place[0] + length * math.cos(angle), 0.0, place[2] + length * math.sin(angle)]
        self.arm.bones = tuple(bones)
        self.scene = scene(self.root, gravity=gravity)
        self.scene.settings.physics_steps = steps
        if build:
            self.world = World(self.scene)

    @property
    def joints(self):
        return self.world.object_of(self.arm).joints()

    def tell(self, *values) -> None:
        self.joints.tell(self.names, values)

    def step(self, ticks=1) -> None:
        for _ in range(ticks):
            self.world.step()

    @property
    def positions(self) -> list[float]:
        return self.joints.positions(self.names)

    @property
    def velocities(self) -> list[float]:
        return self.joints.velocities(self.names)

    @property
    def efforts(self) -> list[float]:
        return self.joints.efforts(self.names)
