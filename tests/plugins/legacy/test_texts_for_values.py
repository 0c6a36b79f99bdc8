"""Properties and options whose numbers and truth values are texts, as scripts of MORSE 1.4 have them."""

import logging

import pytest

from morse.builder import ATRV, GPS, Battery, Environment, Pose, SemanticCamera
from morse.core.validation import PropertyError


def test_a_text_for_a_number(caplog: pytest.LogCaptureFixture) -> None:
    battery = Battery()
    with caplog.at_level(logging.WARNING):
        battery.properties(DischargingRate="25.0")
    assert battery.property_value("DischargingRate") == 25.0
    assert "takes a number, got the text '25.0'; write 25" in caplog.text


@pytest.mark.parametrize(("text", "value"), [("True", True), ("no", True), ("", False)])
def test_a_text_for_a_truth_value(text: str, value: bool, caplog: pytest.LogCaptureFixture) -> None:
    camera = SemanticCamera()
    camera.properties(relative=text)
    assert camera.property_value("relative") is value
    assert f"write {value}" in caplog.text


@pytest.mark.parametrize("text", ["", "fast", "1,5", "nan"])
def test_a_text_without_a_number_is_still_refused(text: str) -> None:
    with pytest.raises(PropertyError, match="DischargingRate"):
        Battery().properties(DischargingRate=text)


def test_a_number_outside_of_the_range_is_refused_as_a_text_too() -> None:
    with pytest.raises(PropertyError, match="DischargingRate"):
        Battery().properties(DischargingRate="-1")


def test_a_text_that_is_meant_stays_a_text() -> None:
    camera = SemanticCamera()
    camera.properties(tag="5")
    assert camera.property_value("tag") == "5"


def test_options_of_modifiers(caplog: pytest.LogCaptureFixture) -> None:
    pose = Pose()
    pose.alter("Noise", pos_std="0.05", _2D="True")
    (modifier,) = pose._modifiers
    assert modifier.options == {"pos_std": 0.05, "_2D": True}
    assert "write 0.05" in caplog.text


def test_properties_of_the_world(caplog: pytest.LogCaptureFixture) -> None:
    robot = ATRV("robot")
    robot.append(GPS("gps"))
    env = Environment("empty", fastmode=True)
    env.properties(longitude="1.43", latitude=43.6, altitude="135", note="7")
    assert env.environment_properties == {"longitude": 1.43, "latitude": 43.6, "altitude": 135.0, "note": "7"}
    assert "env.properties(longitude) takes a number" in caplog.text
