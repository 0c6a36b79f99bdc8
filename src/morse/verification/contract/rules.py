"""The rules of the contract, in the order in which they are checked."""

from __future__ import annotations

from morse.verification.contract.behaviour import DETERMINISTIC, FITS, JSON, RESET, SAVED
from morse.verification.contract.carried import CARRIED
from morse.verification.contract.declared import DECLARED, DOCUMENTED
from morse.verification.contract.rough import CALLS, COMMANDS

LOADS = "can be put on a robot"

#: description of each rule
RULES: dict[str, str] = {
    LOADS: "a simulation with the component on a robot of MORSE, or on the given robot, can be loaded",
    DOCUMENTED: "the class, its data, properties, levels and services have descriptions",
    DECLARED: "numbers have a unit, directions a frame, lists of numbers a shape",
    FITS: "after a second of acting, the data are declared, and have the type, shape and range declared",
    JSON: "the data can be encoded as JSON, without NaN and infinity unless they are allowed",
    DETERMINISTIC: "two simulations with the same seed publish the same, tick by tick",
    SAVED: "a state that is restored in another simulation has the same future, and is complete",
    RESET: "its behaviour after a reset is the same as after the launch",
    CARRIED: "every installed middleware has a stream for it, and its messages can be created",
    COMMANDS: "no value of a client deactivates it, or ends the simulation",
    CALLS: "no argument of a service and no value of a property does",
}
