"""Components and modifiers of installed packages, by entry points."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from morse.assets import search
from morse.core.classes import plugins

SONAR = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

class Sonar(Sensor):
    _name = "Sonar"
    _short_desc = "Measures a distance by sound"

    add_data("distance", 0.0, "float", "Distance", unit="m")
"""
DEAF = """
from morse.modifiers.abstract_modifier import AbstractModifier

class Deaf(AbstractModifier):
    _names = ("Deaf",)
    _components = ("Sonar",)
"""
USE = """
from morse.builder import *
robot = FakeRobot()
sonar = Sonar()
sonar.alter("Deaf")
robot.append(sonar)
env = Environment("empty", fastmode=True)
print([m.classpath for m in sonar._declaration(robot).modifiers], sonar.classpath, sonar.name)
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder with an installed package ``my_lab``."""
    for path, text in {
        "my_lab/__init__.py": "",
        "my_lab/sensors/sonar.py": SONAR,
        "my_lab/changes/deaf.py": DEAF,
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": (
            "[morse.components]\nmy_lab = my_lab\n\n[morse.modifiers]\nmy_lab = my_lab.changes\n"
        ),
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def run(site: Path, program: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", f"import sys; sys.path.append({str(site)!r})\n" + program]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_classes_of_an_installed_package_come_with_the_star_import(site: Path) -> None:
    done = run(site, USE)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "['my_lab.changes.deaf.Deaf'] my_lab.sensors.sonar.Sonar robot.sonar"


EYE = """
from morse.sensors.video_camera import VideoCamera
from .lens import Wide

class Eye(VideoCamera):
    _name = "Eye"

class Fisheye(Wide, Eye):
    _name = "Fisheye"
"""


def test_a_camera_of_an_installed_package_looks_ahead(site: Path) -> None:
    (site / "my_lab" / "sensors" / "eye.py").write_text(EYE)
    (site / "my_lab" / "sensors" / "lens.py").write_text("class Wide:\n    pass\n")
    done = run(
        site,
        "from morse.builder import *\n"
        "for own in Eye(), Fisheye(): print(list(own.scene_node.rotation_euler) == list("
        "VideoCamera().scene_node.rotation_euler), list(own.scene_node.rotation_euler) != [0, 0, 0])\n",
    )
    assert done.stdout.split() == ["True"] * 4, done.stderr


def test_a_broken_package_is_left_out_with_a_warning(site: Path) -> None:
    (site / "my_lab" / "sensors" / "sonar.py").write_text("class Sonar(:\n")
    (site / "my_lab" / "changes" / "deaf.py").write_text("def\n")
    done = run(site, "import logging; logging.basicConfig()\nfrom morse.builder import *\nPose().alter('Deaf')\n")
    assert "MorseBuilderError: there is no modifier 'Deaf'" in done.stderr
    assert "the components of the installed package 'my_lab' are left out" in done.stderr
    assert "the modifiers of my_lab.changes are left out" in done.stderr


def test_no_package_hides_a_class_of_morse(site: Path) -> None:
    (site / "my_lab" / "sensors" / "pose.py").write_text(SONAR.replace("Sonar", "Pose"))
    done = run(site, "import logging; logging.basicConfig()\nfrom morse.builder import *\nprint(Pose().classpath)\n")
    assert done.stdout.strip() == "morse.sensors.pose.Pose"
    assert "Pose of an installed package is left out" in done.stderr


def test_a_class_of_a_package_takes_the_place_of_one_of_a_plugin(site: Path) -> None:
    """The names of the plug-in and of its entry point come after those of the package in the alphabet."""
    (site / "my_lab" / "sensors" / "radar.py").write_text(SONAR.replace("Sonar", "Radar"))
    done = run(site, "from morse.builder import *\nprint(Radar().classpath, DVL().classpath)\n")
    assert done.stdout.split() == ["my_lab.sensors.radar.Radar", "morse.plugins.senses.sensors.dvl.DVL"], done.stderr


def test_a_package_whose_code_fails_is_left_out(site: Path) -> None:
    (site / "my_lab" / "__init__.py").write_text("1 / 0\n")
    done = run(site, "import logging; logging.basicConfig()\nfrom morse.builder import *\nprint(Pose().classpath)\n")
    assert done.stdout.strip() == "morse.sensors.pose.Pose"
    assert "ZeroDivisionError" in done.stderr


def with_models(site: Path, package: str) -> None:
    (site / "my_lab" / "data" / "robots").mkdir(parents=True)
    shutil.copy(
        Path(search.MORSE_COMPONENTS) / "robots" / "atrv.blend", site / "my_lab" / "data" / "robots" / "rover.blend"
    )
    points = site / "my_lab-1.0.dist-info" / "entry_points.txt"
    points.write_text(f"{points.read_text()}\n[morse.assets]\nmy_lab = {package}\n")


FIND = "import logging; logging.basicConfig()\nfrom morse.assets import find\nprint(find({!r}, 'robots'))\n"


def test_an_installed_package_brings_models(site: Path) -> None:
    with_models(site, "my_lab.data")
    done = run(site, FIND.format("rover"))
    assert done.stdout.strip() == str(site / "my_lab" / "data" / "robots" / "rover.blend"), done.stderr


def test_no_model_of_a_package_hides_one_of_morse(site: Path) -> None:
    with_models(site, "my_lab.data")
    (site / "my_lab" / "data" / "robots" / "atrv.blend").write_bytes(b"")
    done = run(site, FIND.format("atrv"))
    assert done.stdout.strip() == str(Path(search.MORSE_COMPONENTS) / "robots" / "atrv.blend"), done.stderr


@pytest.mark.parametrize("package", ["my_lab.no_such_folder", "no_such_package.data", "my_lab.sensors.sonar"])
def test_a_package_without_the_folder_of_its_models_is_named(site: Path, package: str) -> None:
    with_models(site, package)
    (site / "my_lab" / "sensors" / "__init__.py").write_text("")
    done = run(site, FIND.format("atrv"))
    assert done.stdout.strip().endswith("atrv.blend")
    assert f"the models of the installed package '{package}' are left out" in done.stderr


def test_entry_points_are_those_of_importlib(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib import metadata

    assert plugins.entry_points("morse.no_such_group") == ()
    monkeypatch.syspath_prepend(str(site))
    points = plugins.entry_points("morse.modifiers")
    assert set(metadata.entry_points(group="morse.modifiers")) <= set(points)
    assert "my_lab.changes" in [point.value for point in points]


@pytest.mark.parametrize("text", [b"[morse.modifiers]\nbroken\n", b"[morse.modifiers]\n\xff = a\n"])
def test_a_package_with_broken_entry_points_hides_no_others(site: Path, text: bytes) -> None:
    (site / "other-1.0.dist-info").mkdir()
    (site / "other-1.0.dist-info" / "entry_points.txt").write_bytes(text)
    done = run(site, f"import logging; logging.basicConfig()\n{USE}")
    assert "my_lab.sensors.sonar.Sonar" in done.stdout, done.stderr
    assert "other-1.0.dist-info are left out" in done.stderr


def test_a_package_that_was_half_removed_has_no_name(site: Path) -> None:
    (site / "my_lab-1.0.dist-info" / "METADATA").unlink()
    done = run(site, USE)
    assert "my_lab.sensors.sonar.Sonar" in done.stdout, done.stderr


def test_files_of_packages_are_read_once(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib import metadata

    monkeypatch.syspath_prepend(str(site))
    before = plugins.entry_points("morse.modifiers")
    # each sensor of a robot asks several times: 1,000 sensors of a description took seconds
    monkeypatch.setattr(metadata.PathDistribution, "read_text", lambda *_: pytest.fail("read again"))
    assert plugins.entry_points("morse.modifiers") == before
    # each scene has its folder on the path, and asks for all groups
    monkeypatch.syspath_prepend(str(site / "my_lab"))
    assert plugins.entry_points("morse.modifiers") == before
    assert "my_lab" in [point.name for point in plugins.entry_points("morse.components")]


def test_of_packages_with_one_name_the_first_one_counts(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(site))
    for version, text in {"My.Lab-2.0": "[morse.modifiers]\nnewer = my_lab.newer\n", "my_lab-0.5": ""}.items():
        place = site / version / f"{version}.dist-info"
        place.mkdir(parents=True)
        (place / "entry_points.txt").write_text(text)
        monkeypatch.syspath_prepend(str(site / version))
        from_here = [point.value for point in plugins.entry_points("morse.modifiers") if "my_lab" in point.value]
        assert from_here == (["my_lab.newer"] if text else [])


def test_a_project_with_endless_brackets_has_no_entry_points(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "pyproject.toml").write_text(f'"morse.x" = {"[" * 100_000}')
    monkeypatch.syspath_prepend(str(tmp_path / "src"))
    assert plugins.entry_points("morse.no_such_group") == ()


# -- files of the user with the name of a library --------------------------------------------------

# -P: only the folder of the script is on the path, as for the installed command
MORSE = (sys.executable, "-P", "-c", "import sys; from morse.cli import main; sys.exit(main())")
SCENE = """from morse.builder import *
import helper
robot = ATRV()
assert helper.TEXT == "of the user"
env = Environment("empty")
"""


NAMES = ["mujoco", "random", "mathutils", "morse"]
MORE = ["rich", "email", "test", "numpy", "scene"]


# a name of each kind, and others of the same kinds
@pytest.mark.parametrize("name", [*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)])
def test_a_script_may_be_called_like_any_library(name: str, tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("TEXT = 'of the user'\n")
    (tmp_path / "tempfile.py").write_text("raise RuntimeError('not the one of the standard library')\n")
    (tmp_path / f"{name}.py").write_text(SCENE)
    command = [*MORSE, "run", "--headless", "--duration", "0.1", f"{name}.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "[EXITING SIMULATION]" in done.stdout
