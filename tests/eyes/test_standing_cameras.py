"""Pictures of a camera that stands are those of a new renderer, whatever has moved since the last one."""

import mujoco
import numpy as np
import pytest

import morse
from morse.eyes import picture

#: a mirror, a sky, shadows of both kinds of lights, textures, a translucent geom, and a tendon
XML = """<mujoco><asset><texture type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 0" width="64" height="384"/>
<texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".1 .2 .3" width="64" height="64"/>
<material name="floor" texture="grid" texrepeat="3 3" reflectance=".3"/><material name="red" rgba=".8 .2 .1 1"/></asset>
<worldbody><light name="sun" directional="true" pos="0 0 5" dir=".3 .2 -1" diffuse=".4 .4 .4"/>
<light name="spot" pos="1 -1 4" dir="-.2 .2 -1" diffuse=".5 .5 .5" cutoff="40"/>
<geom name="floor" type="plane" size="0 0 .1" material="floor"/>
<geom type="box" size=".2 .1 .6" pos="-.9 .8 .6" rgba=".4 .6 .4 1"/><site name="nail" pos=".8 .9 1.2"/>
<body name="ball" mocap="true" pos="0 0 .5"><geom type="sphere" size=".2" material="red"/><site name="eye"/></body>
<body name="bar" mocap="true" pos=".7 .2 .3"><geom name="bar" type="capsule" size=".07 .3"/></body>
<body name="glass" mocap="true" pos=".2 .6 .4"><geom type="box" size=".1 .1 .3" rgba=".2 .3 .9 .4"/></body>
<camera name="front" pos="0 -3 1.6" xyaxes="1 0 0 0 .4 1"/>
<camera name="side" pos="3 0 1" xyaxes="0 1 0 -.2 0 1" projection="orthographic" fovy="3"/>
</worldbody><tendon><spatial width=".02"><site site="nail"/><site site="eye"/></spatial></tendon></mujoco>"""
SIZE = 150, 200
KINDS = "rgb", "depth", "ids"


def draw(renderer, data, camera):
    renderer.update_scene(data, camera)
    pictures = []
    for kind in KINDS:
        renderer.show(kind)
        pictures.append(renderer.render())
    return pictures


def changes(model, rng):
    """Names of changes, and what makes them in a state."""
    return {
        "nothing": lambda data: None,
        "step": lambda data: data.mocap_pos.__setitem__(0, data.mocap_pos[0] + rng.normal(size=3) * 0.02),
        "turn": lambda data: data.mocap_quat.__setitem__(1, rng.normal(size=4)),
        "jump": lambda data: data.mocap_pos.__setitem__(int(rng.integers(3)), rng.uniform((-1, -1, 0.1), (1, 1, 1.5))),
        "away": lambda data: data.mocap_pos.__setitem__(1, (0, 0, 50)),
        "light": lambda data: model.light_dir.__setitem__(0, (*rng.uniform(-0.5, 0.5, 2), -1)),
        "lamp": lambda data: model.light_pos.__setitem__(1, (*rng.uniform(-1, 1, 2), 4)),
        "dark": lambda data: model.light_castshadow.__setitem__(1, not model.light_castshadow[1]),
        "colour": lambda data: model.geom_rgba.__setitem__(2, (*rng.uniform(0, 1, 3), 1)),
        "texture": lambda data: model.mat_texrepeat.__setitem__(0, rng.uniform(1, 4, 2)),
        "haze": lambda data: model.vis.rgba.haze.__setitem__(0, rng.uniform()),
    }


@pytest.mark.parametrize("look", ["classic", "morse"])
def test_pictures_after_changes_are_those_of_a_new_renderer(look):
    model = mujoco.MjModel.from_xml_string(XML)
    data, rng = mujoco.MjData(model), np.random.default_rng(5)
    change_of = changes(model, rng)
    # most pictures are those of a scene in which something small has moved
    names = [*change_of, *["step", "step", "turn"] * len(change_of)]
    renderer = morse.Renderer(model, *SIZE, look=look)
    camera = "front"
    for number, name in enumerate(rng.permutation(names)):
        change_of[name](data)
        if number % 12 == 11:
            camera = "side" if camera == "front" else "front"
        mujoco.mj_forward(model, data)
        with morse.Renderer(model, *SIZE, look=look) as other:
            pairs = zip(KINDS, draw(renderer, data, camera), draw(other, data, camera), strict=True)
            for kind, got, expected in pairs:
                np.testing.assert_array_equal(got, expected, f"{number}: {kind} after {name}")


@pytest.mark.parametrize("light", ['directional="true" pos="0 0 5" dir=".3 .2 -1"', 'pos="0 0 4" dir="0 0 -1"'])
def test_only_what_moves_and_its_shadow_are_drawn_again(light):
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><worldbody><light {light}/><geom type="plane" size="0 0 .1"/><body name="bar" mocap="true">
        <geom type="capsule" size=".07 .3"/></body><camera name="front" pos="0 -3 1.6" xyaxes="1 0 0 0 .4 1"/>
        </worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    renderer = morse.Renderer(model, *SIZE)
    drawn = []
    for step in range(5):
        data.mocap_pos[0] = 0.7, 0.2, 0.5 + 0.01 * (step < 4)
        mujoco.mj_forward(model, data)
        renderer.update_scene(data, "front")
        renderer.render()
        drawn.append(renderer._artist._drawer.drawn_tiles)
    # two pictures in which the camera stands come first
    assert drawn[:2] == [5 * 7, 5 * 7]
    assert drawn[3] == 0
    assert 0 < drawn[4] < 24


def test_tendons_that_change_their_lengths_are_drawn_with_the_same_shapes(monkeypatch):
    model = mujoco.MjModel.from_xml_string(XML)
    data = mujoco.MjData(model)
    renderer = morse.Renderer(model, *SIZE)
    mujoco.mj_forward(model, data)
    draw(renderer, data, "front")
    monkeypatch.setattr(picture, "instances_of", None)
    data.mocap_pos[0] = -0.3, 0.1, 0.8
    mujoco.mj_forward(model, data)
    ids = draw(renderer, data, "front")[2]
    columns = np.nonzero((ids == (0, mujoco.mjtObj.mjOBJ_TENDON)).all(axis=2))[1]
    # the nail and the border of the ball, from (0, -3, 1.6) with a focal length of 75 / tan(22.5 degrees) = 181 pixels:
    # their depths are 3.77 and 3.17 m
    assert columns.max() == pytest.approx(100 + 181 * 0.8 / 3.77, abs=2)
    assert 100 - 181 * 0.3 / 3.17 < columns.min() < 100 - 181 * (0.3 - 0.2) / 3.17 + 2
