"""What the documentation says about installing works, although no index of packages has MORSE."""

import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
import yaml
from doc_pages import DOCS, PAGES, ROOT, blocks

from morse.system import extras

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_packages_of_an_extra_are_those_of_the_metadata(extra: str):
    assert extras.packages(extra) == EXTRAS[extra]
    assert extras.install(extra) == "pip install " + " ".join(f'"{word}"' for word in EXTRAS[extra])


@pytest.mark.parametrize(
    "line",
    [
        "paho-mqtt<3,>=2; extra == 'mqtt'",
        'paho-mqtt (>=2,<3) ; extra == "mqtt"',
        "paho-mqtt >= 2, < 3; python_version >= '3.11' and extra == 'mqtt'",
    ],
)
def test_metadata_of_all_builders_is_understood(line: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(metadata, "requires", lambda name: ["numpy>=1.26", "x>=1; extra == 'mqtts'", line])
    assert extras.packages("mqtt") == ["paho-mqtt>=2,<3"]


def test_sources_that_are_not_installed_have_a_line_as_well(monkeypatch: pytest.MonkeyPatch):
    def missing(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", missing)
    assert extras.install("mqtt") == 'pip install ".[mqtt]" in a copy of MORSE\'s sources'


def test_nobody_is_told_to_install_what_no_index_has():
    """Neither by a page nor by a message: an index may have anything under that name."""
    told = re.compile(rf"(?:pip install|pip download|uvx|uv add)[^`\n]*\b{extras.NAME}\b")
    texts = [*PAGES, ROOT / "SECURITY.md", ROOT / "RELEASING.md", ROOT / "Containerfile", *ROOT.glob("examples/**/*.*")]
    texts += [*(ROOT / "src").rglob("*.py"), *(ROOT / "viewer/src").rglob("*.ts")]
    found = {path.name: told.findall(path.read_text(encoding="utf-8", errors="replace")) for path in texts}
    # from a folder of wheels, and from nowhere else
    assert not [(name, one) for name, lines in found.items() for one in lines if "--no-index --find-links" not in one]


def test_pages_name_the_versions_of_the_extras():
    requirements = {re.split(r"[<>=]", word)[0]: word for words in EXTRAS.values() for word in words}
    for page in PAGES:
        for name, version in re.findall(r'"([\w-]+)([<>=][^"\s]*)"', page.read_text(encoding="utf-8")):
            if name in requirements:
                assert name + version == requirements[name], page.name


def workflows() -> list[dict]:
    return [yaml.safe_load(block.text) for block in blocks("yaml") if block.page == DOCS / "ci.md"]


def test_the_commands_of_the_page_are_those_of_its_workflow():
    (job,) = workflows()[0]["jobs"].values()
    (shown,) = [block.text for block in blocks("sh") if block.page == DOCS / "ci.md"]
    assert shown.splitlines() == [step["run"] for step in job["steps"] if "run" in step]


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_the_workflow_of_the_page_runs(tmp_path: Path):
    """Its commands in a project with the first test of the page on tests, and a copy of the sources as `morse`."""
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["morse.testing.fixtures"]\n')
    test = next(
        block.text for block in blocks("python") if block.page == DOCS / "testing.md" and "simulate" in block.text
    )
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_drive.py").write_text(test)
    subprocess.run(["git", "clone", "-q", str(ROOT), str(tmp_path / "morse")], check=True)
    (job,) = workflows()[0]["jobs"].values()
    for step in job["steps"]:
        if "run" in step:
            done = subprocess.run(["bash", "-ec", step["run"]], cwd=tmp_path, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    assert "1 passed" in done.stdout
    assert sys.prefix not in done.stdout
