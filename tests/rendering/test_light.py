"""Colours, shadows and textures."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image as Picture
from studio import FAR, Studio, Tripod, body, box, floor, lamp, triangles

import morse
import morse.rendering.lights as shadows
from morse.builder import Cube, Environment, FakeRobot, PassiveObject
from morse.rendering import Lens
from morse.scene import Image, Light, Material, Mist, PhysicsType
from morse.scene.extent import water_level

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


@pytest.mark.parametrize("reach", [0.0, 1e300])
def test_a_lamp_of_any_reach_leaves_the_picture_to_the_others(reach):
    odd = lamp("POINT", (0, 0, 1), 0.0, location=(3, 3, 2))
    odd.light = replace(odd.light, distance=reach)
    made = Studio(floor(), lamp("SPOT", (0, 0, 1), 3.0, location=(1, 1, 2)), odd)
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


@pytest.mark.parametrize("kind", ["SPOT", "POINT"])
@pytest.mark.parametrize(
    ("energy", "distance", "code"),
    [(1e30, 1.0, 255), (1.0, 0.0, 0), (1.0, 1e30, 150), (1.0, np.inf, 150), (np.nan, np.nan, 0)],
)
def test_absurd_lamps_give_an_image_in_the_look_of_1_4(kind, energy, distance, code):
    """A lamp that reaches far does not fade, one that reaches nowhere gives no light."""
    shone = lamp(kind, (0, 0, 1), energy, (0.0, 0.0, 2.0))
    shone.light.distance = distance
    made = Studio(floor(material=Material("", color=(0.5, 0.0, 0.0, 1))), shone)
    made.scene.settings.physics_of_1_4 = True
    picture = made.look(Tripod((0.0, 1.0, 3.0), (0, 0, 0)), LENS)
    assert picture.rgb[100, 100].tolist() == pytest.approx([code, 0, 0], abs=2)


# -- shadows of a spot lamp, at the positions that follow from the geometry ------------------------

TRIPOD, SPOT_SHADOWS_LENS = Tripod((-7.0, 0.5, 5.0), (0.0, 0.0, 0.0)), Lens.of_focal_length(320, 240, 40.0, 0.1, FAR)
HEIGHT, PLATE, HALF = 4.0, 2.0, 0.4


def spot(position=(0.0, 0.0, HEIGHT), towards=(0.0, 0.0, 1.0), **more):
    node = lamp("SPOT", towards, 3.0, position)
    node.light = replace(node.light or Light(), distance=5.0, spot_size=1.2, **more)
    return node


def spot_shadows_plate(position=(0.0, 0.0, PLATE)):
    return box("Plate", position, (HALF, HALF, 0.02))


def dark(*nodes, **more):
    """The points of the floor (N, 3), and whether each is darker than with a lamp that casts no shadow."""
    pictures = [
        Studio(floor(), *nodes, spot(**more, casts_shadow=casts)).look(TRIPOD, SPOT_SHADOWS_LENS)
        for casts in (True, False)
    ]
    shown = (pictures[0].ids == 0) & (pictures[0].ids == pictures[1].ids)
    assert pictures[0].nodes[0].name == "Floor"
    points = (SPOT_SHADOWS_LENS.rays() * pictures[0].depth[..., None])[shown] @ TRIPOD.axes.T + TRIPOD.position
    light = [picture.rgb[shown].sum(axis=1).astype(int) for picture in pictures]
    assert (light[0] <= light[1]).all()
    return points, light[0] < light[1] - 6


def test_the_edges_of_a_shadow_are_on_the_lines_through_the_edges_of_a_plate():
    points, shaded = dark(spot_shadows_plate())
    # the upper side of the plate decides: similar triangles from the lamp to the floor
    edge = HALF * HEIGHT / (HEIGHT - PLATE - 0.02)
    away = np.abs(points[:, :2]).max(axis=1)
    assert shaded[away < edge - 0.05].all()
    assert not shaded[away > edge + 0.05].any()
    assert shaded.sum() > 300


def test_a_shadow_follows_the_lamp():
    lean = np.array([0.5, -0.5, HEIGHT])
    points, shaded = dark(spot_shadows_plate(), position=tuple(lean), towards=tuple(lean))
    # the centre of the plate is projected from the lamp to the floor
    centre = lean + (np.array([0, 0, PLATE]) - lean) * HEIGHT / (HEIGHT - PLATE)
    middle = (points[shaded].min(axis=0) + points[shaded].max(axis=0)) / 2
    np.testing.assert_allclose(middle[:2], centre[:2], atol=0.06)


def test_surfaces_do_not_shadow_themselves():
    _, shaded = dark(position=(2.0, 1.0, HEIGHT), towards=(0.4, 0.2, 1.0))
    assert not shaded.any()


def test_a_shadow_moves_with_what_casts_it():
    studio = Studio(floor(), spot_shadows_plate(), spot())
    before = studio.look(TRIPOD, SPOT_SHADOWS_LENS).rgb
    assert (studio.look(TRIPOD, SPOT_SHADOWS_LENS).rgb == before).all()
    studio.world.object_of(studio.scene.roots[1]).visible = False
    after = studio.look(TRIPOD, SPOT_SHADOWS_LENS)
    bare = Studio(floor(), spot()).look(TRIPOD, SPOT_SHADOWS_LENS)
    np.testing.assert_array_equal(after.rgb, bare.rgb)
    assert (after.rgb != before).any()


@pytest.mark.parametrize("angle", [2.2, 3.1])
def test_wide_spots_cast_no_shadow(angle):
    nodes = [spot(casts_shadow=casts) for casts in (True, False)]
    for node in nodes:
        node.light = replace(node.light, spot_size=angle)
    one, other = (Studio(floor(), spot_shadows_plate(), node).look(TRIPOD, SPOT_SHADOWS_LENS).rgb for node in nodes)
    np.testing.assert_array_equal(one, other)


# -- large scenes have two shadow maps; objects in the middle of the finer one are left out of the other

TWO_SHADOW_MAPS_LENS = Lens.of_focal_length(64, 48, 20.0, 0.1, 300)
#: in the finer map, at its border, and outside
PLACES = [(0.0, 0.0), (9.0, 0.0), (11.5, 0.0), (14.0, 0.0), (40.0, 0.0)]


def world():
    return Studio(floor(half=120.0), box("Box", (0, 0, 1), (0.5, 0.5, 0.5), kind=PhysicsType.RIGID_BODY))


def look_at(studio, x, y):
    crate = studio.world.game_object("Box")
    crate.set_pose((x, y, 1.0), crate.world_pose()[1])
    return studio.look(Tripod((x - 4, y - 4, 5), (x, y, 0)), TWO_SHADOW_MAPS_LENS).rgb


def test_shadows_follow_an_object_from_one_map_to_the_other_and_back():
    moved = world()
    for x, y in PLACES[::2] + PLACES[:1]:
        np.testing.assert_array_equal(look_at(moved, x, y), look_at(world(), x, y))


@pytest.mark.parametrize("place", PLACES)
def test_what_is_left_out_is_not_seen(monkeypatch, place):
    with_less = look_at(world(), *place)
    covered = []

    def nothing(self, ratio):
        covered.append(covers(self, ratio))
        return np.zeros_like(covered[0])

    covers = shadows.ShadowMap.covers
    monkeypatch.setattr(shadows.ShadowMap, "covers", nothing)
    np.testing.assert_array_equal(with_less, look_at(world(), *place))
    # two maps are in use, and objects far from the border of the finer one are left out
    assert covered
    assert covered[0].all() == (place in PLACES[:2])


# -- cameras under water see the colour of water, darker with the depth, and nothing far away ------

LOOK = {"rotation": (1.5708, 0.0, 0.0), "focal_length": 24.0}


def sea() -> None:
    """Boxes 3 m and 60 m from the origin, 4 m under water."""
    for y in (3.0, 60.0):
        box = PassiveObject("props/crates", object_name="small_crate")
        box.translate(0.0, y, -4.0)
        box.static()
    FakeRobot()
    Environment("water-1/deep_water")


def test_the_colour_of_water_hides_what_is_far() -> None:
    with morse.load(sea) as simulation:
        assert water_level(simulation.scene) == pytest.approx(0.0)

        def image(depth: float, y: float = 0.0) -> np.ndarray:
            pixels: np.ndarray = simulation.picture(96, 64, location=(0.0, y, -depth), **LOOK)
            return pixels.astype(int)

        near, deep = image(4.0)[30:34], image(12.0)[30:34]
        edges = near[:, :4].mean(axis=(0, 1)), deep[:, :4].mean(axis=(0, 1))
        for red, green, blue in edges:
            assert red < green < blue
        assert edges[1].sum() < 0.8 * edges[0].sum()  # 8 m deeper
        assert np.abs(near[:, 46:50].mean(axis=(0, 1)) - edges[0]).max() > 15  # the crate at 3 m
        far = image(4.0, 10.0)[30:34]  # the other one is 50 m away
        assert np.abs(far[:, 46:50].mean(axis=(0, 1)) - far[:, :4].mean(axis=(0, 1))).max() <= 2


def test_above_the_surface_nothing_changes() -> None:
    def ground() -> None:
        Cube().name = "Waterfall"  # neither flat nor wide
        FakeRobot()
        Environment("empty")

    with morse.load(ground) as simulation:
        assert water_level(simulation.scene) is None
    with morse.load(sea) as simulation:
        above = simulation.picture(96, 64, location=(0.0, 0.0, 1.0), **LOOK)[:20].astype(int)
        assert above.mean() > 100  # a day
