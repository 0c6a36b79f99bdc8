"""What commands say about options, arguments and files that they cannot use."""

import pytest


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("run --headles proj", ["There is no option '--headles'. Did you mean '--headless'?", "`morse run -h`"]),
        ("--vresion", ["There is no option '--vresion'. Did you mean '--version'?", "`morse -h`"]),
        ("demo --list", ["There is no option '--list'. (`morse demo -h`"]),
        ("run --view-port x proj", ["--view-port takes an integer, not 'x'."]),
        ("run --seed=1.5 proj", ["--seed takes an integer, not '1.5'."]),
        ("run --seed", ["--seed takes an integer: none was given.", "`morse run -h`"]),
        ("run --headless=3 proj", ["--headless takes no value.", "`morse run -h`"]),
        ("verify --ticks 0 proj", ["--ticks takes an integer of at least 1, such as 600; got 0."]),
        ("render --time -1 proj", ["--time takes a number of at least 0, not '-1'."]),
        ("replay --view-port 99999 a.mcap", ["--view-port takes an integer from 0 to 65535, not '99999'."]),
        ("demo laser x", ["There is one argument too many: x."]),
        ("create a b c", ["There are too many arguments: b c."]),
        ("create", ["Missing argument 'env'", "`morse create -h`"]),
        ("help", ["`morse -h`", "`morse COMMAND -h`"]),
    ],
)
def test_what_was_given_and_what_was_expected(morse, line, told) -> None:
    answer = morse(*line.split())
    assert answer.status == 2
    assert answer.err.count("\n") == 1
    for text in told:
        assert text in answer.err


@pytest.mark.parametrize(
    "line",
    [
        "replay rnu.mcap",
        "replay rnu.mcap --resimulate",
        "export rnu.mcap --csv",
        "export rnu.mcap --mcap",
        "export rnu.mcap --film",
        "export rnu.mcap --html a.html",
        "check rnu.urdf",
        "import-world rnu.sdf",
        "sweep rnu.py",
    ],
)
def test_a_misspelt_file_gets_the_nearest_one(morse, line) -> None:
    name = line.split()[1]
    nearest = name.replace("rnu", "run")
    morse.directory.joinpath(nearest).touch()
    answer = morse(*line.split())
    assert answer.status == 1
    assert answer.err == f"* There is no file {name}. Did you mean '{nearest}'?\n"


@pytest.mark.parametrize("line", ["replay .", "export . --csv", "import-world .", "sweep ."])
def test_a_folder_is_no_file(morse, line) -> None:
    answer = morse(*line.split())
    assert answer.status == 1
    assert answer.err == "* . is a folder, not a file.\n"


def test_a_question_ends_with_its_mark(morse) -> None:
    answer = morse("check", "component", "Poes")
    assert answer.err.endswith("did you mean 'Pose'?\n")
