"""The expressions of a file of xacro compute values: they execute, write and read nothing else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import pytest

from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.urdf.xacro_limits import evaluate

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("xacro")
HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>'
_IMPORT = "'_'+'_import_'+'_'"
#: the frame of xacro itself, through a generator that looks at its own frame
FRAMES = (
    "[(y:=[]), y.append((x.gi_frame.f_back.f_back for x in y)), y.append(y[0]), "
    f"[f.f_back.f_builtins[{_IMPORT}]('os').system('touch mark') for f in y[0]]][3]"
)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "package"
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "secret.yaml").write_text("secret: 12345")
    (tmp_path / "secret.xacro").write_text("<robot><link name='secret'/></robot>")
    (folder / "link.xacro").symlink_to(tmp_path / "secret.xacro")
    os.mkfifo(folder / "pipe")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize(
    "more",
    [
        f"<link name={quoteattr('${' + FRAMES + '}')}/>",
        "<link name=\"${python.vars(python.type)['_' + '_subclasses_' + '_']}\"/>",
        "<link name=\"$(eval exec('import os; os.system(&quot;touch mark&quot;)'))\"/>",
        "<link name=\"${xacro.load_yaml('../secret.yaml')}\"/>",
        "<link name=\"${xacro.load_yaml('/dev/zero')}\"/>",
        '<xacro:include filename="../secret.xacro"/>',
        '<xacro:include filename="link.xacro"/>',
        '<xacro:include filename="pipe"/>',
        '<xacro:include filename="r.urdf.xacro"/>',
    ],
)
def test_a_file_executes_writes_and_reads_nothing_outside_of_its_package(package: Path, more: str) -> None:
    before = {*package.iterdir()}
    file = package / "r.urdf.xacro"
    file.write_text(f"{HEAD}{more}</robot>")
    try:
        names = str([node.name for root in load(file).roots for node in root.walk()])
    except AssetError as refusal:
        names = str(refusal)
    assert "12345" not in names
    assert "'secret'" not in names
    assert {*package.iterdir()} == before | {file}


@pytest.mark.parametrize(
    "expression",
    [
        FRAMES,
        "().__class__",
        "(lambda: (lambda: ().__class__)())()",
        "[c.gi_code for c in [(x for x in ())]]",
        "(lambda: (yield))().gi_frame",
        "__import__('os')",
        "math.__loader__",
    ],
)
def test_inner_parts_of_python_have_no_names(expression: str) -> None:
    with pytest.raises(ValueError, match="an expression cannot use '"):
        evaluate(expression, {})


@pytest.mark.parametrize("expression", ["open('mark', 'w')", "exec('1')", "vars()", "getattr(1, 'real')"])
def test_built_in_functions_are_those_of_values(expression: str) -> None:
    with pytest.raises(NameError):
        evaluate(expression, {})


def test_expressions_of_real_files_have_their_values(package: Path) -> None:
    (package / "sizes.yaml").write_text("arm: {length: 0.7}")
    values = {
        "${xacro.load_yaml('sizes.yaml').arm.length}": 0.7,
        "$(eval 1 + 2)": 3.0,
        "${round(sin(pi / 2)) + len([x for x in python.range(3)])}": 4.0,
        "${'%.2f' % 0.5}": 0.5,
        "${max(map(lambda x: x * x, [1, 3]))}": 9.0,
    }
    file = package / "r.urdf.xacro"
    file.write_text(
        HEAD
        + "".join(
            f'<link name="l{number}"/><joint name="j{number}" type="continuous"><parent link="base"/>'
            f'<child link="l{number}"/><origin xyz={quoteattr("0 0 " + text)}/></joint>'
            for number, text in enumerate(values)
        )
        + "</robot>"
    )
    bones = load(file).roots[0].children[0].bones
    assert [bone.position[2] for bone in bones] == pytest.approx([*values.values()])
