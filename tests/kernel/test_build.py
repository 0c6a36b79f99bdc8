"""Compiling the kernel."""

import importlib.util
from pathlib import Path

import pytest

from morse.kernel import build, targets

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
HOST = targets.host()


@pytest.fixture
def needs_compiler():
    if importlib.util.find_spec("ziglang") is None:
        pytest.skip("ziglang is not installed")


def test_every_platform_has_libraries_of_its_own():
    names = [target.file_name(level) for target in targets.ALL for level in target.levels]
    assert len(set(names)) == len(names)
    assert {"linux-gnu-x86_64", "linux-musl-x86_64", "linux-gnu-aarch64", "macos-aarch64", "windows-x86_64"} <= {
        str(target) for target in targets.ALL
    }


# the compiler needs minutes for the C library of Windows
@pytest.mark.parametrize(
    "name",
    [
        "macos-aarch64",
        pytest.param("linux-musl-aarch64", marks=pytest.mark.slow),
        pytest.param("windows-x86_64", marks=pytest.mark.soak),
    ],
)
def test_it_compiles_for_other_platforms(needs_compiler, tmp_path, monkeypatch, name):
    monkeypatch.setattr(build, "_OPTIONS", ["-O1" if word == "-O3" else word for word in build._OPTIONS])
    (target,) = [target for target in targets.ALL if str(target) == name]
    starts = {"windows": b"MZ", "macos": b"\xcf\xfa\xed\xfe", "linux-musl": b"\x7fELF"}
    for library in build.build(target, tmp_path):
        assert library.read_bytes().startswith(starts[target.system])


@pytest.mark.skipif(HOST is None, reason="no kernel for this platform")
def test_it_is_compiled_again_only_when_the_sources_change(needs_compiler, tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(build, "_compile", lambda target, level, folder: calls.append(_touch(folder, target, level)))
    for _ in range(2):
        build.build(HOST, tmp_path)
    assert len(calls) == len(HOST.levels)
    (tmp_path / HOST.file_name(HOST.levels[0])).unlink()
    build.build(HOST, tmp_path)
    assert len(calls) == 2 * len(HOST.levels)


def _touch(folder, target, level):
    (folder / target.file_name(level)).write_bytes(b"")
    return level


@pytest.mark.skipif(HOST is None, reason="no kernel for this platform")
def test_a_mistake_in_c_is_shown(needs_compiler, tmp_path, monkeypatch):
    (tmp_path / "wrong.c").write_text("int wrong(void) { return nothing; }\n")
    monkeypatch.setattr(build, "SOURCES", tmp_path)
    # not linked: the compiler would compile its libraries first
    monkeypatch.setattr(build, "_OPTIONS", ("-c",))
    with pytest.raises(RuntimeError, match="nothing"):
        build.build(HOST, tmp_path / "lib")


@pytest.mark.skipif(HOST is None, reason="no kernel for this platform")
def test_a_wheel_is_for_one_platform_and_any_python(monkeypatch):
    pytest.importorskip("hatchling")
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    hook = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hook)
    built = []
    monkeypatch.setattr(build, "build", lambda target: built.append(target) or [Path("lib") / target.file_name(0)])
    data = {}
    hook.build_kernel(ROOT, data)
    assert built == [HOST]
    assert not data["pure_python"]
    assert data["tag"] == f"py3-none-{HOST.platform_tag}"
    assert data["force_include"] == {f"lib/{HOST.file_name(0)}": f"morse/kernel/lib/{HOST.file_name(0)}"}
    monkeypatch.setenv("MORSE_BUILD_TARGET", "windows-aarch64")
    hook.build_kernel(ROOT, data)
    assert data["tag"] == "py3-none-win_arm64"
    monkeypatch.setenv("MORSE_BUILD_TARGET", "amiga-68000")
    with pytest.raises(RuntimeError, match=r"amiga-68000.*linux-gnu-x86_64"):
        hook.build_kernel(ROOT, data)


def test_there_is_no_wheel_for_a_platform_without_a_kernel(monkeypatch):
    pytest.importorskip("hatchling")
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    hook = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hook)
    monkeypatch.setattr(targets, "host", lambda: None)
    with pytest.raises(RuntimeError, match="no native kernel for this platform"):
        hook.build_kernel(ROOT, {})
