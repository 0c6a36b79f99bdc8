"""What a release consists of: the checks of wheels find what would break on a user's machine."""

import sys
import zipfile
from pathlib import Path

import pytest

from morse.kernel import targets
from tests.kit.programs import python
from tools.release import arm64, contents, steps, wheels, wine

HOST = targets.host()
pytestmark = pytest.mark.skipif(HOST is None or not HOST.system.startswith("linux"), reason="reads the own library")
pytest.importorskip("lief")


def library(level: int) -> bytes:
    assert HOST is not None
    return (targets.FOLDER / HOST.file_name(level)).read_bytes()


def wheel(folder: Path, target: targets.Target, files: dict[str, bytes]) -> Path:
    path = folder / f"morse_simulator-2.0.0-py3-none-{target.platform_tag}.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def files_of(target: targets.Target) -> dict[str, bytes]:
    return {
        "morse/viewer/static/index.html": b"<html>",
        "morse/core/classes/definitions/classes.index": b"",
        **{contents.LIBRARIES + target.file_name(level): library(level) for level in target.levels},
    }


def test_the_tags_are_those_of_the_packaging_standards():
    tags = {str(target): target.platform_tag for target in targets.ALL}
    assert tags == {
        "linux-gnu-x86_64": "manylinux_2_17_x86_64",
        "linux-gnu-aarch64": "manylinux_2_17_aarch64",
        "linux-musl-x86_64": "musllinux_1_2_x86_64",
        "linux-musl-aarch64": "musllinux_1_2_aarch64",
        "macos-x86_64": "macosx_11_0_x86_64",
        "macos-aarch64": "macosx_11_0_arm64",
        "windows-x86_64": "win_amd64",
        "windows-aarch64": "win_arm64",
    }


def test_the_library_of_this_machine_passes():
    assert HOST is not None
    for level in HOST.levels:
        errors, functions = contents.inspect(library(level), HOST)
        assert errors == []
        assert "morse_layout" in functions


def test_a_sound_wheel_passes(tmp_path: Path):
    assert HOST is not None
    assert contents.verify([wheel(tmp_path, HOST, files_of(HOST))]) == []


def test_a_library_of_another_processor_is_named(tmp_path: Path):
    assert HOST is not None
    (other,) = (one for one in targets.ALL if one.system == HOST.system and one.machine != HOST.machine)
    data = library(HOST.levels[0])
    files = {contents.LIBRARIES + other.file_name(level): data for level in other.levels}
    errors = contents.verify([wheel(tmp_path, other, files_of(HOST) | files)])
    assert any("libraries" in error for error in errors)
    assert any(f"not for {other.machine}" in error for error in errors)


@pytest.mark.parametrize("missing", ["morse/viewer/static/index.html", "morse/core/classes/definitions/classes.index"])
def test_a_missing_file_is_named(tmp_path: Path, missing: str):
    assert HOST is not None
    files = {name: data for name, data in files_of(HOST).items() if name != missing}
    assert contents.verify([wheel(tmp_path, HOST, files)]) == [
        f"morse_simulator-2.0.0-py3-none-{HOST.platform_tag}.whl: {missing} is missing"
    ]


def test_a_wheel_has_the_files_of_the_repository_and_what_the_build_makes():
    """What happens to lie in the folder, such as the state of a build or a file of an editor, is not shipped."""
    builder = pytest.importorskip("hatchling.builders.wheel").WheelBuilder(str(wheels.ROOT))
    if not (wheels.ROOT / ".git").exists():
        pytest.skip("the sources are not a repository")
    stray = wheels.ROOT / "src" / "morse" / "viewer" / "static" / ".sources"
    if not stray.exists():
        pytest.skip("the page is not built")
    names = [file.distribution_path.replace("\\", "/") for file in builder.recurse_included_files()]
    assert contents.strays(names, wheels.sources()) == []


@pytest.mark.parametrize(
    "stray",
    ["morse/viewer/static/.sources", "morse/viewer/static/assets/.index-1.js.swp", "morse/notes.txt", "tests/x.py"],
)
def test_a_stray_file_is_named(tmp_path: Path, stray: str):
    assert HOST is not None
    (error,) = contents.verify([wheel(tmp_path, HOST, {**files_of(HOST), stray: b""})], [])
    assert f"{stray} is neither in the repository nor made by the build" in error
    (error,) = contents.verify([wheel(tmp_path, HOST, files_of(HOST))], ["morse/version.py"])
    assert "morse/version.py is missing" in error


def test_wheels_of_different_contents_are_named(tmp_path: Path):
    assert HOST is not None
    other = targets.Target("linux-musl" if HOST.system == "linux-gnu" else "linux-gnu", HOST.machine)
    libraries = {contents.LIBRARIES + other.file_name(level): library(level) for level in other.levels}
    rest = {name: data for name, data in files_of(HOST).items() if not name.startswith(contents.LIBRARIES)}
    one = wheel(tmp_path, HOST, files_of(HOST))
    two = wheel(tmp_path, other, libraries | rest | {"morse/version.py": b"another"})
    assert any("differs" in error and "morse/version.py" in error for error in contents.verify([one, two]))


def test_a_wheel_for_any_platform_is_refused(tmp_path: Path):
    path = tmp_path / "morse_simulator-2.0.0-py3-none-any.whl"
    zipfile.ZipFile(path, "w").close()
    assert "names no platform" in contents.verify([path])[0]


def test_other_bits_are_named(capsys: pytest.CaptureFixture[str]):
    assert arm64.compare("video 1 aa\ndepth 1 bb\n", "video 1 aa\ndepth 1 bb\n") == 0
    assert arm64.compare("video 1 aa\ndepth 1 bb\n", "video 1 aa\ndepth 1 cc\n") == 1
    assert "depth 1 bb" in capsys.readouterr().err
    assert arm64.compare("video 1 aa\n", "video 1 aa\ndepth 1 cc\n") == 1


def test_a_failed_step_shows_its_output(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    assert steps.run("good", [sys.executable, "-c", "print('done')"], tmp_path) == "done\n"
    assert steps.run("bad", [sys.executable, "-c", "import sys; sys.exit('out of paper')"], tmp_path) is None
    assert "out of paper" in capsys.readouterr().err


def test_all_functions_of_the_kernel_are_recorded():
    assert HOST is not None
    _, exported = contents.inspect(library(HOST.levels[0]), HOST)
    assert {line[len("FUNCTION(") :].partition(",")[0] for line in wine.functions().splitlines()} == exported


@pytest.mark.parametrize("command", ["arm64", "wine"])
def test_without_packages_of_debian_they_are_skipped_by_name(command: str, tmp_path: Path):
    program = (
        "import sys, shutil; shutil.which = lambda *words, **options: None;"
        "from tools import __main__; sys.exit(__main__.main(sys.argv[1:]))"
    )
    done = python("-c", program, command, folder=wheels.ROOT)
    assert done.returncode == 0
    assert "skipped: needs" in done.stderr
