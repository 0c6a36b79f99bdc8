"""Images of cameras that take over what has not changed are those of a renderer that draws each image anew."""

import gc
import weakref

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from studio import FAR, Studio, Tripod, ball, box, floor, lamp

from morse.assets.collision import resolve_shapes
from morse.kernel.loading import library
from morse.rendering import Lens, Motion, Renderer
from morse.rendering.distortion import DistortedLens
from morse.scene import PhysicsType, Scene
from tests.kit.effort import examples

pytestmark = pytest.mark.skipif(library() is None, reason="numpy keeps nothing")

DOWN = Tripod((0.0, -0.5, 4.0), (0.0, 0.0, 0.0))
ASIDE = Tripod((-5.0, 1.0, 2.0), (0.0, 0.0, 0.5))
LENS = Lens.of_focal_length(128, 96, 22.0, 0.1, FAR)
BENT = DistortedLens(96, 64, 70.0, 70.0, 48.0, 32.0, 0.1, FAR, "plumb_bob", (-0.25, 0.06, 0.001, 0, 0))
NAMES = ("High", "Low", "Round", "Arm")
CHANGES = ("move", "nudge", "hide", "color", "lamp", "switch", "add", "remove", "reset", "state")
OF_CAMERAS = ("turn", "lens", "expose", "blur")
OPERATIONS = st.sampled_from(["nothing", *CHANGES, *OF_CAMERAS])


def world():
    rigid = {"kind": PhysicsType.RIGID_BODY}
    mast = box("Mast", (1.5, 1.0, 0.5), (0.05, 0.05, 0.5))
    mast.attach(box("Arm", (0, 0.4, 0), (1, 4, 0.2)))
    spot = lamp("SPOT", (0.2, 0.1, 1.0), 3.0, (1.0, 0.5, 4.0))
    return Studio(
        floor(half=60.0),
        # above the camera that looks down: only its shadow is visible
        box("High", (0.2, 0, 6), (0.2, 0.2, 0.2), **rigid),
        box("Low", (-0.5, 0.3, 0.2), (0.2, 0.2, 0.2), **rigid),
        ball("Round", (0.6, -0.4, 0.3), 0.3, **rigid),
        mast,
        lamp("SUN", (0.05, 0.1, 1.0)),
        spot,
    )


class Rig:
    """Cameras in one world, which two renderers serve: one of them draws each image anew."""

    def __init__(self):
        self.studio = world()
        self.renderers = self.studio.renderer, Renderer(self.studio.world)
        self.requests = [
            [
                renderer.request(DOWN, LENS),
                renderer.request(ASIDE, LENS, normals=True),
                renderer.request(ASIDE, LENS, color=False),
                renderer.request(DOWN, BENT),
            ]
            for renderer in self.renderers
        ]
        for request in self.requests[1]:
            request.memory = None
        self.added = []

    def compare(self):
        """Serve all cameras; returns their images."""
        for renderer, requests in zip(self.renderers, self.requests, strict=True):
            renderer.serve(requests)
        for one, other in zip(*self.requests, strict=True):
            for name in ("rgba", "depth", "ids", "normals"):
                np.testing.assert_array_equal(getattr(one.picture, name), getattr(other.picture, name))
        return [request.picture for request in self.requests[0]]

    def do(self, what, rng):
        world = self.studio.world
        thing = world.game_object(NAMES[rng.integers(len(NAMES))])
        place, turn = thing.world_pose()
        if what in ("move", "nudge"):
            by = rng.normal(size=3) * (0.3 if what == "move" else 1e-7)
            thing.set_pose(tuple(np.array(place) + by), turn)
        elif what == "hide":
            thing.setVisible(not thing.visible)
        elif what == "color":
            thing.node.color = (*rng.uniform(0, 1, 3), 1.0)
            world.appearance_changed(thing)
        elif what in ("lamp", "switch"):
            shines = [node for node in self.studio.scene.nodes() if node.light is not None]
            shine = world.object_of(shines[rng.integers(len(shines))])
            if what == "switch":
                shine.setVisible(not shine.visible)
            else:
                shine.set_pose(tuple(np.add(shine.world_pose()[0], (0.1, 0, 0))), shine.world_pose()[1])
        elif what == "add" and len(self.added) < 3:
            node = box(f"New{rng.integers(10**9)}", (*rng.normal(size=2), 0.2), (0.1, 0.1, 0.2))
            resolve_shapes(Scene(roots=[node]))
            self.added.append(world.add([node]))
        elif what == "remove" and self.added:
            world.remove(self.added.pop())
        elif what == "reset":
            world.reset()
        elif what == "state":
            state = world.get_state()
            thing.set_pose((0.0, 0.0, 1.0), turn)
            self.compare()
            world.set_state(state)
        else:
            number = rng.integers(len(self.requests[0]))
            for requests in self.requests:
                self._adjust(requests[number], what)

    def _adjust(self, request, what):
        if what == "turn":
            request.obj = Tripod(np.add(request.obj.position, (0.01, 0, 0)), (0.0, 0.0, 0.2))
        elif what == "lens" and not isinstance(request.lens, DistortedLens):
            request.lens = Lens.of_focal_length(100 if request.lens.width == 128 else 128, 96, 22.0, 0.1, FAR)
        elif what == "expose":
            request.exposure *= 1.5
        elif what == "blur":
            request.motion = None if request.motion else Motion(0.02, 0.02, 3)


@settings(max_examples=examples(20), deadline=None)
@given(seed=st.integers(0, 10**6), operations=st.lists(OPERATIONS, max_size=8))
@example(seed=0, operations=["move", "add"])  # a part of the world moves, then something comes
def test_random_changes(seed, operations):
    rig, rng = Rig(), np.random.default_rng(seed)
    for what in operations:
        rig.compare()
        rig.do(what, rng)
    for _ in range(3):
        rig.compare()


def test_each_change_while_the_cameras_stand():
    rig, rng = Rig(), np.random.default_rng(1)
    for what in (
        "move",
        "hide",
        "color",
        "switch",
        "reset",
        "add",
        "remove",
        "state",
        "expose",
        "turn",
        "lens",
        "blur",
    ):
        for _ in range(3):
            rig.compare()
        rig.do(what, rng)
        rig.compare()


@pytest.mark.parametrize("place", [0.0, 40.0])
def test_a_shadow_moves_without_what_casts_it(place):
    """The box is above the camera, in the finer of two shadow maps, or beyond it."""
    rig = Rig()
    for requests in rig.requests:
        del requests[1:]
        requests[0].obj = Tripod((0.0, place - 0.5, 4.0), (0.0, place, 0.0))
    high = rig.studio.world.game_object("High")
    high.set_pose((0.2, place, 6.0), high.world_pose()[1])
    for _ in range(3):
        (before,) = rig.compare()
    high.set_pose((0.2, place + 0.4, 6.0), high.world_pose()[1])
    (after,) = rig.compare()
    np.testing.assert_array_equal(before.ids, after.ids)
    assert 10 < (before.rgba != after.rgba).any(axis=2).sum() < before.ids.size / 2
    # changes of the coarse map are counted in larger blocks
    assert 0 < rig.studio.renderer.drawn_tiles <= (12 if place else 8)


def test_images_are_not_shared():
    rig = Rig()
    for _ in range(4):
        kept = [picture.rgba.copy() for picture in rig.compare() if picture.rgba is not None]
    shown = [picture.rgba for picture in rig.compare() if picture.rgba is not None]
    for one, other in zip(shown, kept, strict=True):
        np.testing.assert_array_equal(one, other)
        one[:] = 7
    rig.studio.world.game_object("Low").set_pose((0.5, 0.5, 0.2), (1, 0, 0, 0, 1, 0, 0, 0, 1))
    rig.compare()
    assert all((one == 7).all() for one in shown)


def test_what_is_kept_goes_with_the_camera():
    studio = world()
    request = studio.renderer.request(DOWN, LENS)
    for _ in range(3):
        studio.renderer.serve([request])
    kept = weakref.ref(request.memory)
    assert kept() is not None
    del request
    gc.collect()
    assert kept() is None
