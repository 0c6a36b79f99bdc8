"""Pictures of models of MuJoCo: geometry, colours by the equations of OpenGL, and errors."""

from __future__ import annotations

import copy
import hashlib
import os
import pickle
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
import pytest

import morse
from morse.eyes import shadows
from morse.eyes.geoms import GeomArray, _with_textures
from morse.eyes.light import ShadowMaps
from morse.eyes.renderer import three_geoms
from morse.kernel.drawing.native import NativeDrawer

if TYPE_CHECKING:
    from collections.abc import Callable

#: a camera 2 m above the origin, which looks down
_ABOVE = '<camera name="above" pos="0 0 2" fovy="45"/>'
_DARK = '<headlight ambient="0 0 0" diffuse="0 0 0" specular="0 0 0"/>'


def _world(body: str, visual: str = "", asset: str = "") -> str:
    return (
        f'<mujoco><statistic extent="2" center="0 0 0"/><visual>{visual}</visual><asset>{asset}</asset>'
        f"<worldbody>{_ABOVE}{body}</worldbody></mujoco>"
    )


def _picture(
    xml: str,
    *,
    mode: str = "color",
    size: int = 65,
    camera: int | str | mujoco.MjvCamera = 0,
    prepare: Callable[[Any], None] = lambda renderer: None,
    option: mujoco.MjvOption | None = None,
    look: str = "classic",
) -> Any:
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, size, size, look=look) as renderer:
        if mode == "depth":
            renderer.enable_depth_rendering()
        if mode == "ids":
            renderer.enable_segmentation_rendering()
        renderer.update_scene(data, camera, option)
        prepare(renderer)
        picture = renderer.render()
        return picture.astype(int) if mode == "color" else picture


# -- geometry ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("geom", "height"),
    [
        ('type="sphere" size=".3"', 0.3),
        ('type="capsule" size=".1 .3"', 0.4),
        ('type="ellipsoid" size=".2 .3 .25"', 0.25),
        ('type="cylinder" size=".2 .15"', 0.15),
        ('type="box" size=".2 .3 .35"', 0.35),
        ('type="plane" size="0 0 1"', 0.0),
        ('type="plane" size="1 1 1"', 0.0),
        ('type="mesh" mesh="m"', 0.5),
        ('type="hfield" hfield="h"', 0.45),
    ],
)
def test_depth_of_the_highest_point_is_its_distance(geom: str, height: float) -> None:
    asset = (
        '<mesh name="m" vertex="-.5 -.5 -.5 .5 -.5 -.5 .5 .5 -.5 -.5 .5 -.5 '
        '-.5 -.5 .5 .5 -.5 .5 .5 .5 .5 -.5 .5 .5"/>'
        '<hfield name="h" nrow="3" ncol="3" size="1 1 .45 .1" elevation="0 0 0 0 1 0 0 0 0"/>'
    )
    xml = _world(f'<geom {geom} pos="0 0 0"/>', asset=asset)
    assert _picture(xml, mode="depth")[32, 32] == pytest.approx(2.0 - height, abs=1e-3)
    ids = _picture(xml, mode="ids")
    assert ids[32, 32].tolist() == [0, mujoco.mjtObj.mjOBJ_GEOM]


def test_triangles_of_height_fields_are_flat() -> None:
    # two slopes that meet in the middle column, lit along Z
    asset = '<hfield name="h" nrow="2" ncol="3" size="1 1 1 .1" elevation="0 1 0 0 1 0"/>'
    visual = '<headlight ambient="0 0 0" diffuse="1 1 1" specular="0 0 0"/>'
    picture = _picture(_world('<geom type="hfield" hfield="h" rgba="1 1 1 1"/>', visual, asset), size=64)
    # their normals have the same angle to the light
    assert picture[32] == pytest.approx(np.full((64, 3), 255 / np.sqrt(2)), abs=2)


def test_background_is_at_the_far_plane_and_has_no_object() -> None:
    xml = _world('<geom type="sphere" size=".1"/>')
    model = mujoco.MjModel.from_xml_string(xml)
    assert _picture(xml, mode="depth")[0, 0] == pytest.approx(model.vis.map.zfar * 2.0)
    assert _picture(xml, mode="ids")[0, 0].tolist() == [-1, -1]


def test_edges_are_where_the_pinhole_puts_them() -> None:
    ids = _picture(_world('<geom type="box" size=".2 .1 .1" pos="0 0 -.1"/>'), mode="ids", size=200)
    focal = 100 / np.tan(np.radians(22.5))
    columns, rows = np.flatnonzero((ids[..., 0] == 0).any(axis=0)), np.flatnonzero((ids[..., 0] == 0).any(axis=1))
    assert len(columns) == pytest.approx(2 * focal * 0.2 / 2.0, abs=1.01)
    assert len(rows) == pytest.approx(2 * focal * 0.1 / 2.0, abs=1.01)


def test_sensors_of_cameras_fill_pictures_of_any_shape() -> None:
    sensor = 'resolution="640 480" focal=".01 .01" sensorsize=".012 .009" principal=".001 .0005"'
    camera = f'<camera name="i" pos="0 -3 0" xyaxes="1 0 0 0 0 1" {sensor}/>'
    ids = _picture(_world(camera + '<geom type="sphere" size=".3"/>'), mode="ids", camera="i", size=200)
    columns, rows = (np.flatnonzero((ids[..., 0] == 0).any(axis=axis)) for axis in (0, 1))
    # a sphere at 3 m, of the angle whose sine is 0.1, on 12 x 9 mm behind a focal length of 10 mm
    wide = 2 * 0.01 * np.tan(np.arcsin(0.1))
    assert len(columns) == pytest.approx(200 * wide / 0.012, abs=1.5)
    assert len(rows) == pytest.approx(200 * wide / 0.009, abs=1.5)


def test_orthographic_cameras_show_sizes_independent_of_the_distance() -> None:
    camera = '<camera name="o" pos="0 0 2" projection="orthographic" fovy="2"/>'
    for z in (0.0, 1.0):
        xml = _world(camera + f'<geom type="box" size=".25 .25 .05" pos="0 0 {z}"/>')
        assert (_picture(xml, mode="ids", camera="o", size=200)[100, :, 0] == 0).sum() == pytest.approx(50, abs=1)
        assert _picture(xml, mode="depth", camera="o")[32, 32] == pytest.approx(1.95 - z, abs=2e-3)


@pytest.mark.parametrize("slope", [0.02, 0.2, 1.0])
def test_depths_of_orthographic_cameras_are_those_of_parallel_rays(slope: float) -> None:
    camera = f'<camera name="o" pos="0 0 .5" xyaxes="1 0 0 0 {slope} 1" projection="orthographic" fovy=".6"/>'
    xml = _world(camera + '<geom type="plane" size="20 200 1"/>', visual='<map znear=".01" zfar="50"/>')
    depth = _picture(xml, mode="depth", camera="o")
    # the camera looks along (0, 1, -slope): a ray that begins higher meets the floor later
    length = np.hypot(1.0, slope)
    height = 0.5 + (32 - np.arange(65)) * 0.6 / 65 / length
    assert depth == pytest.approx(np.tile((height * length / slope)[:, None], 65), rel=2e-5, abs=1e-4)


@pytest.mark.parametrize("distance", [0.5, 5.0, 50.0])
def test_orthographic_cameras_show_solids_at_exact_places_at_any_distance(distance: float) -> None:
    camera = f'<camera name="o" pos="0 0 {distance}" projection="orthographic" fovy="2"/>'
    xml = _world(camera + '<geom type="box" size=".253 .153 .05" pos=".5 -.25 0"/>', visual='<map zfar="100"/>')
    ids = _picture(xml, mode="ids", camera="o", size=200)[..., 0] == 0
    columns, rows = (np.flatnonzero(ids.any(axis=axis)) for axis in (0, 1))
    # pixels of 10 mm, whose centres are at their halves
    assert (columns[0], columns[-1]) == (125, 174)
    assert (rows[0], rows[-1]) == (110, 139)


@pytest.mark.parametrize("look", ["classic", "morse"])
def test_only_what_is_between_the_planes_of_an_orthographic_camera_is_drawn(look: str) -> None:
    camera = '<camera name="o" pos="0 0 2" projection="orthographic" fovy="2"/>'
    # the near plane is at 1 m, the far plane at 3 m
    visual = '<map znear=".5" zfar="1.5"/>'
    for z, seen in ((1.2, False), (0.9, True), (-0.9, True), (-1.2, False)):
        xml = _world(camera + f'<geom type="box" size=".25 .25 .01" pos="0 0 {z}"/>', visual)
        assert (_picture(xml, mode="ids", camera="o", look=look)[32, 32, 0] == 0) == seen
        picture = _picture(xml, camera="o", look=look)
        assert (picture[32, 32] != picture[0, 0]).any() == seen


def test_the_last_of_surfaces_at_the_same_place_is_seen() -> None:
    box = '<geom type="box" size=".2 .2 .2" rgba="1 0 0 1"/><geom type="box" size=".2 .2 .2" rgba="0 1 0 1"/>'
    assert _picture(_world(box), mode="ids")[32, 32, 0] == 1


def test_groups_that_are_not_shown_are_not_drawn() -> None:
    option = mujoco.MjvOption()
    option.geomgroup[2] = 0
    xml = _world('<geom type="box" size=".2 .2 .2" group="2"/>')
    assert _picture(xml, mode="ids")[32, 32, 0] == 0
    assert _picture(xml, mode="ids", option=option)[32, 32, 0] == -1


def test_geoms_that_are_appended_to_the_scene_are_drawn() -> None:
    def add(renderer: morse.Renderer) -> None:
        scene = renderer.scene
        mujoco.mjv_initGeom(
            scene.geoms[scene.ngeom],
            mujoco.mjtGeom.mjGEOM_SPHERE,
            np.array([0.5, 0, 0]),
            np.zeros(3),
            np.eye(3).ravel(),
            np.array([1, 0, 0, 1], np.float32),
        )
        scene.ngeom += 1

    xml = _world("", visual='<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>')
    assert _picture(xml, prepare=add)[32, 32].tolist() == [255, 0, 0]


def _lines(count: int, opacity: float, shadows: bool = True) -> Callable[[morse.Renderer], None]:
    """Adds lines of 9 pixels along X, all at the same place, 1 m above the origin."""

    def add(renderer: morse.Renderer) -> None:
        scene = renderer.scene
        scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        color = np.array([1, 1, 1, opacity], np.float32)
        for _ in range(count):
            geom = scene.geoms[scene.ngeom]
            ends = np.array([-0.3, 0, 1.0]), np.array([0.3, 0, 1.0])
            mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_LINE, np.zeros(3), np.zeros(3), np.zeros(9), color)
            mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_LINE, 9, *ends)
            scene.ngeom += 1

    return add


@pytest.mark.parametrize("count", [1, 3, 20])
def test_lines_that_overlap_add_up(count: int) -> None:
    bright = _world("", visual='<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>')
    code = _picture(bright, prepare=_lines(count, 0.05))[32, 32]
    # translucent surfaces are drawn twice
    assert code.tolist() == pytest.approx([255 * (1 - 0.95 ** (2 * count))] * 3, abs=2)


def test_lines_cast_no_shadows() -> None:
    light = '<light pos="0 -1 3" dir="0 .5 -1" directional="true"/><geom type="plane" size="2 2 .1"/>'
    shown = [_picture(_world(light), prepare=_lines(1, 1.0, shadows)) for shadows in (True, False)]
    # with shadows, light is rounded in two parts; a shadow is 81 codes darker
    np.testing.assert_allclose(*shown, atol=4)


def test_skins_and_flexes_follow_their_bodies() -> None:
    flex = (
        '<flexcomp name="cloth" type="grid" count="5 5 1" spacing=".1 .1 .1" radius=".01" dim="2" mass="1" '
        'pos="0 0 .5"/>'
    )
    model = mujoco.MjModel.from_xml_string(_world(flex))
    data = mujoco.MjData(model)
    depths = []
    with morse.Renderer(model, 65, 65) as renderer:
        renderer.enable_depth_rendering()
        for shift in (0.0, -0.25):
            data.qpos[2::3] = shift
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, 0)
            depths.append(float(renderer.render()[32, 32]))
    # the surface is a radius above the vertices
    assert depths == pytest.approx([1.49, 1.74], abs=1e-3)


# -- colours: I = emission + attenuation * spot * (ambient + max(n l, 0) diffuse + (n h)^s specular), of OpenGL 1.5 ----

_PLANE = '<geom type="plane" size="1 1 1" material="m"/>'


@pytest.mark.parametrize(
    ("head", "material", "code"),
    [
        ('ambient=".4 .4 .4" diffuse="0 0 0" specular="0 0 0"', 'rgba=".5 1 .25 1"', (51, 102, 26)),
        ('ambient="0 0 0" diffuse=".6 .6 .6" specular="0 0 0"', 'rgba=".5 .5 .5 1"', (77, 77, 77)),
        ('ambient="0 0 0" diffuse="0 0 0" specular="1 1 1"', 'rgba="0 0 0 1" specular=".4"', (102, 102, 102)),
        ('ambient="0 0 0" diffuse="0 0 0" specular="0 0 0"', 'rgba=".5 1 0 1" emission=".3"', (38, 77, 0)),
        ('ambient="1 1 1" diffuse="1 1 1" specular="0 0 0"', 'rgba=".8 .2 .5 1"', (255, 102, 255)),
    ],
)
def test_light_follows_the_equations_of_opengl(head: str, material: str, code: tuple[int, int, int]) -> None:
    xml = _world(_PLANE, visual=f"<headlight {head}/>", asset=f'<material name="m" {material}/>')
    assert _picture(xml)[32, 32] == pytest.approx(code, abs=1)


def test_point_lights_become_weaker_with_the_distance_and_have_a_cone() -> None:
    light = '<light pos="0 0 1" dir="0 0 -1" cutoff="30" exponent="0" attenuation="1 1 2" diffuse="1 1 1" {}/>'
    floor = '<geom type="plane" size="2 2 .02" rgba="1 1 1 1"/>'
    picture = _picture(_world(light.format('castshadow="false" specular="0 0 0"') + floor, visual=_DARK), size=201)
    assert picture[100, 100, 0] == pytest.approx(255 / 4, abs=1)
    radius = (picture[100, :, 0] > 0).sum() / 2
    assert radius == pytest.approx(100.5 / np.tan(np.radians(22.5)) * np.tan(np.radians(30)) / 2, abs=2.5)


@pytest.mark.parametrize("directional", ["true", "false"])
def test_shadows_take_the_whole_light(directional: str) -> None:
    body = (
        f'<light pos="0 0 1.5" dir="0 0 -1" directional="{directional}" diffuse=".6 .6 .6" ambient=".1 .1 .1" '
        'specular="0 0 0" exponent="0"/><geom type="plane" size="2 2 .02" rgba="1 1 1 1"/>'
        '<geom type="box" size=".2 .2 .01" pos="0 0 .6"/><camera name="side" pos="0 -.9 .35" xyaxes="1 0 0 0 .4 1"/>'
    )
    head = '<headlight ambient=".2 .2 .2" diffuse="0 0 0" specular="0 0 0"/>'
    xml = _world(body, visual=head)
    below = _picture(xml, camera="side", size=121)
    lit = _picture(xml, camera="side", size=121, prepare=lambda r: r.scene.flags.__setitem__(0, 0))
    # a place on the ground right below the box
    shaded = np.abs(below - lit).max(axis=2) > 50
    assert shaded.sum() > 100
    assert np.median(below[shaded][:, 0]) == pytest.approx(51, abs=2)


def test_translucent_surfaces_cover_twice_what_is_behind() -> None:
    body = (
        '<geom type="plane" size="2 2 1" rgba="0 0 1 1"/><geom type="box" size=".3 .3 .1" pos="0 0 .5" '
        'rgba="1 0 0 .3"/>'
    )
    xml = _world(body, visual='<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>')
    # MuJoCo draws them in two passes: 1 - 0.7 ** 2
    assert _picture(xml)[32, 32] == pytest.approx((130, 0, 125), abs=1)
    assert _picture(xml, mode="ids")[32, 32, 0] == 1


def test_reflections_are_added() -> None:
    body = (
        '<geom type="plane" size="2 2 1" material="mirror"/><geom type="box" size=".3 .3 .3" pos="0 .5 .5" '
        'rgba=".2 .8 .4 1"/><camera name="c" pos="0 -2 1" xyaxes="1 0 0 0 1 2"/>'
    )
    xml = _world(
        body,
        visual='<headlight ambient=".5 .5 .5" diffuse="0 0 0" specular="0 0 0"/>',
        asset='<material name="mirror" rgba=".5 .5 .5 1" specular="0" reflectance=".5"/>',
    )
    picture = _picture(xml, camera="c", size=201)
    assert picture[131, 100] == pytest.approx((77, 115, 89), abs=1)
    assert picture[191, 100] == pytest.approx((64, 64, 64), abs=1)


def _coloured(kind: str, size: int = 64) -> Callable[[mujoco.MjModel], None]:
    """Set the texture of a model to the columns (red) and rows (green) of its picture, blue is the face of a cube."""

    def paint(model: mujoco.MjModel) -> None:
        count = 1 if kind == "2d" else 6
        pixels = np.zeros((count, size, size, 3), np.uint8)
        pixels[..., 0] = np.arange(size) * 256 // size
        pixels[..., 1] = (np.arange(size) * 256 // size)[:, None]
        pixels[..., 2] = 20 + 40 * np.arange(count)[:, None, None]
        model.tex_data[: pixels.size] = pixels.ravel()

    return paint


def _textured(geom: str, kind: str, camera: str, material: str = "", size: int = 64) -> Any:
    places = {"front": ("0 -2 0", "1 0 0 0 0 1"), "right": ("2 0 0", "0 1 0 0 0 1")}
    cameras = "".join(f'<camera name="{name}" pos="{pos}" xyaxes="{axes}"/>' for name, (pos, axes) in places.items())
    height = size if kind == "2d" else 6 * size
    xml = _world(
        cameras + (f'<geom {geom} material="m"/>' if geom else ""),
        visual='<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>',
        asset=f'<texture name="t" type="{kind}" builtin="flat" rgb1="1 1 1" width="{size}" height="{height}"/>'
        f'<material name="m" texture="t" {material}/>',
    )
    model = mujoco.MjModel.from_xml_string(xml)
    _coloured(kind, size)(model)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 101, 101) as renderer:
        renderer.update_scene(data, camera)
        return renderer.render().astype(int)


@pytest.mark.parametrize(
    ("geom", "kind", "camera", "material", "place", "expected"),
    [
        # the middle of the upper left quarter of a face: a quarter of the columns and of the rows
        ('type="plane" size=".4 .4 1"', "2d", "above", "", (-0.2, 0.2), (64, 64)),
        ('type="plane" size=".4 .4 1"', "2d", "above", 'texrepeat="3 1"', (-0.2, 0.2), (192, 64)),
        ('type="plane" size=".4 .4 1"', "2d", "above", 'texuniform="true"', (-0.2, 0.2), (26, 26)),
        # infinite planes begin in the middle of the texture, which is 2 m wide
        ('type="plane" size="0 0 1"', "2d", "above", "", (-0.2, 0.2), (102, 102)),
        ('type="box" size=".4 .4 .0001"', "2d", "above", "", (-0.2, 0.2), (64, 64)),
        ('type="cylinder" size=".4 .0001"', "2d", "above", "", (-0.2, 0.2), (64, 192)),
        ('type="sphere" size=".4"', "2d", "front", "", (0.0, 0.0), (192, 128)),
        # faces of a cube as OpenGL has them
        ('type="box" size=".4 .4 .0001"', "cube", "above", "", (-0.2, 0.2), (64, 64, 180)),
        ('type="box" size=".4 .0001 .4"', "cube", "front", "", (-0.2, 0.2), (64, 64, 140)),
        ('type="box" size=".0001 .4 .4"', "cube", "right", "", (-0.2, 0.2), (64, 192, 20)),
        ("", "skybox", "above", "", (0.0, 0.0), (128, 128, 140)),
        ("", "skybox", "front", "", (0.0, 0.0), (128, 128, 220)),
    ],
)
def test_texture_coordinates(
    geom: str, kind: str, camera: str, material: str, place: tuple[float, float], expected: tuple[int, ...]
) -> None:
    picture = _textured(geom, kind, camera, material)
    focal = 50.5 / np.tan(np.radians(22.5))
    column, row = 50 + focal * place[0] / 2, 50 - focal * place[1] / 2
    assert picture[round(row), round(column)][: len(expected)] == pytest.approx(expected, abs=8)


@pytest.mark.parametrize(
    ("centred", "material", "expected"),
    [
        # a plane 0.8 m wide, a quarter of which is 0.2 m from its middle: with 1.5 textures, 0.375 of one from that of
        # the texture, or from a corner
        (True, 'texrepeat="1.5 1.5"', (32, 32)),
        (False, 'texrepeat="1.5 1.5"', (96, 96)),
        (True, 'texrepeat="2 1" texuniform="true"', (77, 102)),
        (False, 'texrepeat="2 1" texuniform="true"', (51, 26)),
    ],
)
def test_textures_of_planes_are_where_the_version_of_mujoco_has_them(
    centred: bool, material: str, expected: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.eyes.geoms._TEXTURES_ARE_CENTRED", centred)
    picture = _textured('type="plane" size=".4 .4 1"', "2d", "above", material)
    offset = round(0.1 * 50.5 / np.tan(np.radians(22.5)))
    colour = picture[50 - offset, 50 - offset][:2]
    assert colour == pytest.approx(expected, abs=8)


@pytest.mark.parametrize(
    ("centred", "size", "material", "expected"),
    [
        # 0.2 m from the middle along both axes, which is a quarter of a plane 0.8 m wide. Along the axis without an
        # end, the middle of a texture is there, and a texture is 2 m wide: 0.4 of one. Along the other axis, the middle
        # of a texture is in the middle or at the edge: a quarter of the repetitions less or more than 0.5
        (True, ".4 0 1", "", (64, 102)),
        (False, ".4 0 1", "", (192, 102)),
        (True, "0 .4 1", 'texrepeat="1 .6"', (102, 90)),
        (False, "0 .4 1", 'texrepeat="1 .6"', (102, 166)),
        (True, ".4 0 1", 'texrepeat="1.5 1" texuniform="true"', (90, 102)),
        (False, ".4 0 1", 'texrepeat="1.5 1" texuniform="true"', (166, 102)),
    ],
)
def test_textures_of_planes_without_an_end_along_one_axis(
    centred: bool, size: str, material: str, expected: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.eyes.geoms._TEXTURES_ARE_CENTRED", centred)
    picture = _textured(f'type="plane" size="{size}"', "2d", "above", material)
    offset = round(0.1 * 50.5 / np.tan(np.radians(22.5)))
    colour = picture[50 - offset, 50 - offset][:2]
    assert colour == pytest.approx(expected, abs=8)


@pytest.mark.parametrize(
    ("geom", "camera", "material", "place", "expected"),
    [
        # half of an extent to the left, and in front: a quarter of a texture, and half of it repeated half a time
        ('type="box" size=".4 .0001 .4"', "front", 'texrepeat="1 .5"', (-0.2, 0.2), (64, 192)),
        ('type="box" size=".4 .0001 .4"', "front", 'texrepeat="1 .5"', (-0.2, -0.2), (64, 192)),
        ('type="box" size=".4 .0001 .4"', "front", 'texrepeat="1 .5" texuniform="true"', (-0.2, -0.2), (102, 128)),
        ('type="capsule" size=".4 .4"', "front", 'texrepeat="1 .5"', (0.0, 0.2), (128, 192)),
        ('type="cylinder" size=".4 .4"', "front", 'texrepeat="1 .5"', (0.0, -0.2), (128, 192)),
        ('type="cylinder" size=".4 .0001"', "above", "", (-0.2, 0.2), (64, 64)),
        ('type="ellipsoid" size=".4 .4 .0001"', "above", "", (-0.2, 0.2), (64, 64)),
        ('type="sphere" size=".4"', "above", "", (0.0, 0.0), (128, 128)),
    ],
)
def test_old_versions_of_mujoco_project_textures_along_z(
    geom: str,
    camera: str,
    material: str,
    place: tuple[float, float],
    expected: tuple[int, ...],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # column 0.5 + x repeat / 2 and row 0.5 - y repeat / 2, where x and y are -1 to 1, or in metres if uniform
    monkeypatch.setattr("morse.eyes.geoms._TEXTURES_ARE_CENTRED", True)
    picture = _textured(geom, "2d", camera, material)
    focal = 50.5 / np.tan(np.radians(22.5))
    column, row = 50 + focal * place[0] / 2, 50 - focal * place[1] / 2
    assert picture[round(row), round(column)][:2] == pytest.approx(expected, abs=8)


def test_textures_of_any_size_are_where_they_belong() -> None:
    same, other = (_textured('type="plane" size=".4 .4 1"', "2d", "above", size=size) for size in (128, 100))
    inside = np.s_[30:70, 30:70, :2]
    assert np.abs(same[inside] - other[inside]).max() <= 6


# -- behaviour -----------------------------------------------------------------------------

_SCENE = _world(
    '<light pos="0 0 2"/><geom type="plane" size="0 0 .1" material="m"/><body pos="0 0 .5"><freejoint/>'
    '<geom type="capsule" size=".1 .2" rgba=".8 .3 .2 1"/><geom type="sphere" size=".1" pos=".3 0 0" '
    'rgba=".2 .3 .8 .5"/></body>',
    asset='<texture name="t" type="2d" builtin="checker" rgb1="0 0 0" rgb2="1 1 1" width="32" height="32"/>'
    '<texture type="skybox" builtin="gradient" rgb1="1 1 1" rgb2="0 0 1" width="32" height="32"/>'
    '<material name="m" texture="t" texrepeat="4 4" reflectance=".2"/>',
)
_DIGEST = f"""
import hashlib, mujoco, morse
model = mujoco.MjModel.from_xml_string('''{_SCENE}''')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = morse.Renderer(model, 64, 96)
renderer.update_scene(data)
print(hashlib.sha256(renderer.render().tobytes()).hexdigest())
"""


def test_other_processes_and_numbers_of_threads_give_the_same_bits() -> None:
    digests = {
        subprocess.run(
            [sys.executable, "-c", _DIGEST],
            env={**os.environ, "MORSE_THREADS": threads},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for threads in ("1", "3")
    }
    assert len(digests) == 1


def test_many_renderers_in_threads_share_no_state() -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    shifts = [0.02 * n for n in range(20)]

    def digest(shift: float) -> str:
        data = mujoco.MjData(model)
        data.qpos[0] = shift
        mujoco.mj_forward(model, data)
        with morse.Renderer(model, 48, 64) as renderer:
            renderer.update_scene(data)
            return hashlib.sha256(renderer.render().tobytes()).hexdigest()

    alone = [digest(shift) for shift in shifts]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(digest, shifts)) == alone
    assert len(set(alone)) == len(shifts)


@pytest.mark.parametrize("camera", [0, -1])
def test_pictures_do_not_depend_on_those_before(camera: int) -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    with morse.Renderer(model, 48, 64) as used:
        for shift in (0.3, 0.1, 0.0):
            data.qpos[0] = shift
            mujoco.mj_forward(model, data)
            for other in (-1, 0, camera):
                used.update_scene(data, other)
                last = used.render()
    with morse.Renderer(model, 48, 64) as new:
        new.update_scene(data, camera)
        assert np.array_equal(new.render(), last)


def test_colours_that_are_changed_in_the_model_are_seen() -> None:
    model = mujoco.MjModel.from_xml_string(_world('<geom type="box" size=".3 .3 .3" rgba="1 0 0 1"/>'))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 33, 33) as renderer:
        renderer.update_scene(data, 0)
        assert renderer.render()[16, 16].argmax() == 0
        model.geom_rgba[0] = 0, 1, 0, 1
        renderer.update_scene(data, 0)
        assert renderer.render()[16, 16].argmax() == 1


def test_the_look_of_scenes_is_lit_and_shadowed() -> None:
    picture = _picture(_SCENE, look="morse", camera=-1, size=64)
    assert picture.std() > 10


def test_an_array_of_ones_own_is_filled() -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 24, 32) as renderer:
        renderer.update_scene(data)
        out = np.zeros((24, 32, 3))
        assert renderer.render(out=out) is out
        assert np.array_equal(out, renderer.render())
        with pytest.raises(ValueError, match=r"out\.shape"):
            renderer.render(out=np.zeros((24, 32), np.uint8))


def test_wrong_use_is_told() -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with pytest.raises(ValueError, match="framebuffer width 640"):
        morse.Renderer(model, 100, 641)
    with pytest.raises(ValueError, match="offheight"):
        morse.Renderer(model, 481, 100)
    with pytest.raises(ValueError, match="height 0"):
        morse.Renderer(model, 0, 10)
    with pytest.raises(ValueError, match="classic, morse"):
        morse.Renderer(model, 10, 10, look="cartoon")
    renderer = morse.Renderer(model, 10, 10)
    with pytest.raises(ValueError, match="Call update_scene first"):
        renderer.render()
    with pytest.raises(ValueError, match='"nowhere" does not exist'):
        renderer.update_scene(data, "nowhere")
    with pytest.raises(ValueError, match=r"out of range \[-1, 1\)"):
        renderer.update_scene(data, 1)
    renderer.close()
    renderer.close()
    with pytest.raises(RuntimeError, match="after close"):
        renderer.render()
    with pytest.raises(RuntimeError, match="after close"):
        renderer.update_scene(data)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_states_that_are_not_finite_hide_what_they_move(value: float) -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    data.geom_xpos[1:] = value
    with morse.Renderer(model, 32, 32) as renderer:
        renderer.update_scene(data, 0)
        picture = renderer.render()
        renderer.enable_segmentation_rendering()
        assert set(np.unique(renderer.render()[..., 0]).tolist()) == {0}
    assert picture.shape == (32, 32, 3)


def test_geoms_are_read_where_they_are_in_memory() -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    scene = mujoco.MjvScene(model, 50)
    camera = mujoco.MjvCamera()
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, camera, 7, scene)
    geoms = GeomArray(scene, three_geoms).now()
    assert len(geoms) == scene.ngeom == 3
    for row, geom in zip(geoms, scene.geoms[: scene.ngeom], strict=True):
        for name in row.dtype.names:
            assert np.array_equal(np.ravel(row[name]), np.ravel(getattr(geom, name))), name


def test_normals_of_meshes_count_where_they_are_nearly_those_of_triangles() -> None:
    def code(degrees: float) -> int:
        tilt = f"{np.sin(np.radians(degrees))} 0 {np.cos(np.radians(degrees))} " * 5
        asset = (
            '<mesh name="m" inertia="shell" vertex="-1 -1 0 1 -1 0 1 1 0 -1 1 0 0 0 -1" '
            'face="0 1 2 0 2 3 1 0 4 2 1 4 3 2 4 0 3 4" '
            f'normal="{tilt}"/><material name="w" rgba="1 1 1 1" specular="0"/>'
        )
        head = '<headlight ambient="0 0 0" diffuse=".8 .8 .8" specular="0 0 0"/>'
        return int(_picture(_world('<geom type="mesh" mesh="m" material="w"/>', head, asset))[32, 32, 0])

    assert code(30.0) == pytest.approx(204 * np.cos(np.radians(30.0)), abs=2)
    for against in (50.0, 120.0, 180.0):
        assert code(against) == pytest.approx(204, abs=2)


def test_geoms_of_versions_without_textures_have_those_of_their_materials() -> None:
    asset = (
        '<texture name="a" type="2d" builtin="flat" width="4" height="4"/><texture name="b" type="cube" '
        'builtin="flat" width="4" height="24"/><material name="a" texture="a" texrepeat="3 5" texuniform="true"/>'
        '<material name="b" texture="b"/><material name="c"/>'
    )
    body = "".join(f'<geom size=".1" material="{name}"/>' for name in "abca") + '<geom size=".1"/>'
    model = mujoco.MjModel.from_xml_string(_world(body, asset=asset))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 8, 8) as renderer:
        renderer.update_scene(data)
        geoms = GeomArray(renderer.scene, three_geoms).now()
        names = [name for name in geoms.dtype.names or () if name not in ("texid", "texuniform", "texrepeat")]
        older = np.zeros(len(geoms), [(name, geoms.dtype[name]) for name in names])
        for name in names:
            older[name] = geoms[name]
        made = _with_textures(older, model)
        for name in geoms.dtype.names or ():
            assert np.array_equal(made[name], geoms[name]), name
        older["matid"] = 7  # of a program
        assert (_with_textures(older, model)["texid"] == -1).all()


def test_a_batch_has_the_pictures_of_its_states() -> None:
    model = mujoco.MjModel.from_xml_string(_SCENE)
    positions = np.tile(model.qpos0, (5, 1))
    positions[:, 0] = np.linspace(-0.2, 0.2, 5)
    with morse.Renderer.batch(model, 5, 32, 48) as batch, morse.Renderer(model, 32, 48) as single:
        pictures = batch.render(positions, [0, -1])
        assert pictures.shape == (5, 2, 32, 48, 3)
        states = []
        for row, position in enumerate(positions):
            data = mujoco.MjData(model)
            data.qpos[:] = position
            mujoco.mj_forward(model, data)
            states.append(data)
            for column, camera in enumerate((0, -1)):
                single.update_scene(data, camera)
                assert np.array_equal(single.render(), pictures[row, column])
        assert np.array_equal(batch.render(states, "above"), pictures[:, 0])
        assert batch.render(states, kind="depth").shape == (5, 32, 48)
        assert batch.render(states, kind="ids").dtype == np.int32
        with pytest.raises(ValueError, match="5 states, got 4"):
            batch.render(states[:4])
        with pytest.raises(TypeError, match="real numbers, got an array of type complex128"):
            batch.render(np.zeros((5, model.nq), complex))
        with pytest.raises(ValueError, match=r"shape \(5, 7\)"):
            batch.render(np.zeros((5, 3)))
        with pytest.raises(ValueError, match="rgb, depth, ids"):
            batch.render(states, kind="heat")
        with pytest.raises(ValueError, match='"x" does not exist'):
            batch.render(states, ["x"])
    with pytest.raises(RuntimeError, match="after close"):
        batch.render(states)
    with pytest.raises(ValueError, match="at least 1, got 0"):
        morse.Renderer.batch(model, 0)


def test_planes_have_four_squares_along_a_side_at_least() -> None:
    body = (
        '<light pos="0 0 .5" dir="0 0 -1" cutoff="60" exponent="10" diffuse="1 1 1" castshadow="false" '
        'specular="0 0 0"/><geom type="plane" size=".5 .5 10" rgba="1 1 1 1"/>'
    )
    picture = _picture(_world(body, visual=_DARK))
    # the middle is a corner of squares, right below the light
    assert picture[32, 32, 0] == pytest.approx(255, abs=3)
    assert picture[32, 50, 0] < 150


# -- what programs get wrong ---------------------------------------------------------------

_LIFT = '<body><joint type="slide" axis="0 0 1"/><geom type="box" size=".3 .3 .1"/></body>'


def _lift(height: float = 0.0) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(_world(_LIFT))
    data = mujoco.MjData(model)
    data.qpos[0] = height
    mujoco.mj_forward(model, data)
    return model, data


def test_kinds_of_pictures_have_names() -> None:
    renderer = morse.Renderer(_lift()[0], 16, 16)
    with pytest.raises(ValueError, match="The kind of pictures 'colour' does not exist"):
        renderer.show("colour")


def test_states_of_other_models_are_refused() -> None:
    model, data = _lift()
    other = mujoco.MjModel.from_xml_string(_world(_LIFT * 50))
    strange = mujoco.MjData(other)
    mujoco.mj_forward(other, strange)
    for known, given in ((model, strange), (other, data)):
        with morse.Renderer(known, 16, 16) as renderer:
            with pytest.raises(ValueError, match="The state is one of another model: nq"):
                renderer.update_scene(given)
            with pytest.raises(TypeError, match="got NoneType"):
                renderer.update_scene(None)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [10.5, 20.0, "a", None, True, float("nan")])
def test_sizes_are_integers(size: Any) -> None:
    with pytest.raises(TypeError, match=r"Image height .* is not an integer"):
        morse.Renderer(_lift()[0], size, 16)


@pytest.mark.parametrize("room", [0, 1])
def test_a_scene_may_have_no_room(room: int) -> None:
    model, data = _lift()
    with morse.Renderer(model, 16, 16, max_geom=room) as renderer:
        renderer.update_scene(data, 0)
        assert renderer.render().shape == (16, 16, 3)


@pytest.mark.parametrize("number", [-5, 99, 2**31 - 1])
def test_geoms_may_have_textures_that_do_not_exist(number: int) -> None:
    def prepare(renderer: Any) -> None:
        renderer.scene.geoms[0].texid = number

    np.testing.assert_array_equal(_picture(_world(_LIFT), prepare=prepare), _picture(_world(_LIFT)))


def test_threads_may_share_a_batch() -> None:
    model, data = _lift()
    with morse.Renderer.batch(model, 4, 24, 24) as batch:

        def wrong(height: float) -> int:
            with morse.Renderer(model, 24, 24) as renderer:
                renderer.update_scene(_lift(height)[1], 0)
                expected = renderer.render()
            return sum((batch.render(np.full((4, 1), height), 0) != expected).any() for _ in range(30))

        with ThreadPoolExecutor(2) as pool:
            assert list(pool.map(wrong, (0.0, 0.8))) == [0, 0]
    with pytest.raises(RuntimeError, match="after close"):
        batch.render([data] * 4)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked on POSIX systems")
def test_a_process_that_is_forked_draws_batches() -> None:
    program = f"""
import os, signal, mujoco, morse
model = mujoco.MjModel.from_xml_string({_world(_LIFT)!r})
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
batch = morse.Renderer.batch(model, 3, 16, 16)
pictures = batch.render([data] * 3)
child = os.fork()
if child == 0:
    signal.alarm(60)
    os._exit(0 if (batch.render([data] * 3) == pictures).all() else 1)
raise SystemExit(os.waitpid(child, 0)[1])
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked on POSIX systems")
def test_a_process_that_is_forked_while_another_thread_draws_goes_on() -> None:
    program = f"""
import os, signal, threading, mujoco, morse
model = mujoco.MjModel.from_xml_string({_world(_LIFT)!r})
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer, rays, stop, begun = morse.Renderer(model, 64, 64), morse.Rays(model), threading.Event(), threading.Event()
renderer.update_scene(data)
picture = renderer.render()

def draw():
    while not stop.is_set():
        morse.Renderer(model, 8, 8).close()
        renderer.update_scene(data)
        renderer.render()
        begun.set()

threads = [threading.Thread(target=draw) for _ in range(2)]
for thread in threads:
    thread.start()
begun.wait()
failed = 0
for _ in range(20):
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        renderer.update_scene(data)
        same = (renderer.render() == picture).all()
        with morse.Renderer(model, 64, 64) as other:
            other.update_scene(data)
            same &= (other.render() == picture).all()
        rays.cast([data] * 8, (0, 0, 3), [[0, 0, -1.0]] * 5000)
        os._exit(0 if same else 1)
    failed += os.waitpid(child, 0)[1] != 0
stop.set()
for thread in threads:
    thread.join()
raise SystemExit(failed)
"""
    assert subprocess.run([sys.executable, "-c", program], check=False, timeout=600).returncode == 0


def test_a_further_renderer_of_many_bodies_takes_little_memory() -> None:
    """Of 3,000 bodies, it took 80 MB: room for all that options can show, and for all triangles of a picture."""
    bodies = "".join(
        f'<body pos="{n % 60} {n // 60} 1"><freejoint/><geom type="box" size=".2 .2 .2"/></body>' for n in range(3000)
    )
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    table = Path("/proc/self/statm")
    kept = []
    for _ in range(3):
        renderer = morse.Renderer(model, 64, 64)
        renderer.update_scene(data)
        renderer.render()
        kept.append(renderer)
    assert kept[0].scene.maxgeom < 3 * model.ngeom
    if table.exists():
        before = int(table.read_text().split()[1])
        for _ in range(4):
            kept.append(morse.Renderer(model, 64, 64))
            kept[-1].update_scene(data)
            kept[-1].render()
        pages = int(table.read_text().split()[1]) - before
        assert pages * os.sysconf("SC_PAGE_SIZE") / 4 < 10e6
    # options that show more have room for it
    option = mujoco.MjvOption()
    option.frame = mujoco.mjtFrame.mjFRAME_BODY
    kept[0].scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
    kept[0].update_scene(data, scene_option=option)
    assert kept[0].scene.ngeom >= model.ngeom + 3 * (model.nbody - 1)
    assert kept[0].scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] == 0
    kept[0].render()


@pytest.mark.parametrize(
    "geom",
    [
        'type="box" size=".005 {} .005"',
        'type="capsule" size=".005 {}" euler="90 0 0"',
        'type="cylinder" size=".005 {}" euler="90 0 0"',
    ],
)
@pytest.mark.parametrize(
    ("turn", "length"),
    # the last ones reach behind the camera, 1 m above
    [("0 0 0", 1), ("0 0 50", 1), ("60 0 20", 1), ("80 0 0", 4), ("100 0 0", 4), ("75 0 90", 4)],
)
def test_translucent_rods_are_drawn_around_their_pixels_alone(
    geom: str, turn: str, length: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[int] = []
    draw = NativeDrawer.draw

    def count(self: NativeDrawer, cameras: Any, *others: Any) -> Any:
        drawn.append(int((cameras["width"] * cameras["height"]).sum()))
        return draw(self, cameras, *others)

    monkeypatch.setattr(NativeDrawer, "draw", count)
    floor = '<geom type="plane" size="2 2 1" rgba="0 0 1 1"/>'
    rod = f'<body pos="0 0 1" euler="{turn}"><geom {geom.format(length / 2)} rgba="1 0 0 .5"/></body>'
    lit = '<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>'
    with_rod = _picture(_world(floor + rod, lit), size=200)
    assert len(drawn) == 2
    # a rod of 1 m fills the picture of a sphere of this size
    assert drawn[1] < 0.8 * drawn[0]
    seen = _picture(_world(floor + rod, lit), mode="ids", size=200)[..., 0] == 1
    assert seen.sum() > 50
    assert (with_rod[seen][:, 0] > 50).all()
    assert (with_rod[~seen][:, 0] < 200).all()


@pytest.mark.parametrize("size", [np.nan, np.inf, 1e30, -1.0])
@pytest.mark.parametrize("kind", ["BOX", "SPHERE", "CAPSULE"])
def test_translucent_geoms_of_any_size_leave_the_others(size: float, kind: str) -> None:
    def add(renderer: morse.Renderer) -> None:
        scene = renderer.scene
        mujoco.mjv_initGeom(
            scene.geoms[scene.ngeom],
            getattr(mujoco.mjtGeom, f"mjGEOM_{kind}"),
            np.full(3, 0.1),
            np.array([0.3, 0.3, 0.1]),
            np.array([0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6]),
            np.array([1, 0, 0, 0.5], np.float32),
        )
        scene.geoms[scene.ngeom].size[:] = size
        scene.ngeom += 1

    ball = _world(
        '<geom type="sphere" size=".3" rgba="0 1 0 1"/>',
        '<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>',
    )
    assert _picture(ball, prepare=add)[32, 32, 1] > 50


_KNOWN = mujoco.MjModel.from_xml_string(_world('<geom size=".1"/>'))


@pytest.mark.parametrize(
    ("ask", "kind", "told"),
    [
        (lambda r, d: morse.Renderer(None), TypeError, "Expected a model, mujoco.MjModel, got NoneType"),  # type: ignore[arg-type]
        (lambda r, d: morse.Rays("ant.xml"), TypeError, "got str; of a file: mujoco.MjModel.from_xml_path"),  # type: ignore[arg-type]
        (lambda r, d: morse.sensors_on(None), TypeError, "Expected a model"),
        (lambda r, d: morse.Renderer(_KNOWN, 8, 8, -1), ValueError, "max_geom is at least 0, got -1"),
        (lambda r, d: morse.Renderer(_KNOWN, 8, 8, 2.5), TypeError, "max_geom is an integer, got 2.5"),  # type: ignore[arg-type]
        (lambda r, d: r.update_scene(d, 0.5), TypeError, "A camera is a number, a name or a mujoco.MjvCamera, got 0.5"),
        (lambda r, d: r.update_scene(d, None), TypeError, "got None"),
        (lambda r, d: r.update_scene(d, 0, "all"), TypeError, "Expected an option, mujoco.MjvOption, got str"),
        (lambda r, d: r.render(out=[0]), TypeError, "Expected an array, out, got list"),
        (lambda r, d: morse.Renderer.batch(_KNOWN, 2.5), TypeError, "is an integer, got 2.5"),  # type: ignore[arg-type]
        (lambda r, d: morse.Renderer.batch(_KNOWN, 0), ValueError, "is at least 1, got 0"),
        (lambda r, d: morse.Rays(_KNOWN, "abcdef"), ValueError, "6 groups of geoms, hit or not, got 'abcdef'"),  # type: ignore[arg-type]
        (lambda r, d: morse.Rays(_KNOWN).cast(d, (0, 0, 1), [[0, 0, 1]], limit="far"), TypeError, "got 'far'"),  # type: ignore[arg-type]
        (lambda r, d: morse.Rays(_KNOWN).cast(d, (0, 0, 1), [[0, 0, 1]], bodyexclude=0.5), TypeError, "got 0.5"),  # type: ignore[arg-type]
    ],
)
def test_things_of_other_types_are_told(ask: Callable[[Any, Any], object], kind: type[Exception], told: str) -> None:
    data = mujoco.MjData(_KNOWN)
    mujoco.mj_forward(_KNOWN, data)
    with morse.Renderer(_KNOWN, 8, 8) as renderer:
        renderer.update_scene(data)
        with pytest.raises(kind, match=re.escape(told)):
            ask(renderer, data)


# -- against MuJoCo's OpenGL, by the equations that its pictures follow ----------------------


def test_haze_is_from_the_border_of_the_plane_to_the_horizon_and_on_the_plane_before_it() -> None:
    size, eye, far, ring = 1001, 1.0, 10.0, 0.3
    xml = (
        f'<mujoco><statistic extent="1" center="0 0 0"/><visual><global offheight="{size}" offwidth="{size}"/>'
        f'<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/><map zfar="{far}" haze="{ring}"/>'
        '<rgba haze="1 0 0 1"/></visual><asset><texture type="skybox" builtin="flat" rgb1="0 0 1" width="8" '
        'height="48"/></asset><worldbody><geom type="plane" size="0 0 1" rgba="0 1 0 1"/>'
        f'<camera name="c" pos="0 0 {eye}" xyaxes="1 0 0 0 0 1" fovy="90"/></worldbody></mujoco>'
    )
    column = _picture(xml, size=size, camera="c")[:, size // 2]
    border = 0.7 * far
    for slope in (-0.9, -0.3, -0.19, -0.165, -0.15, -0.13, -0.08, -0.03, -0.01, 0.02, 0.1, 0.25):
        row = round(size / 2 - 0.5 - slope * size / 2)
        slope = (size / 2 - 0.5 - row) / (size / 2)
        distance = -eye / slope if slope < 0 else np.inf
        if distance < border:
            clear = (border - distance) / (ring * (distance + ring * border))
        else:
            clear = (eye + slope * border) / (eye - slope * ring * border) if slope < 0 else 1.0
        clear = min(clear, 1.0)
        behind = (0, 255 * clear, 0) if distance < border else (0, 0, 255 * clear)
        assert column[row] == pytest.approx((255 * (1 - clear), *behind[1:]), abs=3), slope


def test_planes_reach_to_the_far_plane_in_depths_and_end_before_the_sky_in_colors() -> None:
    xml = (
        '<mujoco><statistic extent="1" center="0 0 0"/><visual><map zfar="10"/></visual><asset>'
        '<texture type="skybox" builtin="flat" rgb1="0 0 1" width="8" height="48"/>'
        '<texture name="t" type="2d" builtin="checker" rgb1="1 1 1" rgb2="0 .3 0" width="64" height="64"/>'
        '<material name="m" texture="t" texrepeat="2 2"/></asset><worldbody>'
        '<geom type="plane" size="0 0 1" material="m"/><camera name="c" pos="0 0 1" xyaxes="1 0 0 0 0 1" fovy="40"/>'
        "</worldbody></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 240, 64) as renderer:
        renderer.update_scene(data, "c")
        first = renderer.render()
        renderer.enable_depth_rendering()
        depth = renderer.render()
        assert depth[depth < 9.99].max() > 9.0
        renderer.disable_depth_rendering()
        assert np.array_equal(renderer.render(), first)


def test_only_surfaces_before_a_directional_light_cast_its_shadows() -> None:
    # one mesh with a roof above the light, and a shelf below it on the other side
    roof = "-1 -1 2 0 -1 2 0 1 2 -1 1 2"
    shelf = "0 -1 .5 1 -1 .5 1 1 .5 0 1 .5"
    xml = (
        '<mujoco><statistic extent="3" center="0 0 0"/><visual><headlight ambient="0 0 0" diffuse="0 0 0" '
        f'specular="0 0 0"/></visual><asset><mesh name="m" inertia="shell" vertex="{roof} {shelf}" '
        'face="0 1 2 0 2 3 4 5 6 4 6 7"/></asset><worldbody>'
        '<light directional="true" pos="0 0 1.5" dir="0 0 -1" diffuse=".8 .8 .8" specular="0 0 0"/>'
        '<geom type="plane" size="3 3 1" rgba="1 1 1 1"/><geom type="mesh" mesh="m" rgba="1 1 1 1"/>'
        '<camera name="c" pos="0 -4 .2" xyaxes="1 0 0 0 .05 1" fovy="30"/></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 200, 200) as renderer:
        renderer.update_scene(data, "c")
        picture = renderer.render().astype(int)
        renderer.enable_segmentation_rendering()
        ids = renderer.render()[..., 0]
    floor = np.flatnonzero(ids[:, 100] == 0)[0] + 12
    assert (ids[floor, [70, 130]] == 0).all()
    assert picture[floor, 70, 0] > 180
    assert picture[floor, 130, 0] < 10


@pytest.mark.parametrize("directional", ["true", "false"])
@pytest.mark.parametrize("height", [0.5, 1.4, 3.0])
def test_maps_around_what_casts_shadows_have_the_shadows_of_whole_maps(
    directional: str, height: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    balls = "".join(f'<geom size=".1" pos="{x} {y} {height + x * y}"/>' for x in (-0.6, 0.2) for y in (-0.4, 0.5))
    body = (
        f'<light pos=".3 -.2 2" dir="-.1 .2 -1" directional="{directional}" cutoff="60" exponent="0"/>{balls}'
        '<geom type="plane" size="2 2 .02"/><camera name="side" pos="0 -3 2" xyaxes="1 0 0 0 .6 1"/>'
    )
    xml = _world(body, visual=_DARK)
    monkeypatch.setattr(shadows, "FINER", 1.0)
    around = _picture(xml, camera="side", size=150)
    whole = ShadowMaps.map_of

    def of_everything(self: ShadowMaps, *given: Any) -> Any:
        return whole(self, *given[:-2], given[-2]._replace(bounded=np.zeros(1, np.bool_)), given[-1])

    monkeypatch.setattr(ShadowMaps, "map_of", of_everything)
    apart = np.abs(_picture(xml, camera="side", size=150) - around)
    # their texels begin elsewhere
    assert (apart > 60).mean() < 1e-3
    dark = np.abs(_picture(xml, camera="side", size=150, prepare=lambda r: r.scene.flags.__setitem__(0, 0)) - around)
    # balls above the lamp cast none
    assert ((dark > 20).mean() > 1e-3) == (height < 2)


def _floor_in_bright_light(light: str, ball: str = "") -> Any:
    """A textured floor with 0.3 of white in the headlight and in another light, each of which is at full strength."""
    bright = 'diffuse="1 1 1" ambient="0 0 0" specular="0 0 0"'
    return mujoco.MjModel.from_xml_string(
        _world(
            f'<light pos="0 0 3" dir="0 0 -1" {bright} {light}/><geom type="plane" size="2 2 .1" material="m"/>{ball}',
            visual=f"<headlight {bright}/>",
            asset='<texture name="t" type="2d" builtin="flat" rgb1=".3 .3 .3" width="8" height="8"/>'
            '<material name="m" texture="t" specular="0"/>',
        )
    )


@pytest.mark.parametrize(
    ("light", "shadows", "passes"),
    [
        # OpenGL adds lights that cast shadows in passes of their own, the others are limited to 1 together
        ('directional="true"', True, 2),
        ('cutoff="40" exponent="0"', True, 2),
        ('directional="true" castshadow="false"', True, 1),
        ('directional="true"', False, 1),
    ],
)
def test_lights_that_cast_shadows_are_limited_alone_where_no_shadow_is_seen(
    light: str, shadows: bool, passes: int
) -> None:
    model = _floor_in_bright_light(light)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 65, 65) as renderer:
        renderer.update_scene(data, 0)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        assert renderer.render()[32, 32] == pytest.approx(passes * 0.3 * 255, abs=3)


def test_pictures_before_and_after_shadows_are_seen_are_complete() -> None:
    model = _floor_in_bright_light('directional="true"', '<body><freejoint/><geom size=".1"/></body>')
    data = mujoco.MjData(model)
    with morse.Renderer(model, 97, 97) as renderer:
        darkest = []
        # above the light and the camera, below them, and above them again; standing for some pictures
        for height in (9.0, 9.0, 9.0, 0.5, 0.5, 0.5, 9.0, 9.0):
            data.qpos[:3] = 0.3, 0.2, height
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, 0)
            picture = renderer.render()
            with morse.Renderer(model, 97, 97) as other:
                other.update_scene(data, 0)
                assert np.array_equal(picture, other.render())
            darkest.append(int(picture.min()))
        assert max(darkest[3:6]) < 100 < min(darkest[:3] + darkest[6:])


def test_planes_cast_shadows_on_what_is_below_them() -> None:
    light = '<light pos="0 0 2" dir="0 0 -1" directional="true"/>'
    table = '<geom type="plane" size=".5 .5 .02" pos="0 0 1"/>'
    ball = '<geom size=".2"/><geom size=".1" pos="0 0 1.5"/><camera name="side" pos="0 -3 1.6" xyaxes="1 0 0 0 .5 1"/>'
    shown = [
        _picture(_world(light + ball + one, visual=_DARK), camera="side", size=150)[:, 75].max(axis=1)
        for one in ("", table)
    ]
    below = slice(66, 95)
    assert shown[0][below].max() > 60
    assert shown[1][below].max() < 5


@pytest.mark.parametrize("shape", ['type="sphere" size=".5"', 'type="box" size=".5 .5 .5"'])
def test_bodies_with_a_reflectance_are_seen_in_mirrors(shape: str) -> None:
    shown = []
    for reflectance in (0.0, 0.8):
        asset = f'<material name="m" reflectance=".5"/><material name="k" reflectance="{reflectance}" rgba="1 0 0 1"/>'
        body = (
            '<geom type="plane" size="3 3 1" material="m"/><geom ' + shape + ' pos="0 0 .8" material="k"/>'
            '<camera name="c" pos="0 -4 2" xyaxes="1 0 0 0 .4 1"/>'
        )
        shown.append(_picture(_world(body, asset=asset), camera="c", size=100))
    # the mirror shows red below the ball
    assert (shown[0][80:, 50, 0] > shown[0][80:, 50, 1] + 20).any()
    assert np.array_equal(shown[0], shown[1])


@pytest.mark.parametrize(
    ("name", "value"), [("znear", 0.0), ("extent", 0.0), ("extent", -1.0), ("znear", 1e-20), ("znear", -0.1)]
)
def test_a_near_plane_at_the_camera_is_an_error_and_ends_no_process(name: str, value: float) -> None:
    script = (
        "import mujoco, morse\n"
        "m = mujoco.MjModel.from_xml_string('<mujoco><worldbody><geom size=\".1\"/></worldbody></mujoco>')\n"
        "d = mujoco.MjData(m); mujoco.mj_forward(m, d); r = morse.Renderer(m, 8, 8); r.update_scene(d); r.render()\n"
        f"setattr({'m.vis.map' if name == 'znear' else 'm.stat'}, {name!r}, {value})\n"
        "try:\n    r.update_scene(d); r.render()\n"
        "except ValueError as error:\n    print('frustum' in str(error) and 'znear' in str(error))\n"
        "b = morse.Renderer.batch(m, 1, 8, 8)\n"
        "try:\n    b.render([d])\nexcept ValueError:\n    print('batch')\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout == "True\nbatch\n", done.stderr[-500:]


@pytest.mark.parametrize("slope", [0.0, 0.4, 0.6])
def test_orthographic_cameras_have_the_sky_and_the_haze_of_their_own_place(slope: float) -> None:
    xml = (
        '<mujoco><statistic extent="1" center="0 0 0"/><visual><rgba haze="1 0 0 1"/><map zfar="20"/>'
        '<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual><asset>'
        '<texture type="skybox" builtin="flat" rgb1="0 0 1" rgb2="0 0 1" width="8" height="48"/></asset><worldbody>'
        '<geom type="plane" size="0 0 1" rgba="0 1 0 1"/><camera name="o" projection="orthographic" fovy="1" '
        f'pos="0 0 2" xyaxes="1 0 0 0 {slope} 1"/></worldbody></mujoco>'
    )
    picture = _picture(xml, camera="o", size=9)
    if slope:
        # the plane is nearer than the haze
        assert (picture == [0, 255, 0]).all()
    else:
        # a ray that is half as high as the camera meets the haze half-way; the sky is above the camera
        assert (picture[:4] == [0, 0, 255]).all()
        down = np.arange(1, 5) / 9 / 2
        red = 255 * down
        assert picture[5:, 4] == pytest.approx(np.stack([red, 0 * red, 255 - red], axis=1), abs=3)


def test_planes_that_are_turned_away_from_orthographic_cameras_are_not_drawn() -> None:
    xml = (
        '<mujoco><statistic extent="1" center="0 0 0"/><worldbody><geom type="plane" size="0 0 1"/>'
        '<camera name="o" projection="orthographic" fovy="4" pos="0 0 .5" xyaxes="1 0 0 0 -.2 1"/></worldbody></mujoco>'
    )
    assert (_picture(xml, mode="ids", camera="o") == -1).all()
    assert (_picture(xml, camera="o") == 0).all()


def test_fog_of_orthographic_cameras_begins_at_their_place() -> None:
    def fog(renderer: morse.Renderer) -> None:
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = 1

    visual = (
        '<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/><rgba fog="1 0 0 1"/>'
        '<map fogstart=".5" fogend="1.5"/>'
    )
    camera = '<camera name="o" projection="orthographic" fovy="2" pos="0 0 2"/>'
    xml = _world(camera + '<geom type="box" size=".5 .5 .1" pos="0 0 .4" rgba="0 1 0 1"/>', visual)
    # fog is from 1 to 3 m, the surface at 1.5 m
    assert _picture(xml, camera="o", prepare=fog)[32, 32].tolist() == pytest.approx([64, 191, 0], abs=2)


def _appended(kind: mujoco.mjtGeom, size: tuple[float, float, float], **fields: int) -> Callable[[Any], None]:
    """Appends a geom at the origin with its Z axis along X of the picture, to the right."""

    def add(renderer: morse.Renderer) -> None:
        geom = renderer.scene.geoms[renderer.scene.ngeom]
        turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
        color = np.array([1, 0.5, 0.25, 1], np.float32)
        mujoco.mjv_initGeom(geom, kind, np.array(size), np.zeros(3), turn.ravel(), color)
        for name, value in fields.items():
            setattr(geom, name, value)
        renderer.scene.ngeom += 1

    return add


_BRIGHT = '<headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/>'
_ORTHO = '<camera name="o" projection="orthographic" fovy="2" pos="0 0 2"/>'


@pytest.mark.parametrize(
    ("kind", "begin", "end", "widths"),
    [
        # half as long as their size, a third of which is the head, which is 1.75 as wide as the shaft or as wide
        ("ARROW", 0.0, 0.5, {0.1: 0.1, 0.3: 0.1, 0.35: 0.157, 0.42: 0.084, -0.1: 0.0}),
        ("ARROW1", 0.0, 0.5, {0.1: 0.1, 0.3: 0.1, 0.35: 0.09, 0.42: 0.048, -0.1: 0.0}),
        ("ARROW2", -0.5, 0.5, {0.1: 0.1, -0.1: 0.1, 0.35: 0.157, -0.35: 0.157, -0.42: 0.084}),
    ],
)
def test_arrows_have_the_sizes_of_opengl(kind: str, begin: float, end: float, widths: dict[float, float]) -> None:
    add = _appended(getattr(mujoco.mjtGeom, f"mjGEOM_{kind}"), (0.05, 0.05, 1.0))
    picture = _picture(_world(_ORTHO, _BRIGHT), prepare=add, camera="o", size=401)
    seen = picture.sum(axis=2) > 200
    columns = (np.flatnonzero(seen.any(axis=0)) - 200) / 200.5
    assert (columns.min(), columns.max()) == pytest.approx((begin, end), abs=0.02)
    for place, width in widths.items():
        assert seen[:, round(200 + place * 200.5)].sum() / 200.5 == pytest.approx(width, abs=0.012)


@pytest.mark.parametrize("factor", [1, 3])
def test_lines_are_not_lit_and_have_widths_of_pixels(factor: int) -> None:
    dark = f'<global linewidth="{factor}"/>{_DARK}'
    camera = '<camera name="o" projection="orthographic" fovy="2" pos=".2 0 2"/>'
    add = _appended(mujoco.mjtGeom.mjGEOM_LINE, (2.0, 2.0, 0.5))
    column = _picture(_world(camera, dark), prepare=add, camera="o", size=100)[:, 50]
    assert column.max(axis=0).tolist() == pytest.approx([255, 127.5, 63.75], abs=1)
    assert column.sum(axis=0)[0] / 255 == pytest.approx(2 * factor, abs=0.6)
    # a line of any width is seen
    add = _appended(mujoco.mjtGeom.mjGEOM_LINE, (0.01, 0.01, 0.5))
    assert _picture(_world(camera, dark), prepare=add, camera="o", size=100)[:, 50].any()


def test_frames_of_boxes_are_their_edges() -> None:
    add = _appended(mujoco.mjtGeom.mjGEOM_LINEBOX, (0.2, 0.4, 0.6))
    seen = _picture(_world(_ORTHO, _DARK), prepare=add, camera="o", size=200).sum(axis=2) > 0
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    assert (rows.min(), rows.max()) == pytest.approx((60, 140), abs=2)
    assert (columns.min(), columns.max()) == pytest.approx((40, 160), abs=2)
    assert not seen[64:136, 44:156].any()


@pytest.mark.parametrize(
    ("material", "texture", "code"),
    [(-1, 0, (255, 128, 64)), (0, -1, (255, 0, 0)), (0, 0, (255, 0, 0)), (0, 1, (0, 64, 0)), (7, -1, (255, 128, 64))],
)
def test_textures_of_geoms_are_those_of_their_materials_unless_they_have_their_own(
    material: int, texture: int, code: tuple[int, int, int]
) -> None:
    asset = "".join(
        f'<texture name="{name}" type="2d" builtin="flat" rgb1="{rgb}" width="8" height="8"/>'
        for name, rgb in (("r", "1 0 0"), ("g", "0 .5 0"))
    )
    asset += '<material name="r" texture="r"/>'
    add = _appended(mujoco.mjtGeom.mjGEOM_SPHERE, (0.4, 0.4, 0.4), matid=material, texid=texture)
    assert _picture(_world("", _BRIGHT, asset), prepare=add)[32, 32].tolist() == pytest.approx(code, abs=1)


def test_translucent_surfaces_at_the_place_of_others_are_seen() -> None:
    box = '<geom type="box" size=".2 .2 .2" rgba="1 0 0 1"/><geom type="box" size=".2 .2 .2" rgba="0 1 0 .5"/>'
    assert _picture(_world(box, _BRIGHT))[32, 32].tolist() == pytest.approx([64, 191, 0], abs=2)


@pytest.mark.parametrize("make", [morse.Renderer, morse.Rays, lambda model: morse.Renderer.batch(model, 1)])
def test_memory_of_the_kernel_is_not_pickled(make: Any) -> None:
    made = make(mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"))
    for copied in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match=r"cannot pickle '\w+' object: make one of the model in each process"):
            copied(made)


def test_flags_of_the_scene_give_each_geom_one_colour() -> None:
    """Terms 10, 11, ... of the Halton sequences of 2, 3 and 5, from 0.1 to 0.9; or the number in bytes."""
    spheres = "".join(f"<geom size='.2' pos='{x} 0 0'/>" for x in (-1, 0, 1))
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{spheres}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with morse.Renderer(model, 120, 160) as renderer:
        renderer.update_scene(data)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        # 10 is 1010 in base 2, 101 in base 3, 20 in base 5: 5/16, 10/27, 2/25
        first = [round(255 * (0.1 + 0.8 * share)) for share in (5 / 16, 10 / 27, 2 / 25)]
        colors = np.unique(renderer.render().reshape(-1, 3), axis=0)
        assert len(colors) == 4
        assert [0, 0, 0] in colors.tolist()
        assert first in colors.tolist()
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        numbers = np.unique(renderer.render().reshape(-1, 3), axis=0)
        assert numbers.tolist() == [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 0
        assert len(np.unique(renderer.render().reshape(-1, 3), axis=0)) > 20
