"""The rules of the contract, in the order in which they are checked."""

from __future__ import annotations

from morse.verification.contract.behaviour import DETERMINISTIC, FITS, JSON, RESET, SAVED
from morse.verification.contract.carried import CARRIED
from morse.verification.contract.declared import DECLARED, DOCUMENTED
from morse.verification.contract.rough import CALLS, COMMANDS

LOADS = "can be put on a robot"

#: rule to what a component has to keep
RULES: dict[str, str] = {
    LOADS: "a robot of MORSE, or the one that is named, carries it in a simulation",
    DOCUMENTED: "the class, its data, properties, levels and services say what they are",
    DECLARED: "numbers have a unit, directions a frame, lists of numbers a shape",
    FITS: "after a second of acting, the data are declared, and have the type, shape and range declared",
    JSON: "the data can be written as JSON, without NaN and infinity unless they are allowed",
    DETERMINISTIC: "two simulations with the same seed publish the same, tick by tick",
    SAVED: "a state that was saved and restored elsewhere has the same future, and nothing is left out of it",
    RESET: "after a reset it does what it did after the launch",
    CARRIED: "every installed middleware has a stream for it, and its messages can be made",
    COMMANDS: "no value that a client sends switches it off, or ends the simulation",
    CALLS: "no argument of a service and no value of a property does",
}
