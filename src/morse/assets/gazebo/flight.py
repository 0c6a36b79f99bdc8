"""Plugins for propellers, wings and water."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, number, text_of, vector
from morse.mathutils import Matrix, Vector

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from morse.assets.gazebo.converted import Plugins, Properties


def propeller(plugins: Plugins, element: Element, prefix: str) -> None:
    """A propeller with its motor."""
    joint = plugins.joint(text_of(element, "jointName"), prefix)
    is_counter = text_of(element, "turningDirection", "ccw").lower() != "cw"
    properties: Properties = {
        "Joint": joint,
        "MotorConstant": number(element, "motorConstant", 8.54858e-06),
        "MomentConstant": number(element, "momentConstant", 0.016),
        "RotorDrag": number(element, "rotorDragCoefficient", 1.0e-4),
        "RollingMoment": number(element, "rollingMomentCoefficient", 1.0e-6),
        "Direction": 1.0 if is_counter else -1.0,
        "TimeConstantUp": number(element, "timeConstantUp", 1.0 / 80.0),
        "TimeConstantDown": number(element, "timeConstantDown", 1.0 / 40.0),
        "MaxSpeed": number(element, "maxRotVelocity", 838.0),
        "Slowdown": number(element, "rotorVelocitySlowdownSim", 10.0),
    }
    plugins.add(joint, "Propeller", properties, plugins.link(text_of(element, "linkName"), prefix))


def thruster(plugins: Plugins, element: Element, prefix: str) -> None:
    """A propeller under water."""
    joint = plugins.joints[plugins.joint(text_of(element, "joint_name"), prefix)]
    diameter = number(element, "propeller_diameter", 0.02)
    # the thrust is C rho D^4 w^2
    constant = number(element, "thrust_coefficient", 1.0) * number(element, "fluid_density", 1000.0) * diameter**4
    link = joint.child.removeprefix(plugins.prefix)
    turn = Vector((0.0, 0.0, 1.0)).rotation_difference(joint.axis).to_matrix().to_4x4()
    pose = turn if joint.anchor is None else joint.anchor @ turn
    properties: Properties = {
        "Joint": joint.name, "MotorConstant": abs(constant), "MomentConstant": 0.0, "TimeConstantUp": 0.0,
        "TimeConstantDown": 0.0, "MaxSpeed": 1e5, "Slowdown": 1.0,
    }  # fmt: skip
    plugins.add(joint.name, "Propeller", properties, link, pose)


def lift_drag(plugins: Plugins, element: Element, prefix: str) -> None:
    """A wing."""
    forward = Vector(vector(element, "forward", (1.0, 0.0, 0.0)))
    upward = Vector(vector(element, "upward", (0.0, 0.0, 1.0)))
    if min(forward.length, upward.length, forward.cross(upward).length) < 1e-9:
        raise ValueMistakeError("<forward> and <upward> are no two directions")
    forward, side = forward.normalized(), upward.cross(forward).normalized()
    up = forward.cross(side)
    pose = Matrix([list(row) for row in zip(forward, side, up, strict=True)]).to_4x4()
    pose.translation = vector(element, "cp", (0.0, 0.0, 0.0))
    flap = text_of(element, "control_joint_name")
    properties: Properties = {
        "Area": number(element, "area", 1.0),
        "Density": number(element, "air_density", 1.2041),
        "ZeroAngle": number(element, "a0", 0.0),
        "StallAngle": min(number(element, "alpha_stall", 0.5 * math.pi), 1.6),
        "LiftSlope": number(element, "cla", 1.0),
        "DragSlope": number(element, "cda", 0.01),
        "MomentSlope": number(element, "cma", 0.0),
        "LiftSlopeStalled": number(element, "cla_stall", 0.0),
        "DragSlopeStalled": number(element, "cda_stall", 1.0),
        "MomentSlopeStalled": number(element, "cma_stall", 0.0),
    }
    if flap:
        properties |= {
            "Joint": plugins.joint(flap, prefix),
            "FlapLift": number(element, "control_joint_rad_to_cl", 4.0),
        }
    link = plugins.link(text_of(element, "link_name"), prefix)
    plugins.add("wing", "LiftDrag", properties, link, pose)


def buoyancy(plugins: Plugins, element: Element, prefix: str) -> None:
    """Water around the model."""
    del element, prefix
    if not any(one.product == "Hydrodynamics" for one in plugins.actuators):
        plugins.add("water", "Hydrodynamics", {})
