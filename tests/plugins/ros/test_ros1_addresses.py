"""On which networks the node of rospy listens; rospy itself need not be installed."""

import logging
import socket

import pytest

from morse.plugins.ros.node import stay_on_this_machine


@pytest.mark.parametrize(
    "master",
    [
        None,
        "http://localhost:11311",
        "http://127.0.0.1:11311/",
        "http://[::1]:11311",
        f"http://{socket.gethostname()}:1",
    ],
)
def test_a_node_of_a_local_master_listens_on_the_loopback_interface(master: str | None) -> None:
    variables = {} if master is None else {"ROS_MASTER_URI": master}
    stay_on_this_machine(variables)
    assert variables["ROS_IP"] == "127.0.0.1"


@pytest.mark.parametrize("name", ["ROS_IP", "ROS_HOSTNAME"])
def test_an_address_that_the_user_has_chosen_stays(name: str) -> None:
    variables = {name: "192.0.2.7"}
    stay_on_this_machine(variables)
    assert variables == {name: "192.0.2.7"}


def test_a_remote_master_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    variables = {"ROS_MASTER_URI": "http://192.0.2.1:11311"}
    stay_on_this_machine(variables)
    assert "ROS_IP" not in variables
    assert "192.0.2.1" in caplog.text
