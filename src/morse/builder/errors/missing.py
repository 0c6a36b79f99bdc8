"""Components of MORSE 1.4 that this version does not have."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

#: components of 1.4 by kind; names that are available meanwhile have no effect here
_OF_1_4: Mapping[str, tuple[str, ...]] = {
    "sensor": (
        *("Accelerometer", "Airspeed", "ArmaturePose", "Attitude", "Barometer", "Battery", "Clock", "Collision"),
        *("CompoundSensor", "DepthCamera", "DepthCameraAggregator", "DepthCameraRotationZ", "DepthVideoCamera", "GPS"),
        *("Gyroscope", "HumanPosture", "IMU", "Kinect", "Magnetometer", "PTUPosture", "RawImage", "SearchAndRescue"),
        *("SemanticCamera", "StereoUnit", "Thermometer", "Velocity", "Velodyne", "VelodyneZB", "VideoCamera"),
    ),
    "actuator": (
        *("Arucomarker", "Armature", "Destination", "Drag", "ExternalForce", "ForceTorque", "Gripper", "KukaLWR"),
        *("Light", "MocapControl", "Orientation", "PA10", "PTU", "QuadrotorDynamicControl", "RotorcraftAttitude"),
        *("RotorcraftVelocity", "RotorcraftWaypoint", "Sound", "StabilizedQuadrotor", "SteerForce", "Waypoint"),
    ),
    "robot": ("BarePR2", "BasePR2", "Human", "LocalizedPR2", "NavPR2"),
}


def missing_component(name: str) -> tuple[str, str] | None:
    """Return the error and the correction for a component of 1.4 that this version does not have.

    Returns:
        None for any other name.
    """
    import morse.builder

    by_folded = {present.casefold(): (present, kind) for kind, names in _OF_1_4.items() for present in names}
    present, kind = by_folded.get(name.casefold(), ("", ""))
    if not present or hasattr(morse.builder, present):
        return None
    there = sorted(getattr(morse.builder, f"{kind}s").__all__)
    choices = ", ".join(other for other in there if not other.endswith("Creator"))
    return (
        f"MORSE has no {kind} {present} yet (it was in MORSE 1.4)",
        f"Available {kind}s: {choices}. To write one, use: morse add {kind} NAME ENVIRONMENT",
    )
