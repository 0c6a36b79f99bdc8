"""Services: declaration, calls, interruption, refusal."""

import pytest

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import (
    MorseMethodNotFoundError,
    MorseRPCNbArgsError,
    MorseRPCTypeError,
    MorseServiceAlreadyRunningError,
)
from morse.core.request_manager import MorseServices, RequestManager
from morse.core.services import async_service, interruptible, noninterruptible, service


class Arm(AbstractObject):
    def name(self):
        return "arm"

    @service
    def get(self, a, b=2):
        return [a, b]

    @service(name="renamed")
    def original(self):
        return "here"

    @service(component="elsewhere")
    def far(self):
        return 1

    @interruptible
    @async_service
    def move(self, target):
        self.target = target

    @noninterruptible
    @async_service
    def press(self):
        pass

    @async_service
    def broken(self):
        raise ValueError("no arm")


class Manager(RequestManager):
    title = "Test manager"

    def __init__(self):
        super().__init__()
        self.ended = []

    def initialization(self):
        return True

    def finalization(self):
        return True

    def main(self):
        pass

    def on_service_completion(self, request_id, result):
        self.ended.append((request_id, result))


@pytest.fixture
def arm():
    return Arm()


@pytest.fixture
def manager(arm):
    services = MorseServices()
    made = Manager()
    services.add_request_manager(made)
    services.register_request_manager_mapping("arm", made.classpath)
    services.register_object("arm", arm)
    return made


def test_every_declared_service_is_offered(manager):
    assert set(manager.services()["arm"]) == {"get", "renamed", "move", "press", "broken"}
    assert manager.services()["elsewhere"] == ["far"]


def test_services_leave_with_their_object_not_with_its_name(manager, arm):
    """Two objects offer services under one name: a robot of a script, and a pseudo component."""

    class Other(AbstractObject):
        @service
        def own(self):
            return "mine"

        def name(self):
            return "arm"

    services, other = MorseServices([manager]), Other()
    services.register_request_manager_mapping("arm", manager.classpath)
    services.register_object("arm", other)
    services.unregister(other)
    assert manager.find("arm", "own") is None
    assert manager.find("arm", "get") is not None
    assert services.managers_of("arm") == [manager]
    services.register_object("arm", other)
    services.unregister(arm)
    assert manager.services() == {"arm": ["own"]}


def test_a_service_answers_at_once(manager):
    assert manager.on_incoming_request("arm", "get", [1]) == (True, (status.SUCCESS, [1, 2]))
    assert manager.on_incoming_request("arm", "renamed", None) == (True, (status.SUCCESS, "here"))


def test_an_asynchronous_service_answers_when_it_is_done(manager, arm):
    done, request = manager.on_incoming_request("arm", "move", [3])
    assert not done
    manager.update()
    assert manager.ended == []
    arm.completed(status.SUCCESS, "there")
    manager.update()
    assert manager.ended == [(request, (status.SUCCESS, "there"))]


@pytest.mark.parametrize("state", ["done", 1, None, ("SUCCESS",), "success"])
def test_a_service_that_ends_with_another_status_has_failed(manager, arm, state):
    _, request = manager.on_incoming_request("arm", "move", [3])
    arm.completed(state, "there")
    manager.update()
    ((_, (outcome, text)),) = manager.ended
    assert outcome == status.FAILED
    assert "the service move ended with" in text
    assert "SUCCESS, FAILED, PREEMPTED" in text
    assert manager.ended[0][0] == request


def test_a_new_call_preempts_an_interruptible_one(manager, arm):
    _, first = manager.on_incoming_request("arm", "move", [1])
    _, second = manager.on_incoming_request("arm", "move", [2])
    manager.update()
    assert manager.ended == [(first, (status.PREEMPTED, None))]
    arm.completed(status.SUCCESS)
    manager.update()
    assert manager.ended[-1][0] == second


def test_a_new_call_is_refused_while_a_noninterruptible_one_runs(manager):
    manager.on_incoming_request("arm", "press", [])
    with pytest.raises(MorseServiceAlreadyRunningError):
        manager.on_incoming_request("arm", "press", [])


def test_a_cancelled_call_is_preempted(manager):
    _, request = manager.on_incoming_request("arm", "move", [1])
    manager.abort_request(request)
    manager.update()
    assert manager.ended == [(request, (status.PREEMPTED, None))]


def test_an_exception_leaves_the_component_free(manager, arm):
    with pytest.raises(ValueError, match="no arm"):
        manager.on_incoming_request("arm", "broken", [])
    assert arm.on_completion is None
    assert manager.on_incoming_request("arm", "move", [1])[0] is False


def test_wrong_arguments_are_refused_by_number(manager):
    with pytest.raises(MorseRPCNbArgsError, match="wrong # of parameters"):
        manager.on_incoming_request("arm", "get", [1, 2, 3])
    with pytest.raises(MorseRPCNbArgsError, match="parameters are expected"):
        manager.on_incoming_request("arm", "get", [])
    with pytest.raises(MorseRPCNbArgsError, match="wrong # of parameters"):
        manager.on_incoming_request("arm", "move", [1, 2])


def test_unknown_names_get_the_nearest(manager):
    with pytest.raises(
        MorseMethodNotFoundError, match=r"The request moves has not been registered in Test manager.*'move'"
    ):
        manager.on_incoming_request("arm", "moves", [])
    with pytest.raises(MorseMethodNotFoundError, match="did you mean 'arm'"):
        manager.on_incoming_request("armm", "move", [])


def test_a_component_whose_services_are_not_offered_is_no_unknown_name(manager):
    class Scene:
        def component(self, name):
            return Arm() if name == "robot.arm" else None

    manager.context = Scene()
    with pytest.raises(MorseMethodNotFoundError, match=r"of 'robot.arm' are not .*; arm.add_service\(\) in the script"):
        manager.on_incoming_request("robot.arm", "move", [1])
    with pytest.raises(MorseMethodNotFoundError, match=r"there is no component 'robot.leg'"):
        manager.on_incoming_request("robot.leg", "move", [1])


class Typed(AbstractObject):
    def name(self):
        return "typed"

    @service
    def take(
        self, number: float, whole: int = 1, text: str | None = None, anything=None, many: list[float] | None = None
    ):
        return [number, whole, text]

    @interruptible
    @async_service
    def later(self, number: float):
        pass


@pytest.fixture
def typed():
    services = MorseServices()
    made = Manager()
    services.add_request_manager(made)
    services.register_request_manager_mapping("typed", made.classpath)
    services.register_object("typed", Typed())
    return made


@pytest.mark.parametrize(
    "arguments", [[1], [1.5, 2], [-1e300, 2, None], [1, 2, "x", {"a": 1}], [1, 2, "x", None, [1.0]]]
)
def test_arguments_of_the_right_type_are_taken(typed, arguments):
    assert typed.on_incoming_request("typed", "take", arguments)[0]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["a"], "'number' is a number, not 'a'"),
        ([float("nan")], "'number' is a number, not nan"),
        ([float("inf")], "'number' is a finite number, not inf"),
        ([True], "'number' is a number"),
        ([None], "'number' is a number"),
        ([1, 1.5], "'whole' is an integer"),
        ([1, 1, 5], "'text' is a string"),
        ([1, 1, None, None, "no list"], "'many' is a list"),
    ],
)
def test_arguments_of_the_wrong_type_are_refused(typed, arguments, complaint):
    with pytest.raises(MorseRPCTypeError, match=complaint):
        typed.on_incoming_request("typed", "take", arguments)


def test_types_of_asynchronous_services_are_checked_too(typed):
    with pytest.raises(MorseRPCTypeError, match="'number' is a number"):
        typed.on_incoming_request("typed", "later", ["x"])
    assert typed.on_incoming_request("typed", "later", [1])[0] is False
