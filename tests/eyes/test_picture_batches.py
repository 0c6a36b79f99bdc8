"""Pictures of a batch are those of a single renderer: of any number of states, in any order, from any cameras."""

import mujoco
import numpy as np
import pytest

import morse
from morse.eyes.batch import BatchRenderer
from morse.kernel.drawing.arrays import CAMERA, bytes_of_cameras
from morse.kernel.drawing.worlds import Worlds

#: mirrors, a sky with haze, shadows of both kinds of lights, translucent geoms; one camera follows the ball
XML = """<mujoco><asset><texture type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 0" width="64" height="384"/>
<texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".1 .2 .3" width="64" height="64"/>
<material name="floor" texture="grid" texrepeat="3 3" reflectance=".3"/><material name="red" rgba=".8 .2 .1 1"/></asset>
<worldbody><light name="sun" directional="true" pos="0 0 5" dir=".3 .2 -1" diffuse=".4 .4 .4"/>
<light name="spot" pos="1 -1 4" dir="-.2 .2 -1" diffuse=".5 .5 .5" cutoff="40"/>
<geom type="plane" size="{size}" material="floor"/>
<geom type="box" size=".2 .1 .6" pos="-.9 .8 .6" rgba=".4 .6 .4 1"/>
<body pos="0 0 .5"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
<joint type="slide" axis="0 0 1"/><geom type="sphere" size=".2" material="red"/>
<camera name="rider" mode="trackcom" pos="0 -2 1" xyaxes="1 0 0 0 .4 1"/></body>
<body pos=".7 .2 .3"><joint axis="0 1 0"/><geom type="capsule" size=".07 .3"/></body>
<body pos=".2 .6 .4"><joint axis="1 0 0"/><geom type="box" size=".1 .1 .3" rgba=".2 .3 .9 .4"/></body>
<camera name="front" pos="0 -3 1.6" xyaxes="1 0 0 0 .4 1"/><camera name="below" pos="0 -2 -1" xyaxes="1 0 0 0 -.4 1"/>
<camera name="map" pos="0 0 5" projection="orthographic" fovy="4"/></worldbody></mujoco>"""
#: cameras of the model, a list, and the free camera
CAMERAS = ["front", "rider", ["front", "rider", "below"], [-1, "map"]]
SIZE = 70, 90


def states_of(model, count, seed):
    states, rng = [], np.random.default_rng(seed)
    for _ in range(count):
        data = mujoco.MjData(model)
        data.qpos[:] = rng.uniform(-0.5, 0.5, model.nq)
        mujoco.mj_forward(model, data)
        states.append(data)
    return states


def single(model, data, camera, kind, look="classic"):
    """The picture of a new renderer."""
    with morse.Renderer(model, *SIZE, look=look) as renderer:
        renderer.update_scene(data, camera)
        renderer.show(kind)
        return renderer.render()


def compare(batch, model, states, cameras, kind, look="classic"):
    pictures = batch.render(states, cameras, kind=kind)
    several = cameras if isinstance(cameras, list) else [cameras]
    for row, data in enumerate(states):
        own = pictures[row] if isinstance(cameras, list) else pictures[row][None]
        for picture, camera in zip(own, several, strict=True):
            np.testing.assert_array_equal(picture, single(model, data, camera, kind, look), f"{row}, {camera}")


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("kind", ["rgb", "depth", "ids"])
@pytest.mark.parametrize("floor", ["0 0 .1", "3 3 .1"])
def test_all_kinds_and_cameras(count, kind, floor):
    model = mujoco.MjModel.from_xml_string(XML.format(size=floor))
    with morse.Renderer.batch(model, count, *SIZE) as batch:
        for seed, cameras in enumerate(CAMERAS):
            compare(batch, model, states_of(model, count, seed), cameras, kind)


def test_shadows_may_be_seen_in_some_states_only():
    # a ball above or below six lights at three heights, of which four can have shadow maps
    lights = "".join(
        f'<light pos="{0.3 * n - 0.8} 0 {1 + n % 3}" dir=".1 0 -1" directional="true" diffuse=".5 .5 .5"/>'
        for n in range(6)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody>{lights}<camera name="c" pos="0 -2 2" xyaxes="1 0 0 0 1 1"/><geom type="plane" '
        'size="2 2 .1" rgba=".3 .2 .1 1"/><body><freejoint/><geom size=".15"/></body></worldbody></mujoco>'
    )
    states = []
    for height in (9.0, 0.5, 1.5, 2.5):
        data = mujoco.MjData(model)
        data.qpos[2] = height
        mujoco.mj_forward(model, data)
        states.append(data)
    with morse.Renderer.batch(model, 4, *SIZE) as batch:
        for order in (states, states[::-1], states[1:] + states[:1]):
            compare(batch, model, order, "c", "rgb")


def test_what_was_drawn_before_has_no_effect():
    model, rng = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1")), np.random.default_rng(2)
    states = states_of(model, 4, 1)
    with morse.Renderer.batch(model, 4, *SIZE) as batch:
        for turn in range(8):
            # standing states, others in another order, and another camera
            if turn % 3 == 2:
                states = [states[n] for n in rng.permutation(4)]
            elif turn % 3 == 1:
                states[int(rng.integers(4))] = states_of(model, 1, turn)[0]
            compare(batch, model, states, "front" if turn % 5 else "rider", ("rgb", "rgb", "depth")[turn % 3])


def test_scenes_that_differ_are_drawn_each_with_its_own_geoms():
    # the camera is above the floor in one state and below it in another, and a state has the geoms of contacts
    model = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1"))
    states = states_of(model, 4, 3)
    states[1].qpos[2] = -3.0
    states[2].qpos[2] = -0.35
    for data in states[1:3]:
        mujoco.mj_forward(model, data)
    option = mujoco.MjvOption()
    option.flags[mujoco.mjtVisFlag.mjVIS_CONTACTPOINT] = 1
    with morse.Renderer.batch(model, 4, *SIZE) as batch, morse.Renderer(model, *SIZE) as renderer:
        pictures = batch.render(states, "rider", option)
        for data, picture in zip(states, pictures, strict=True):
            renderer.update_scene(data, "rider", option)
            np.testing.assert_array_equal(picture, renderer.render())


def test_the_look_of_scenes():
    model = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1"))
    with morse.Renderer.batch(model, 3, *SIZE, look="morse") as batch:
        compare(batch, model, states_of(model, 3, 5), "front", "rgb", "morse")


def test_numbers_that_are_not_finite_make_the_same_pictures():
    model = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1"))
    states = states_of(model, 3, 6)
    states[1].geom_xpos[2] = np.nan
    states[2].geom_xpos[3] = 1e30
    with morse.Renderer.batch(model, 3, *SIZE) as batch:
        for kind in ("rgb", "depth", "ids"):
            compare(batch, model, states, "front", kind)


def test_pictures_that_need_much_memory_are_drawn_in_parts(monkeypatch):
    model = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1"))
    states, calls, draw = states_of(model, 5, 7), [], BatchRenderer._draw
    monkeypatch.setattr("morse.eyes.batch._MOST_MEMORY", 0)
    monkeypatch.setattr(BatchRenderer, "_draw", lambda self, *given: calls.append(len(given[0])) or draw(self, *given))
    with morse.Renderer.batch(model, 5, *SIZE) as batch:
        compare(batch, model, states, "front", "rgb")
    assert sum(calls) == 5
    assert len(calls) > 1


def test_what_stands_is_drawn_once(monkeypatch):
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><light pos="0 0 4" dir="0 0 -1"/><geom type="plane" size="0 0 .1"/><body pos=".7 .2 .5">
        <joint type="slide" axis="0 0 1"/><geom type="sphere" size=".1"/></body>
        <camera name="front" pos="0 -3 1.6" xyaxes="1 0 0 0 .4 1"/></worldbody></mujoco>"""
    )
    drawn, draw = [], Worlds.draw

    def counted(self, chains):
        draw(self, chains)
        if self.rows["kind"][0] == 0:
            drawn.append(self.rows["frame"]["drawn_count"].copy())

    monkeypatch.setattr(Worlds, "draw", counted)
    states = np.linspace(0.0, 0.2, 12)[:, None]
    with morse.Renderer.batch(model, 12, 160, 224) as batch:
        batch.render(states, "front")
        batch.render(states, "front")
    # of 5 x 7 tiles, after the first picture of each thread
    assert np.median(drawn[0]) < 12
    assert np.median(drawn[1]) < 12


def test_cameras_are_compared_by_their_numbers():
    rows = np.frombuffer(bytes(2 * CAMERA.itemsize), CAMERA).copy()
    used = np.zeros(CAMERA.itemsize, bool)
    for form, first in CAMERA.fields.values():
        used[first : first + form.itemsize] = True
    assert not used.all()
    rows.view(np.uint8).reshape(2, -1)[1, ~used] = 7
    assert (bytes_of_cameras(rows)[0] == bytes_of_cameras(rows)[1]).all()
    rows["eye"][1, 2] = 1.0
    assert not (bytes_of_cameras(rows)[0] == bytes_of_cameras(rows)[1]).all()


def test_a_batch_that_is_closed_while_a_thread_waits_for_it_says_so(monkeypatch):
    model = mujoco.MjModel.from_xml_string(XML.format(size="0 0 .1"))
    batch, states = morse.Renderer.batch(model, 2, *SIZE), states_of(model, 2, 8)
    free = batch._lock

    class Waits:
        """The lock, which another thread has while it closes the batch."""

        def __enter__(self):
            batch._lock = free
            batch.close()

        def __exit__(self, *_):
            pass

    monkeypatch.setattr(batch, "_lock", Waits())
    with pytest.raises(RuntimeError, match="after close"):
        batch.render(states, "front")
