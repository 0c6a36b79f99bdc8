import pytest

from morse.testing.exceptions import MorseTestingError
from morse.testing.scripts import script_of_function, script_of_method

# ruff: noqa: F821, F841


class Scenes:
    def plain(self):
        """Has a documentation
        of two lines."""
        robot = Thing("a")
        env = Environment()

    # fmt: off
    def narrow(self):
      env = Environment()

    def text_at_the_margin(self):
        robot = Thing("""
no indentation here
""")
        env = Environment()

    def long_head(
        self,
    ) -> None:
        env = Environment()
        if env:
            pass

    def short(self): env = Environment()
    # fmt: on

    class Inner:
        def deep(self):
            env = Environment()


class Environment:
    def __init__(self):
        self.strategy = None

    def set_time_strategy(self, strategy):
        made.append(strategy)


made: list[str] = []


class TimeStrategies:
    BestEffort = "best effort"
    FixedSimulationStep = "fixed step"


@pytest.mark.parametrize(
    "method",
    [Scenes().plain, Scenes().narrow, Scenes().text_at_the_margin, Scenes().long_head, Scenes.Inner().deep],
)
def test_the_script_builds_the_scene_and_sets_the_time_mode(method) -> None:
    text = script_of_method(method, "FixedSimulationStep")
    assert text.startswith(
        "from morse.builder import *\nfrom morse.builder.actuators import *\nfrom morse.builder.sensors import *\n"
        "\nclass MyEnv():\n"
    )
    body = "\n".join(line for line in text.splitlines() if not line.startswith("from morse"))
    made.clear()
    names = {"Environment": Environment, "TimeStrategies": TimeStrategies, "Thing": str}
    exec(body, names)
    assert made == ["fixed step"]


def test_a_method_in_one_line_is_refused() -> None:
    with pytest.raises(MorseTestingError, match="several lines"):
        script_of_method(Scenes().short, "BestEffort")


def test_what_has_no_source_is_refused() -> None:
    names: dict[str, object] = {}
    exec("class A:\n    def setUpEnv(self):\n        env = 1\n", names)
    with pytest.raises(MorseTestingError, match="no source"):
        script_of_method(names["A"]().setUpEnv, "BestEffort")  # type: ignore[operator]


def scene_of_this_module() -> None:
    made.append("here")


def test_a_function_is_called_in_a_module_of_its_own() -> None:
    made.clear()
    text = script_of_function(scene_of_this_module)
    names: dict[str, object] = {}
    import sys

    before = sys.modules[__name__]
    try:
        exec(text, names)
        assert sys.modules[__name__] is names["module"]
    finally:
        sys.modules[__name__] = before
    assert names["module"].made == ["here"]  # type: ignore[attr-defined]
    assert made == []


def test_a_nested_function_is_refused() -> None:
    def nested() -> None: ...

    with pytest.raises(MorseTestingError, match="function of a module"):
        script_of_function(nested)
    with pytest.raises(MorseTestingError, match="function of a module"):
        script_of_function(lambda: None)
