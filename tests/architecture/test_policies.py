"""Files for other programs and for maintainers are valid, and say what holds."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import typer
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from morse.cli.app import app
from morse.middleware.socket.frames import VERSION as FRAMES
from morse.physics.state.saved import VERSION as STATES
from morse.recording.recorder import PRESENT as RECORDINGS
from morse.version import __version__
from morse.viewer.protocol import VERSION as PAGE

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("schema", "files"),
    [
        ("vendor.github-workflows", sorted((ROOT / ".github/workflows").glob("*.yml"))),
        ("vendor.github-issue-forms", sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml"))),
        ("vendor.citation-file-format", [ROOT / "CITATION.cff"]),
    ],
)
def test_files_of_the_forge_have_their_schemas(schema: str, files: list[Path]):
    pytest.importorskip("check_jsonschema")
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_workflows_of_the_documentation_have_their_schema(tmp_path: Path):
    pages = [block.partition("```")[0] for block in (ROOT / "docs/ci.md").read_text().split("```yaml\n")[1:]]
    assert len(pages) == 2
    for number, page in enumerate(pages):
        (tmp_path / f"{number}.yml").write_text(page)
    test_files_of_the_forge_have_their_schemas("vendor.github-workflows", sorted(tmp_path.glob("*.yml")))


def test_workflows_run_scripts_that_exist():
    text = "".join(path.read_text() for path in (ROOT / ".github/workflows").glob("*.yml"))
    scripts = set(re.findall(r"run: (\.ci/\w+)", text))
    assert {".ci/run", ".ci/nightly", ".ci/gate"} <= scripts
    for script in scripts:
        assert (ROOT / script).stat().st_mode & 0o111, f"{script} cannot be executed"


WORKFLOWS = "".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / ".github/workflows").glob("*.yml")))


def test_workflows_run_no_code_of_others():
    """A tag or a branch of an action is moved by others, and the job of a release may publish."""
    assert re.findall(r"\buses:.*", WORKFLOWS) == []


def test_the_jobs_of_a_release_install_nothing_without_its_hash():
    text = (ROOT / ".github/workflows/release.yml").read_text(encoding="utf-8")
    installs = [line for line in text.splitlines() if "install" in line and not line.startswith("#")]
    assert len(installs) == 3
    assert all("pip install -q --require-hashes -r .ci/release.txt" in line for line in installs)
    build = (ROOT / "tools/release/wheels.py").read_text(encoding="utf-8")
    assert '"--require-hashes"' in build


def _locked(name: str) -> dict[str, set[str]]:
    """The versions of a lock by the names of their packages; each has hashes."""
    text = (ROOT / ".ci" / name).read_text(encoding="utf-8")
    found: dict[str, set[str]] = {}
    for entry in re.split(r"^(?=[\w.-]+==)", text, flags=re.MULTILINE)[1:]:
        package, version = re.match(r"([\w.-]+)==(\S+)", entry).groups()
        assert re.search(r"--hash=sha256:[0-9a-f]{64}\b", entry), package
        found.setdefault(package, set()).add(version)
    return found


def test_the_locks_have_what_a_release_needs():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    needed = {
        "build.txt": project["build-system"]["requires"],
        "release.txt": [
            *project["project"]["dependencies"],
            *(w for w in project["dependency-groups"]["release"] if isinstance(w, str)),
        ],
    }
    for name, requirements in needed.items():
        locked = _locked(name)
        for requirement in map(Requirement, requirements):
            versions = locked.get(canonicalize_name(requirement.name), set())
            assert versions, f".ci/{name} lacks {requirement}: run .ci/lock"
            assert all(version in requirement.specifier for version in versions), f"{requirement}: run .ci/lock"


def test_the_policy_names_the_present_formats():
    text = (ROOT / "docs/policy.md").read_text(encoding="utf-8")
    numbers = dict(re.findall(r"^\| ([a-z ]+) \| (\d+) \|", text, re.MULTILINE))
    assert numbers == {
        "recordings": str(RECORDINGS),
        "saved states": str(STATES),
        "protocol of the live view": str(PAGE),
        "frames of pictures over the socket": str(FRAMES),
    }


def test_the_citation_has_the_version_and_the_date_of_the_changelog():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    facts = dict(re.findall(r"^(version|date-released): (.+)$", citation, re.MULTILINE))
    assert __version__.startswith(facts["version"])
    top = re.search(r"^## (\S+) \((.+)\)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert top is not None
    if __version__ == top[1]:
        assert facts == {"version": top[1], "date-released": top[2]}
    else:
        assert (__version__, top[2]) == (f"{top[1]}.dev0", "not released")


def test_the_changelog_begins_with_what_users_have_to_do():
    section = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1]
    short, separator, _ = section.partition("\n### All changes\n")
    assert separator
    assert short.count("\n") <= 60
    assert re.findall(r"^> \*\*(\w+)\*\*", short, re.MULTILINE) == ["Breaking", "Migration"]


def test_the_container_runs_with_options_that_exist():
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    command = json.loads(text.partition("\nCMD ")[2])
    run = typer.main.get_command(app).get_command(None, command[0])  # type: ignore[attr-defined]
    names = {name for parameter in run.params for name in (*parameter.opts, *parameter.secondary_opts)}
    assert {word for word in command if word.startswith("--")} <= names
    assert command[command.index("--view-port") + 1] in text.partition("\nEXPOSE ")[2].split()
    assert text.index("\nUSER morse") < text.index("\nENTRYPOINT")


def test_the_container_listens_to_this_machine_alone_and_installs_the_wheel_that_it_is_given():
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    assert "--host" not in json.loads(text.partition("\nCMD ")[2])
    (installed,) = re.findall(r"pip install (.*?) ?\\?$", text, re.MULTILINE)
    words = [word for word in installed.split() if not word.startswith("--")]
    assert words == ["/tmp/wheels/*.whl"], "by a name, an index could offer a newer version"
    assert not {"--find-links", "--extra-index-url", "--index-url"} & set(installed.split())


def test_the_package_has_a_program_of_its_name():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["scripts"][project["name"]] == project["scripts"]["morse"]
