"""The scene as plain data: built by a script, run by the simulation, shown by the view."""

from morse.scene.articulation import Articulation, Bone, Control, Inertial, JointDynamics, JointKind
from morse.scene.body import BodySettings, Bounds, CollisionShape, PhysicsType, ShapeKind
from morse.scene.component import (
    ComponentDeclaration,
    ModifierDeclaration,
    OverlayDeclaration,
    SensorAlteration,
    SourceLine,
    StreamDeclaration,
)
from morse.scene.library import Library
from morse.scene.mesh import Camera, Image, Light, Material, Mesh
from morse.scene.node import Node, NodeKind, controls_of, is_dynamic, is_shown, shared_image, slot_materials
from morse.scene.scene import Choice, Display, Mist, ModelUse, Role, Scene, Settings, TimeStrategies, ViewSettings, Zone
from morse.scene.scene_warnings import SceneWarning

__all__ = [
    "Articulation",
    "BodySettings",
    "Bone",
    "Bounds",
    "Camera",
    "Choice",
    "CollisionShape",
    "ComponentDeclaration",
    "Control",
    "Display",
    "Image",
    "Inertial",
    "JointDynamics",
    "JointKind",
    "Library",
    "Light",
    "Material",
    "Mesh",
    "Mist",
    "ModelUse",
    "ModifierDeclaration",
    "Node",
    "NodeKind",
    "OverlayDeclaration",
    "PhysicsType",
    "Role",
    "Scene",
    "SceneWarning",
    "SensorAlteration",
    "Settings",
    "ShapeKind",
    "SourceLine",
    "StreamDeclaration",
    "TimeStrategies",
    "ViewSettings",
    "Zone",
    "controls_of",
    "is_dynamic",
    "is_shown",
    "shared_image",
    "slot_materials",
]
