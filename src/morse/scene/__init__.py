"""The scene as plain data: built by a script, run by the simulation, shown by the view."""

from morse.scene.appearance import Camera, Image, Light, Material
from morse.scene.armature import Bone, JointKind
from morse.scene.articulation import Articulation, Control, Inertial, JointDynamics
from morse.scene.body import BodySettings, Bounds, PhysicsType
from morse.scene.component import (
    ComponentDeclaration,
    ModifierDeclaration,
    OverlayDeclaration,
    SourceLine,
    StreamDeclaration,
)
from morse.scene.joint_control import controls_of, is_dynamic
from morse.scene.library import Library
from morse.scene.looks import is_shown, shared_image, slot_materials
from morse.scene.mesh import Mesh
from morse.scene.model import Choice, ModelUse, Role
from morse.scene.node import Node, NodeKind
from morse.scene.scene import Scene, Zone
from morse.scene.scene_warnings import SceneWarning
from morse.scene.settings import Display, Mist, Settings, TimeStrategies, ViewSettings
from morse.scene.shapes import CollisionShape, ShapeKind

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
