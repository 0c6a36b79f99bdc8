"""Pictures of the world that follow each other."""

import morse
from morse.rendering import photograph


def scene():
    from morse.builder import ATRV, Cube, Environment

    ATRV("robot")
    crate = Cube("Crate")
    crate.location = (2.0, 0.0, 0.5)
    crate._bpy_object.game.physics_type = "RIGID_BODY"
    Environment("empty")


def test_a_later_picture_is_as_the_first_of_its_world():
    with morse.load(scene) as sim:
        changes = [
            lambda: sim.step(10),
            lambda: sim.place("Crate", [1.0, 1.0, 0.7]),
            lambda: sim.rpc("simulation", "set_object_visibility", "Crate", False, False),
            lambda: sim.spawn("more", "props/crates", (3.0, 1.0, 0.5)),
            sim.restart,
        ]
        before = sim.picture(96, 60)
        for change in changes:
            change()
            picture = sim.picture(96, 60)
            assert (picture == photograph(sim.world, 96, 60)).all()
        assert (sim.picture(50, 40, location=[1.0, 0.0, 9.0], rotation=[0.0, 0.0, 0.0]).shape) == (40, 50, 3)
        sim.place("Crate", [0.0, 2.0, 0.0])
        assert (sim.picture(96, 60) != before).any()
