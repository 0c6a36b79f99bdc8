"""Programs that draw with MuJoCo's own functions, without OpenGL."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
import pytest

import morse
from morse import eyes

if TYPE_CHECKING:
    from collections.abc import Iterator

_MODEL = (
    '<mujoco><worldbody><light pos="0 0 2"/><geom type="plane" size="0 0 1"/><camera name="c" pos="0 0 2"/>'
    '<geom name="ball" type="sphere" size=".3" rgba="1 0 0 1"/></worldbody></mujoco>'
)


@pytest.fixture
def state() -> tuple[Any, Any]:
    """A model and its state."""
    model = mujoco.MjModel.from_xml_string(_MODEL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture
def installed() -> Iterator[None]:
    """Functions that draw without OpenGL."""
    eyes.install()
    yield
    eyes.uninstall()


@pytest.mark.usefixtures("installed")
def test_functions_of_mujoco_draw_the_pictures_of_the_renderer(state: tuple[Any, Any]) -> None:
    model, data = state
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    viewport = mujoco.MjrRect(0, 0, 60, 40)
    with mujoco.Renderer(model, 40, 60) as renderer:
        assert isinstance(renderer, morse.Renderer)
        renderer.update_scene(data, "c")
        mujoco.mjr_render(viewport, renderer.scene, context)
        rgb, depth = np.zeros((40, 60, 3), np.uint8), np.zeros((40, 60), np.float32)
        mujoco.mjr_readPixels(rgb, depth, viewport, context)
        # OpenGL begins with the lowest row
        assert np.abs(rgb[::-1].astype(int) - renderer.render()).mean() < 1
        renderer.enable_depth_rendering()
        metres = renderer.render()
        near, far = (float(part) * model.stat.extent for part in (model.vis.map.znear, model.vis.map.zfar))
        assert near / (1 - depth[::-1] * (1 - near / far)) == pytest.approx(metres, rel=1e-3)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        mujoco.mjr_render(viewport, renderer.scene, context)
        mujoco.mjr_readPixels(rgb, None, viewport, context)
        assert rgb[20, 30].tolist() == [2, 0, 0]
        assert rgb[0, 0].tolist() == [1, 0, 0]
    with pytest.raises(ValueError, match="20 x 20 pixels from \\(60, 0\\) on, where mjr_render has drawn nothing"):
        mujoco.mjr_readPixels(rgb, None, mujoco.MjrRect(60, 0, 20, 20), context)
    context.free()
    with pytest.raises(RuntimeError, match="freed"):
        mujoco.mjr_render(viewport, renderer.scene, context)


@pytest.mark.usefixtures("installed")
def test_viewports_beside_each_other_are_read_together(state: tuple[Any, Any]) -> None:
    model, data = state
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)

    def read(*rect: int) -> tuple[Any, Any]:
        rgb, depth = np.zeros((rect[3], rect[2], 3), np.uint8), np.zeros((rect[3], rect[2]), np.float32)
        mujoco.mjr_readPixels(rgb, depth, mujoco.MjrRect(*rect), context)
        return rgb, depth

    def draw(*rect: int) -> tuple[Any, Any]:
        mujoco.mjr_render(mujoco.MjrRect(*rect), renderer.scene, context)
        return read(*rect)

    with mujoco.Renderer(model, 40, 60) as renderer:
        renderer.update_scene(data, "c")
        left = draw(0, 0, 30, 40)
        renderer.update_scene(data)
        right = draw(30, 10, 20, 20)
    for all_of, one, other in zip(read(0, 0, 60, 40), left, right, strict=True):
        assert np.array_equal(all_of[:, :30], one)
        assert np.array_equal(all_of[10:30, 30:50], other)
        # nothing was drawn there: black, and at the far plane
        assert np.all(all_of[:10, 30:] == (0 if all_of.ndim == 3 else 1))
    assert np.array_equal(read(5, 15, 10, 20)[0], left[0][15:35, 5:15])


def test_uninstall_gives_everything_back() -> None:
    names = ("MjrContext", "mjr_render", "Renderer")
    before = [getattr(mujoco, name) for name in names]
    eyes.install()
    eyes.install(look="morse")
    assert mujoco.MjrContext is not before[0]
    assert "mujoco.egl" in sys.modules
    eyes.uninstall()
    assert [getattr(mujoco, name) for name in names] == before
    with pytest.raises(ValueError, match="classic, morse"):
        eyes.install(look="cubist")


_GYMNASIUM = """
import sys, types
from morse import eyes
eyes.install()
# windows and films, which are not needed here
for name in ("glfw", "imageio"):
    sys.modules[name] = types.ModuleType(name)
sys.modules["glfw"].terminate = lambda: None
import gymnasium, numpy as np
env = gymnasium.make("HalfCheetah-v5", render_mode="rgb_array", width=64, height=48)
env.reset(seed=1)
picture = env.render()
assert picture.shape == (48, 64, 3) and picture.std() > 20, (picture.shape, picture.std())
env.step(env.action_space.sample())
assert not np.array_equal(env.render(), picture)
env.close()
print("drawn")
"""


def test_environments_of_gymnasium_draw_with_one_line_more() -> None:
    result = subprocess.run([sys.executable, "-c", _GYMNASIUM], capture_output=True, text=True, check=False)
    assert result.stdout.strip() == "drawn", result.stderr


_DM_CONTROL = """
from dm_control import suite
env = suite.load("cartpole", "swingup", task_kwargs={"random": 1})
env.reset()
first = env.physics.render(48, 64, camera_id=0)
for _ in range(10):
    env.step([1.0])
second = env.physics.render(48, 64, camera_id=0)
depth = env.physics.render(48, 64, camera_id=0, depth=True)
ids = env.physics.render(48, 64, camera_id=0, segmentation=True)
assert depth.shape == (48, 64) and 0 < depth.min() < depth.max()
assert ids.shape == (48, 64, 2) and len(np.unique(ids[..., 0])) > 2
env.physics.free()
"""
_ROBOSUITE = """
import robosuite
env = robosuite.make(
    "Lift", robots="Panda", has_renderer=False, has_offscreen_renderer=True, camera_names="agentview",
    camera_heights=48, camera_widths=64, camera_depths=True, seed=1,
)
seen = env.reset()
first, depth = seen["agentview_image"], seen["agentview_depth"]
for _ in range(3):
    seen, *_ = env.step(np.ones(env.action_dim))
second = seen["agentview_image"]
assert depth.shape == (48, 64, 1) and 0 < depth.min() < depth.max() <= 1
env.close()
"""


@pytest.mark.slow
@pytest.mark.parametrize("opengl", ["glfw", "egl", "osmesa"])
@pytest.mark.parametrize(
    ("packages", "script"),
    [
        (("mujoco==3.17.0", "dm_control==1.0.50"), _DM_CONTROL),
        (("mujoco==3.3.7", "robosuite==1.5.2"), _ROBOSUITE),
    ],
)
def test_packages_that_need_another_mujoco_draw_with_one_line_more(
    packages: tuple[str, ...], script: str, opengl: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    _draw(_environment(packages, tmp_path_factory), script, opengl, (48, 64, 3))


_ENVIRONMENT = """
import gymnasium
import {module}
gymnasium.register_envs({module})
env = gymnasium.make("{name}", render_mode="rgb_array", disable_env_checker=True)
env.reset(seed=1)
first = env.render().copy()
for _ in range(20):
    env.step(np.ones(env.action_space.shape, np.float32))
second = env.render().copy()
env.close()
"""
_PLAYGROUND = """
from types import SimpleNamespace
import mujoco
from mujoco_playground import registry
env = registry.load("CartpoleBalance")
data = mujoco.MjData(env.mj_model)
pictures = []
for angle in (0.0, 0.5):
    data.qpos[1] = angle
    mujoco.mj_forward(env.mj_model, data)
    pictures += env.render([SimpleNamespace(data=data)], height=48, width=64)
first, second = pictures
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("packages", "script"),
    [
        (("gym-aloha==0.1.5",), _ENVIRONMENT.format(module="gym_aloha", name="gym_aloha/AlohaInsertion-v0")),
        (
            ("gymnasium-robotics==1.4.2", "mujoco==3.8.1"),
            _ENVIRONMENT.format(module="gymnasium_robotics", name="FetchPickAndPlace-v4"),
        ),
        (
            ("myosuite==3.0.0", "mujoco==3.8.1"),
            _ENVIRONMENT.format(module="myosuite", name="myoElbowPose1D6MRandom-v0"),
        ),
        (("playground==0.2.0",), _PLAYGROUND),
    ],
)
def test_environments_of_packages_draw_with_one_line_more(
    packages: tuple[str, ...], script: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    _draw(_environment(packages, tmp_path_factory), script, "egl", None)


def _draw(python: str, script: str, opengl: str, shape: tuple[int, ...] | None) -> None:
    """Run a script that draws two pictures of one shape, in another environment."""
    source = Path(morse.__file__).parents[1]
    check = (
        f"assert first.shape == second.shape == ({shape} or first.shape) and first.std() > 10\n"
        "assert not np.array_equal(first, second)\n"
        "assert sys.modules['mujoco'].MjrContext.__module__ == 'morse.eyes.opengl'\nprint('drawn')\n"
    )
    result = subprocess.run(
        [python, "-c", "import sys\nimport numpy as np\nfrom morse import eyes\neyes.install()\n" + script + check],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(source), "MUJOCO_GL": opengl},
    )
    assert result.stdout.strip().endswith("drawn"), result.stderr[-2000:]


_environments: dict[tuple[str, ...], str] = {}


def _environment(packages: tuple[str, ...], folders: pytest.TempPathFactory) -> str:
    """An environment with some packages, and its Python."""
    if packages in _environments:
        return _environments[packages]
    folder = folders.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = next(path for path in (folder / "bin" / "python", folder / "Scripts" / "python.exe") if path.exists())
    subprocess.run([python, "-m", "pip", "install", "-q", *packages], check=True)
    _environments[packages] = str(python)
    return str(python)


@pytest.mark.usefixtures("installed")
def test_modules_of_contexts_name_what_they_have_not() -> None:
    contexts = sys.modules["robosuite.renderers.context.egl_context"]
    contexts.EGLGLContext(max_width=8, max_height=8, device_id=0).make_current()
    with pytest.raises(AttributeError, match=r"egl_context.*EGL_DISPLAY.*morse\.eyes\.install"):
        _ = contexts.EGL_DISPLAY


@pytest.mark.parametrize("version", ["2.3.7", "3.2.7", "4.1.0", "5.0.0", "11.2", "abc", None])
def test_other_versions_of_mujoco_are_told(version: str | None) -> None:
    named = "incomplete" if version is None else f"installed is {version}"
    with pytest.raises(ImportError, match=rf'from 3\.3 to before 4\.1; .*{named}.*pip install "mujoco>=3\.3,<4\.1"'):
        eyes.check_version(version)


@pytest.mark.parametrize("version", ["3.3.0", "3.10.0", "3.17.0", "4.0.1", "4.0.2rc1", mujoco.__version__])
def test_versions_that_are_supported_pass(version: str) -> None:
    eyes.check_version(version)


def test_the_version_is_checked_before_its_names_are_used(tmp_path: Path) -> None:
    (tmp_path / "mujoco").mkdir()
    (tmp_path / "mujoco" / "__init__.py").write_text('__version__ = "3.2.7"\n')
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import morse; morse.Renderer"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    last = result.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: morse.eyes")
    assert str(tmp_path) in last
