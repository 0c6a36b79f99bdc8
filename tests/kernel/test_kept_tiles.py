"""Images of a drawer that keeps the last ones are those of a drawer that draws everything, whatever has changed."""

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.arrays import NO_SURFACE, Poses, bounds_for, changes_for
from morse.kernel.drawing.native import Kept, NativeDrawer
from tests.kit.effort import examples

some = settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
SIZES = ((160, 100), (70, 130), (40, 40))
MOVERS, STILL = np.array([1, 2, 4, 7]), np.array([0, 3, 5, 6, 8, 9])
#: texels of the shadow maps: the finer one covers a part, and each has the shadows of other movers
SHAPES = ((220, 250), (120, 140))
CHANGES = st.sampled_from(["nothing", "pose", "hide", "normals", "camera", "lamps", "lamp map", "still", "samples"])


class Stand:
    """Some small instances far apart, with shadow maps, in front of several cameras."""

    def __init__(self, build, seed):
        made = RandomDrawing(seed, instances=10)
        self.rng, self.cameras = np.random.default_rng(seed), made.cameras(SIZES, far=30.0)
        self.cameras["eye"] -= 4 * self.cameras["axes"][:, 6:9]
        self.cameras["color"][2] = False
        models = made.poses.models.reshape(-1, 3, 4) * (0.3, 0.3, 0.3, 2.5)
        # surfaces on which the shadows of the others are visible
        models[[0, 3], :, :3] *= 8
        models[[0, 3], :, 3] = 0
        self.poses = Poses(models.reshape(-1, 12).astype(np.float32), made.poses.turns)
        # all distances show all clusters
        made.drawing.levels[:, 4:] = 0, np.inf
        self.drawer, self.other = NativeDrawer(build, made.drawing), NativeDrawer(build, made.drawing)
        self.light, self.samples = self._lit(made), 5
        self._cast()
        self.kept = [Kept() for _ in SIZES]
        self.drawn = []

    def _lit(self, made):
        light = made.light(near=True)
        # texels of 5 cm, the finer ones of 2 cm
        for frame, factor, shape in zip((light.sun, light.near_sun), (2.0, 2.0), SHAPES, strict=True):
            frame[:8] *= factor
            frame[12] /= factor
            frame[[3, 7]] = shape[1] / 2, shape[0] / 2
        # the spot lamp shines at the middle, from a distance of 8 m
        lamps, to = light.lamps, light.lamps["towards"][2].astype(float)
        lamps["place"][2], lamps["outer"][2], lamps["color"][:3] = 8 * to, 0.6, 3.0
        right = np.cross(to, (0, 0, 1)) / np.linalg.norm(np.cross(to, (0, 0, 1)))
        matrix = np.array([[150, 0, 90], [0, 150, 100], [0, 0, 1]]) @ np.array([right, np.cross(right, to), -to])
        light.lamp_frame[:12] = np.column_stack([matrix, -matrix @ lamps["place"][2]]).ravel()
        light.lamp_frame[12] = 1 / 150
        return light._replace(lamp_shadow=np.full((200, 180), NO_SURFACE, np.float32))

    def _cast(self):
        """New maps of the instances that stand."""
        maps = []
        for sun, shape, own in zip(
            (self.light.sun, self.light.near_sun), SHAPES, (MOVERS[:2], MOVERS[2:]), strict=True
        ):
            shadow = np.full(shape, NO_SURFACE, np.float32)
            one = self.light._replace(
                sun=sun, shadow=shadow, shadow_bounds=bounds_for(shadow), shadow_changes=changes_for(shadow)
            )
            self.drawer.cast_shadows(STILL, self.poses, one)
            self.drawer.bound_shadows(one)
            maps.append((one, self.drawer.moving_shadows(own, one)))
        (far, _), (near, _) = maps
        self.movers = [movers for _, movers in maps]
        self.light = self.light._replace(
            shadow=far.shadow, shadow_bounds=far.shadow_bounds, shadow_changes=far.shadow_changes,
            near_shadow=near.shadow, near_bounds=near.shadow_bounds, near_changes=near.shadow_changes,
        )  # fmt: skip

    def _move(self, which, by):
        models = self.poses.models.copy()
        models[which, 3::4] += self.rng.normal(size=3).astype(np.float32) * np.float32(by)
        self.poses = Poses(models, self.poses.turns)

    def change(self, what, size):
        light, rng = self.light, self.rng
        if what == "pose":
            self._move(rng.choice(MOVERS), size)
        elif what == "hide":
            models = self.poses.models.copy()
            models[rng.choice(MOVERS)] *= 0.0
            self.poses = Poses(models, self.poses.turns)
        elif what == "normals":
            turns = self.poses.turns.copy()
            turns[rng.integers(len(turns))] *= np.float32(1.5)
            self.poses = Poses(self.poses.models, turns)
        elif what == "camera":
            self.cameras["eye"][rng.integers(len(SIZES))] += np.float32(size)
        elif what == "lamps":
            lamps = light.lamps.copy()
            lamps["color"][rng.integers(len(lamps))] *= np.float32(0.7)
            self.light = light._replace(lamps=lamps)
        elif what == "lamp map":
            depths = light.lamp_shadow.copy()
            row, column = rng.integers(0, depths.shape)
            depths[row : row + 20, column : column + 30] = -self.rng.uniform(5, 9)
            self.light = light._replace(lamp_shadow=depths)
        elif what == "still":
            self._move(rng.choice(STILL), size)
            self._cast()
        elif what == "samples":
            self.samples = 6 - self.samples

    def compare(self):
        for movers in self.movers:
            movers.update(self.poses, self.cameras)
        made = self.drawer.draw(self.cameras.copy(), self.poses, self.light, self.samples, self.kept)
        self.drawn.append(self.drawer.drawn_tiles)
        wanted = self.other.draw(self.cameras.copy(), self.poses, self.light, self.samples)
        coloured = slice(0, sum(w * h for w, h in SIZES[:2]))
        wanted = wanted._replace(rgba=wanted.rgba[coloured])
        np.testing.assert_array_equal(made.rgba[coloured], wanted.rgba)
        for name in ("depth", "ids", "normals"):
            np.testing.assert_array_equal(getattr(made, name), getattr(wanted, name))
        # images belong to the users, who may write into them
        for array in made:
            array[...] = 0
        return wanted


@some
@given(
    seed=st.integers(0, 10**6), changes=st.lists(st.tuples(CHANGES, st.sampled_from([1e-7, 0.01, 1.0])), max_size=10)
)
def test_random_changes(build, seed, changes):
    stand = Stand(build, seed)
    stand.compare()
    for what, size in changes:
        stand.change(what, size)
        stand.compare()
    stand.compare()


def test_only_tiles_that_change_are_drawn(build):
    """A test of the method: most tiles are taken over, and what has moved is visible."""
    tiles = sum(-(-width // 32) * -(-height // 32) for width, height in SIZES)
    shares, shown = [], 0
    for seed in range(8):
        stand = Stand(build, seed)
        for _ in range(3):
            before = stand.compare()
        assert stand.drawn[-3:] == [tiles, tiles, 0]
        stand.change("pose", 0.3)
        shown += (stand.compare().rgba != before.rgba).any()
        shares.append(stand.drawn[-1] / tiles)
    assert 0.05 < np.mean(shares) < 0.7
    assert shown >= 6


def test_shadows_are_drawn_again(build):
    """Parts that no camera sees cast visible shadows, by each of the lamps."""
    changed = {"sun": 0, "lamp map": 0}
    for seed in range(12):
        stand = Stand(build, seed)
        for what in changed:
            for _ in range(2):
                before = stand.compare()
            if what == "sun":
                models = stand.poses.models.copy()
                # along the light: the shadow remains where it is, then it is gone
                models[MOVERS, 3::4] += 30 * stand.light.sun[8:11]
                stand.poses = Poses(models, stand.poses.turns)
                before = stand.compare()
                models = models.copy()
                models[MOVERS] = 0
                stand.poses = Poses(models, stand.poses.turns)
            else:
                stand.light = stand.light._replace(lamp_shadow=np.zeros_like(stand.light.lamp_shadow))
            changed[what] += (stand.compare().rgba != before.rgba).any()
    assert changed["sun"] >= 3
    assert changed["lamp map"] == 12
