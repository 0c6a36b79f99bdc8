"""Colours, shadows and textures."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image as Picture
from studio import Studio, Tripod, body, box, floor, lamp, triangles

from morse.rendering import Lens
from morse.scene import Image, Material, Mist

LENS = Lens.of_focal_length(200, 200, 32.0, 0.1, 50)
ABOVE = Tripod((0, 0, 8), (0, 0, 0), up=(0, 1, 0))


def gray(picture):
    return picture.rgb.astype(float).mean(axis=2)


def place(tripod, point):
    ((x, y),) = tripod.project(point, LENS)[0]
    return int(y), int(x)


@pytest.mark.parametrize("towards", [(0, 0, 1), (1, 0, 1), (-1, 1, 2), (0.5, -1, 1)])
def test_the_edges_of_a_shadow_are_where_the_direction_of_the_sun_puts_them(towards):
    half, height = 0.5, 1.0
    made = Studio(floor(), box("Plate", (0, 0, height), (half, half, 0.01)), lamp("SUN", towards))
    picture = made.look(ABOVE, LENS)
    light = gray(picture)
    shift = -np.array(towards[:2]) / towards[2] * height
    on_floor = picture.ids == made.number(picture, "Floor")
    sunny = light[place(ABOVE, (3.0, 3.0, 0.0))]
    seen = 0
    for x in np.arange(-2.5, 2.5, 0.07):
        for y in np.arange(-2.5, 2.5, 0.07):
            at = place(ABOVE, (x, y, 0.0))
            apart = max(abs(x - shift[0]), abs(y - shift[1])) - half
            if not on_floor[at] or abs(apart) < 0.12:
                continue
            seen += apart < 0
            if apart < 0:
                assert light[at] < 0.9 * sunny, (x, y)
            else:
                assert light[at] == pytest.approx(sunny, rel=0.03), (x, y)
    assert seen > 20 or towards == (0, 0, 1)


def test_a_shadow_moves_with_what_casts_it_and_leaves_nothing_behind():
    made = Studio(floor(), box("Plate", (0, 0, 1.0), (0.5, 0.5, 0.01)), lamp("SUN", (1, 0, 1)))
    before = made.look(ABOVE, LENS).rgb
    plate = made.world.game_object("Plate")
    start = plate.world_pose()
    plate.set_pose((0.0, 2.0, 1.0), start[1])
    moved = gray(made.look(ABOVE, LENS))
    assert moved[place(ABOVE, (-1, 2, 0))] < 0.8 * moved[place(ABOVE, (-1, 0, 0))]
    plate.set_pose(*start)
    np.testing.assert_array_equal(made.look(ABOVE, LENS).rgb, before)


def test_surfaces_shine_by_the_cosine_of_the_angle_to_the_lamp():
    """The light of a diffuse surface, before tone mapping, is the light of the sky plus the cosine times the sun."""
    values = []
    for towards in ((0, 0, 1), (np.sqrt(3), 0, 1)):
        made = Studio(floor(material=Material("", color=(0.2, 0.2, 0.2, 1), roughness=1.0)), lamp("SUN", towards, 0.5))
        values.append(gray(made.look(ABOVE, LENS))[30, 30])
    straight, slanted = values
    dark = gray(
        Studio(floor(material=Material("", color=(0.2, 0.2, 0.2, 1), roughness=1.0)), lamp("SUN", (0, 0, 1), 0.0)).look(
            ABOVE, LENS
        )
    )[30, 30]
    assert dark < slanted < straight
    # the curve is nearly straight here
    assert (slanted - dark) / (straight - dark) == pytest.approx(0.5, abs=0.12)


@pytest.mark.parametrize("suns", [[], [lamp("SUN", (0, 0, 1)), lamp("HEMI", (0, 0, 1))]])
def test_a_night_is_dark_but_for_its_lamps(suns):
    lens, up = Lens.of_focal_length(16, 16, 32.0, 0.1, 50), Tripod((0, 0, 1), (1, 0, 3))

    def seen(share, *lamps):
        """The floor, and the sky."""
        white = Material("", color=(1, 1, 1, 1), roughness=1.0)
        made = Studio(floor(half=3.0, material=white), *suns, *lamps, daylight=share)
        return np.array([gray(made.look(way, lens))[8, 8] for way in (ABOVE, up)])

    night, dusk, day = (seen(share) for share in (0.0, 0.1, 1.0))
    assert (night == 0).all()
    assert (night < dusk).all()
    assert (dusk < day).all()
    # a lamp shines by night as by day
    assert seen(0.0, lamp("POINT", (0, 0, 1), energy=0.3, location=(0, 0, 5)))[0] > 20


def test_shadeless_surfaces_show_their_own_colour():
    # linear 0.5 is 188 in sRGB, 0.2 is 124, 1 is 255
    made = Studio(floor(material=Material("", color=(0.5, 0.2, 1.0, 1.0), shadeless=True)))
    assert made.look(ABOVE, LENS).rgb[100, 100].tolist() == [188, 124, 255]


def test_things_that_give_light_glow_without_any_lamp():
    dark = Material("", color=(0, 0, 0, 1), emission=(0, 0, 0))
    glowing = Material("", color=(0, 0, 0, 1), emission=(0, 2.0, 0))
    one, other = (Studio(floor(material=m)).look(ABOVE, LENS).rgb[100, 100].astype(int) for m in (dark, glowing))
    assert other[1] > one[1] + 150


def test_mist_hides_what_is_far():
    clear, misty = (
        Studio(floor(material=Material("", color=(1, 0, 0, 1))), mist=mist).look(ABOVE, LENS).rgb[100, 100].astype(int)
        for mist in (None, Mist(start=1.0, depth=3.0))
    )
    assert clear[0] > clear[2] + 50
    assert abs(misty[0] - misty[2]) < 20


def test_lamps_light_what_is_near_them():
    made = Studio(floor(), lamp("SPOT", (0, 0, 1), 3.0, location=(1, 1, 2)))
    light = gray(made.look(ABOVE, LENS))
    assert light[place(ABOVE, (1, 1, 0))] > light[place(ABOVE, (-2, -2, 0))] + 20


def picture_of(pixels):
    data = io.BytesIO()
    Picture.fromarray(pixels).save(data, "PNG")
    return Image("made", data.getvalue(), "image/png")


def plate(image, size=1.0, **more):
    """A square in the plane z = 0 whose texture is upright in a view from above with Y up."""
    corners = [(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)]
    uvs = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
    material = Material("", color=(1, 1, 1, 1), image=image, shadeless=True, **more)
    return body("Plate", triangles(corners, [[0, 1, 2], [0, 2, 3]], uvs), material=material)


def test_textures_lie_as_their_coordinates_say():
    pixels = np.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 0)]], np.uint8)
    large = pixels.repeat(16, axis=0).repeat(16, axis=1)
    rgb = Studio(plate(picture_of(large))).look(ABOVE, LENS).rgb
    for (x, y), color in {
        (-0.5, 0.5): pixels[0, 0],
        (0.5, 0.5): pixels[0, 1],
        (-0.5, -0.5): pixels[1, 0],
        (0.5, -0.5): pixels[1, 1],
    }.items():
        assert rgb[place(ABOVE, (x, y, 0))].tolist() == pytest.approx(color.tolist(), abs=3)


def test_a_texture_with_holes_shows_what_is_behind():
    pixels = np.full((32, 32, 4), 255, np.uint8)
    pixels[8:24, 8:24, 3] = 0
    made = Studio(plate(picture_of(pixels)), floor(-1.0))
    picture = made.look(ABOVE, LENS)
    assert picture.nodes[picture.ids[100, 100]].name == "Floor"
    assert picture.nodes[picture.ids[place(ABOVE, (0.8, 0.8, 0))]].name == "Plate"


def test_fine_patterns_far_away_become_their_mean():
    pixels = np.zeros((256, 256), np.uint8)
    pixels[::2, 1::2] = pixels[1::2, ::2] = 255
    far = Tripod((0, 0, 40), (0, 0, 0), up=(0, 1, 0))
    rgb = Studio(plate(picture_of(pixels))).look(far, LENS).rgb
    # half of the light is 188 in sRGB
    assert rgb[99:102, 99:102].mean() == pytest.approx(188, abs=4)


def test_the_sky_is_bright_above_and_its_colours_can_be_chosen():
    up = Tripod((0, 0, 0), (1, 0, 0))
    sky = Studio(floor(-100.0, half=1.0)).look(up, LENS).rgb
    assert sky[10, 100].mean() > 60
    red = Studio(floor(-100.0, half=1.0), horizon_color=(0.8, 0.0, 0.0)).look(up, LENS).rgb
    assert red[99, 100, 0] > red[99, 100, 2] + 60


@pytest.mark.parametrize("kind", ["SPOT", "POINT", "SUN"])
def test_the_look_of_1_4_is_0_8_times_code_and_light_without_tone_mapping(kind):
    """Blender 2.6: code = 255 · 0.8 · colour · energy, at a distance r times 1 / (1 + (r / distance)²)."""
    code, energy, far, half = 200, 0.9, 2.0, 5.0
    linear = ((code / 255 + 0.055) / 1.055) ** 2.4
    material = Material("", color=(linear, 0.0, 0.0, 1), roughness=0.2, metallic=0.7)
    shone = lamp(kind, (0, 0, 1), energy, (0.0, 0.0, far))
    shone.light.distance = half
    made = Studio(floor(material=material), shone)
    made.scene.settings.physics_of_1_4 = True
    above = Tripod((0.0, 1.0, 3.0), (0, 0, 0))
    r, g, b = made.look(above, LENS).rgb[100, 100].tolist()
    fading = 1.0 if kind == "SUN" else 1.0 / (1.0 + (far / half) ** 2)
    assert r == pytest.approx(0.8 * code * energy * fading, abs=1.5)
    assert (g, b) == (0, 0)
    shone.light = replace(shone.light, energy=0.0)
    made.world.appearance_changed(made.world.object_of(shone))
    assert made.look(above, LENS).rgb[100, 100].max() == 0


def test_the_sky_and_glowing_surfaces_have_their_own_colours_in_the_look_of_1_4():
    glowing = Material("", color=(0, 0, 0, 1), emission=(0.2, 0.0, 0.0))
    made = Studio(floor(material=glowing), lamp("SUN", (0, 0, 1)), horizon_color=(0.1, 0.1, 0.1))
    made.scene.settings.physics_of_1_4 = True
    assert made.look(ABOVE, LENS).rgb[100, 100].tolist() == [124, 0, 0]  # sRGB of 0.2
