"""Arms and other armatures."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.creator import ActuatorCreator
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.helpers.chain import Chain
from morse.mathutils import Matrix
from morse.scene import Articulation, Control, Node, NodeKind
from morse.scene.articulation import DYNAMIC

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.core.values import Properties

_PREFIX, _BONE = "ik_target", "IK_Bone"


class Armature(ActuatorCreator):
    """An armature with movable joints; its component class is `morse.actuators.armature.Armature`.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        armature_name: the armature in the model, or in the scene if no model is given; ``name`` by default, or the
            only armature of the model.
        model_name: a model file.

    Raises:
        MorseBuilderError: no armature is named, or the object is not an armature.
    """

    _classpath = "morse.actuators.armature.Armature"

    def __init__(
        self, name: str | None = None, armature_name: str | None = None, model_name: str | None = None
    ) -> None:
        what = type(self).__name__
        for given, argument in ((name, "name"), (armature_name, "armature_name"), (model_name, "model_name")):
            if given is not None:
                checks.text(given, f"{what}({argument})")
        if model_name is not None:
            armature_name = armature_name or self._only_armature(model_name)
            super().__init__(name, self.USE_BLEND, model_name, armature_name)
        elif armature_name is None and name is None:
            raise MorseBuilderError(
                f"{what} needs an armature: {what}('arm', 'kuka_armature', 'kuka_lwr') uses an armature of a model, "
                f"{what}(armature_name='torso_armature') an armature of the scene"
            )
        else:
            super().__init__(name, self.LINK_EXISTING_OBJECT, blendobject=armature_name)
        if not self.scene_node.bones:
            raise MorseBuilderError(f"{what}: '{self.scene_node.plain_name}' has no bones, it is not an armature")
        # its fields depend on its bones
        self._exportable = True
        self.ik_targets: dict[str, Node] = {}

    def _existing(self, name: str | None) -> SceneObject:
        """Return the armature of that name in the scene; if several are from the same file, the first unused one."""
        space = workspace.current()
        bound_nodes = {part.scene_node for part in space.components if isinstance(part, Armature) and part.is_complete}
        for node in space.nodes():
            if node.bones and name in (node.name, node.source_name) and node not in bound_nodes:
                return SceneObject(node)
        return super()._existing(name)

    def _only_armature(self, model: str) -> str:
        self._category = "actuators"
        armatures = [node.name for node in self._library(model).nodes() if node.kind is NodeKind.ARMATURE]
        if len(armatures) != 1:
            contents = f"one of {', '.join(armatures)}" if armatures else "it contains none"
            raise MorseBuilderNoComponentError(f"{type(self).__name__}: which armature of '{model}'? {contents}")
        return armatures[0]

    def control(self, control: str, joints: Iterable[str] | None = None) -> None:
        """Set the quantity that the motors of dynamic joints control; see `morse.actuators.armature.Armature`.

        If joints are named, the armature becomes dynamic.

        Args:
            control: ``position``, ``velocity`` or ``effort``.
            joints: names of joints; None for all.

        Raises:
            MorseBuilderError: there is no such joint.
        """
        kind = Control(checks.choice(control, [str(one) for one in Control], "control(control)"))
        if joints is None:
            self.properties(Control=str(kind))
            return
        settings = self.scene_node.articulation or Articulation()
        kinds = dict(settings.control) | dict.fromkeys(self._joint_names("control", joints), kind)
        self.scene_node.articulation = replace(settings, control=tuple(kinds.items()))
        self.scene_node.properties.setdefault(DYNAMIC, True)

    def gains(
        self, stiffness: float | None = None, damping: float | None = None, joints: Iterable[str] | None = None
    ) -> None:
        """Set the gains of the motors of dynamic joints; see the service ``get_gains``. The armature becomes dynamic.

        Args:
            stiffness: N·m/rad, or N/m for prismatic joints; None for that of the file.
            damping: N·m·s/rad, or N·s/m; None for that of the file.
            joints: names of joints; None for all.

        Raises:
            MorseBuilderError: there is no such joint, or a gain is not a number of at least 0.
        """
        for name, value in (("stiffness", stiffness), ("damping", damping)):
            if value is not None:
                checks.number(value, f"gains({name})", minimum=0.0)
        settings = self.scene_node.articulation or Articulation()
        gains = {joint: (k, d) for joint, k, d in settings.gains}
        gains |= dict.fromkeys(self._joint_names("gains", joints), (stiffness, damping))
        rows = tuple((joint, k, d) for joint, (k, d) in gains.items())
        self.scene_node.articulation = replace(settings, gains=rows)
        self.scene_node.properties.setdefault(DYNAMIC, True)

    def _joint_names(self, what: str, joints: Iterable[str] | None) -> list[str]:
        names = Chain(self.scene_node.bones).names
        chosen = list(names) if joints is None else [joints] if isinstance(joints, str) else list(joints)
        for joint in chosen:
            if joint not in names:
                raise MorseBuilderError(
                    f"{what}: '{self.name}' has no joint {checks.shown(joint)}{checks.suggestion(joint, names)}"
                )
        return chosen

    def create_ik_targets(self, bones: Iterable[str]) -> None:
        """Create targets for bones, named ``ik_target.<name of the component>.<bone>``; the bones follow them.

        Args:
            bones: names of bones.

        Raises:
            MorseBuilderError: there is no such bone.
        """
        if isinstance(bones, str):
            bones = [bones]
        chain = Chain(self.scene_node.bones)
        frames = chain.frames(chain.start)
        for bone in bones:
            index = chain.index(bone) if isinstance(bone, str) else None
            if index is None:
                hint = checks.suggestion(bone, [one.name for one in chain.bones])
                raise MorseBuilderError(f"create_ik_targets: '{self.name}' has no bone {checks.shown(bone)}{hint}")
            if bone in self.ik_targets:
                continue
            position, r = chain.tip(frames[index], index)
            target = Node(f"{_PREFIX}.{self.name}.{bone}", properties={_BONE: bone})
            target.location = list(position)
            target.rotation_euler = list(Matrix((r[:3], r[3:6], r[6:])).to_euler())
            workspace.current().add(target)
            workspace.current().attach(self.scene_node, target)
            self.ik_targets[bone] = target

    def _scene_options(self) -> Properties:
        # the full name is known only at this point
        for bone, target in self.ik_targets.items():
            workspace.current().rename(target, f"{_PREFIX}.{self.name}.{bone}")
        return super()._scene_options()


class KukaLWR(Armature):
    """A KUKA LWR arm; its component class is `morse.actuators.armature.Armature`.

    Its last bone, ``kuka_7``, has a target for inverse kinematics.
    """

    _product = "KukaLWR"

    def __init__(self, name: str | None = None) -> None:
        self._carried: list[AbstractComponent] = []
        super().__init__(name, "kuka_armature", "kuka_lwr")
        self.create_ik_targets(["kuka_7"])

    def append(self, obj: AbstractComponent, child: str | None = None, level: int = 1) -> None:
        """Attach a component to the end effector.

        Args:
            obj: the component. Its pose is given in the frame of the arm when the arm is stretched upward; without a
                translation the component is at the tip.
            child: name of another part to which it is attached; its pose is then in the frame of that part.
            level: stack level of the variables that are searched for the name: 1 for the caller.
        """
        if child is not None:
            super().append(obj, child, level + 1)
            return
        hand, turn, _ = end_of(self.scene_node)
        super().append(obj, hand.name, level + 1)
        obj.scene_node.parent_inverse = turn
        self._carried.append(obj)

    def _scene_options(self) -> Properties:
        for component in self._carried:
            if component.scene_node.location == [0.0, 0.0, 0.0]:
                component.scene_node.location = list(end_of(self.scene_node)[2])
        return super()._scene_options()


def end_of(arm: Node) -> tuple[Node, Matrix, Sequence[float]]:
    """Where an arm carries what is appended to it.

    Returns:
        its end effector; 4x4 from the frame of the arm, when it is stretched upward, to that of the end effector; the
        tip of the last bone in the frame of the arm, m.

    Raises:
        MorseBuilderError: it has none.
    """
    walk = list(arm.walk())
    effectors = [node for node in walk if node.properties.get("end_effector")]
    last = [node for node in walk if node.bone == arm.bones[-1].name]
    if not effectors and not last:
        raise MorseBuilderError(f"'{arm.name}' has no end effector: no object is attached to its last bone")
    hand = (effectors or last)[0]
    chain = Chain(arm.bones)
    tip = chain.tip(chain.frames(chain.start)[-1], len(chain.bones) - 1)[0]
    relative: Matrix = arm.world_matrix().inverted() @ hand.world_matrix()
    return hand, relative.inverted(), tip
