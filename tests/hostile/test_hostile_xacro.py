"""The expressions of a file of xacro compute values: they execute, write and read nothing else."""

import json
import os
import subprocess
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.urdf.xacro_program import evaluate

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


REFUSED = (
    FRAMES,
    "().__class__",
    "(lambda: (lambda: ().__class__)())()",
    "[c.gi_code for c in [(x for x in ())]]",
    "(lambda: (yield))().gi_frame",
    "__import__('os')",
    "math.__loader__",
    "'{0.__globals__[os].environ}'.format(xacro.load_yaml)",
    "'{0.__class__}'.format('')",
    "'{x[0]}'.format(x=[1])",
    "'{:{0.real}}'.format(1)",
    "str.format('{0.__globals__}', xacro.load_yaml)",
    "'{0.real}'.format_map({'0': 1})",
    "list(map(str.format, ['{0.__globals__}'], [xacro.load_yaml]))",
    "f'{xacro.load_yaml.__globals__}'",
    "f'{1:{().__class__}}'",
    "xacro.load_yaml.func_globals",
    "xacro.tokenize.f",
    "(y := 1)",
    "[y for x in [1] if (y := x)]",
    "(lambda: (yield from ()))()",
    "(lambda _x: 1)(2)",
    "{**{}, 'a': ().__doc__}",
    "[*().__dir__()]",
    "print.__self__",
    "type(type(1))('X', (), {})",
    "type(lambda: 1)",
    "python.type(xacro)",
    "python.type(python.type)",
    "'a'.encode()",
    "str.maketrans('a', 'b')",
    "[].append",
    "[].sort",
    "{}.update",
    "{}.pop",
    "(1).to_bytes",
    "(1.0).hex",
    "int.from_bytes",
    "dict.fromkeys",
    "sin.real",
    "(x for x in [1]).gi_yieldfrom",
    "(lambda: 1).func_code",
    "xacro.arg.gi_frame",
    "len([].clear.x)",
)


#: a process of its own, since xacro is limited for good
PROGRAM = """import json, sys, xacro
from pathlib import Path
from morse.assets.urdf.xacro_program import evaluate, limit
limit(Path('x'), [], {})
for text in json.load(sys.stdin):
    try:
        print(json.dumps(repr(evaluate(text, dict(xacro._global_symbols)))))
    except Exception as error:
        print(json.dumps(f"{type(error).__name__}: {error}"))
"""


@pytest.fixture(scope="module")
def answers() -> dict[str, str]:
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM], input=json.dumps(REFUSED), capture_output=True, text=True, check=True
    )
    return dict(zip(REFUSED, map(json.loads, run.stdout.splitlines()), strict=True))


@pytest.mark.parametrize("expression", REFUSED)
def test_what_is_not_listed_is_refused_by_name(expression: str, answers: dict[str, str]) -> None:
    # a name that does not exist is refused by Python, and a function without members by what reads them
    assert answers[expression].startswith(("ValueError: an expression cannot use '", "NameError: "))


def test_the_environment_of_the_user_is_not_read(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOKEN", "12345")
    for number, attack in enumerate(("$(env TOKEN)", "$(optenv TOKEN none)")):
        for suffix in (".urdf", ".urdf.xacro"):
            file = package / f"r{number}{suffix}"
            file.write_text(f'{HEAD}<link name="{attack}"/><joint name="j" type="fixed"><parent link="base"/>'
                            f'<child link="{attack}"/></joint></robot>')  # fmt: skip
            try:
                text = str([node.name for root in load(file).roots for node in root.walk()])
                assert "none" in text
            except AssetError as refusal:
                text = str(refusal)
                assert "arguments={'TOKEN': ...}" in text
            assert "12345" not in text
            # what the script gives is no secret
            names = [node.name for root in load(file, {"TOKEN": "given"}).roots for node in root.walk()]
            assert "given" in str(names)


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
        "${dict(a=[0.5])['a'][0] if 'a'.upper() == 'A' and python.isinstance(1, int) else 2}": 0.5,
        "${python.sum([x for x, y in python.zip([1, 2], 'ab') if y in ('a',)] + ['2'.count('2')])}": 2.0,
        "${sorted([3, 1], key=lambda x: -x)[-1] + xacro.dotify(dict(arm=dict(length=2))).arm.length}": 3.0,
        "${len(xacro.tokenize('a b')) ** 2 // 3}": 1.0,
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
