"""A compiled MJCF model as plain data. No other module outside of the physics uses MuJoCo.

The parser of the engine applies defaults, computes inertias from shapes, and resolves all notations for poses and
sizes.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.assets.errors import AssetError
from morse.assets.mjcf.flexes import MOST_VERTICES
from morse.assets.triangle_limit import check_parts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.mjcf.source import Source
    from morse.scene.mjcf import MjcfFile

_OBJECTS = {
    "body": mujoco.mjtObj.mjOBJ_BODY,
    "joint": mujoco.mjtObj.mjOBJ_JOINT,
    "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "camera": mujoco.mjtObj.mjOBJ_CAMERA,
    "site": mujoco.mjtObj.mjOBJ_SITE,
    "sensor": mujoco.mjtObj.mjOBJ_SENSOR,
    "mesh": mujoco.mjtObj.mjOBJ_MESH,
}
_JOINTS = {0: "free", 1: "ball", 2: "slide", 3: "hinge"}
_GEOMS = {0: "plane", 1: "hfield", 2: "sphere", 3: "capsule", 4: "ellipsoid", 5: "cylinder", 6: "box", 7: "mesh"}


@dataclass(slots=True)
class BodyData:
    """A body; poses in the frame of the parent, quaternions w, x, y, z.

    Attributes:
        parent: index; the world is 0.
        inertial: mass (kg), centre (3), quaternion of the principal axes (4), moments (3).
        is_soft: whether it is a vertex or a node of a deformable body, which the engine has made.
    """

    name: str
    parent: int
    position: tuple[float, ...]
    quaternion: tuple[float, ...]
    inertial: tuple[float, tuple[float, ...], tuple[float, ...], tuple[float, ...]]
    joints: list[int] = field(default_factory=list)
    geoms: list[int] = field(default_factory=list)
    is_mocap: bool = False
    is_soft: bool = False


@dataclass(slots=True)
class JointData:
    """A joint; position and axis in the frame of the body.

    Attributes:
        kind: ``free``, ``ball``, ``slide`` or ``hinge``.
        start: joint value at which the bodies have the poses of the file.
        limits: smallest and largest value, or None.
        effort: largest effort of its motors, or infinity.
    """

    name: str
    kind: str
    body: int
    position: tuple[float, ...]
    axis: tuple[float, ...]
    start: float
    limits: tuple[float, float] | None
    damping: float
    friction: float
    inertia: float
    stiffness: float
    rest: float
    effort: float


@dataclass(slots=True)
class SurfaceData:
    """What a shape looks like; see ``material`` in the reference of MJCF.

    Attributes:
        texture: number in `Source.textures`, or -1.
        repeat: of the texture, horizontally and vertically.
        uniform: whether the texture is repeated in each metre.
        metallic, roughness: negative if the file does not contain them.
    """

    texture: int
    repeat: tuple[float, float]
    uniform: bool
    emission: float
    specular: float
    shininess: float
    metallic: float
    roughness: float


@dataclass(slots=True)
class GeomData:
    """A shape in the frame of its body; sizes as in `morse.scene.CollisionShape`.

    Attributes:
        mesh: vertices (V, 3) and triangles (T, 3), or None.
        heights: of a height field, (R, C) m, rows along Y; or None.
        contact: contact parameters, see `morse.scene.mjcf.MjcfModel.ground`.
        surface: its material, or None.
        uvs: texture coordinates of a mesh, (T, 3, 2), v upward; None if it has none or no texture is used.
        masks: the bits of its type, and the bits of the types that it collides with (``contype``, ``conaffinity``).
    """

    name: str
    kind: str
    size: tuple[float, ...]
    position: tuple[float, ...]
    quaternion: tuple[float, ...]
    color: tuple[float, ...]
    group: int
    contact: tuple[float, ...]
    masks: tuple[int, int]
    mesh: tuple[NDArray[np.float32], NDArray[np.int32]] | None
    heights: NDArray[np.float64] | None = None
    surface: SurfaceData | None = None
    uvs: NDArray[np.float32] | None = None


@dataclass(slots=True)
class FlexData:
    """A deformable body at the start of the file.

    Attributes:
        body: the body that carries it; the world is 0.
        points: (P, 3) positions of its vertices in the world of the file, m.
        triangles: (T, 3) what is shown of it by the numbers of the points, counterclockwise from outside; (T, 2) for a
            rope, whose segments these are.
        radius: half of its thickness, m.
        uvs: (T, 3, 2) texture coordinates, v upward; None if it has none.
        surface: its material, or None.
    """

    name: str
    body: int
    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    radius: float
    uvs: NDArray[np.float32] | None
    color: tuple[float, ...]
    group: int
    surface: SurfaceData | None


@dataclass(slots=True)
class MotorData:
    """An actuator at a joint.

    Attributes:
        gear: effort of the joint divided by the force of the actuator.
        gain, bias: constants of the actuator: force = gain * control + bias[0] + bias[1] * length + bias[2] * velocity.
        is_direct: whether it is a motor for a position, a velocity or an effort: the force is linear in the control,
            without dynamics of the actuator.
        force: largest force, or infinity.
        control: largest control, or infinity.
    """

    name: str
    joint: int
    gear: float
    gain: float
    bias: tuple[float, float, float]
    is_direct: bool
    force: float
    control: float


@dataclass(slots=True)
class SensorData:
    """A sensor or a camera in the frame of a body.

    Attributes:
        kind: name of the MJCF element; ``camera`` for a camera.
        values: for a camera, vertical field of view, deg, width and height, pixels; for a range finder, largest
            distance, m, 0 for none.
    """

    name: str
    kind: str
    body: int
    position: tuple[float, ...]
    quaternion: tuple[float, ...]
    values: tuple[float, ...] = ()


@dataclass(slots=True)
class ModelData:
    """A model.

    Attributes:
        file: the model as the engine reads it.
        bodies: the world first; parents are before their children.
        follows: joints that follow another joint: (joint, leader, factor, offset).
        apart: pairs of bodies that do not collide.
        joined: pairs of bodies that a constraint joins.
        lost: unsupported features of the file, one sentence each.
        step: time step, s.
        keyframes: name to the joint values of each joint (number of the joint to values).
        materials: name to the colour and the surface.
        flexes: the deformable bodies.
    """

    file: MjcfFile
    bodies: list[BodyData]
    joints: list[JointData]
    geoms: list[GeomData]
    motors: list[MotorData]
    sensors: list[SensorData]
    follows: list[tuple[int, int, float, float]]
    apart: list[tuple[int, int]]
    joined: list[tuple[int, int]]
    lost: list[str]
    keyframes: dict[str, dict[int, tuple[float, ...]]]
    step: float = 0.002
    materials: dict[str, tuple[tuple[float, ...], SurfaceData]] = field(default_factory=dict)
    flexes: list[FlexData] = field(default_factory=list)


#: what the engine says of a body that moves and has no mass; mass and inertia that it accepts, kg and kg m^2
_WITHOUT_MASS, _LEAST = "mass and inertia of moving bodies", 1e-14


def compiled(source: Source) -> ModelData:
    """Compile a model.

    Raises:
        AssetError: the engine refuses it; the message contains the reason.
    """
    file = source.file()
    try:
        with warnings.catch_warnings():
            # warnings of the engine are for authors of MJCF
            warnings.simplefilter("ignore")
            try:
                model = file.spec().compile()
            except ValueError as error:
                if _WITHOUT_MASS not in str(error):
                    raise
                # a mesh that gave a body its mass may be left out
                file = replace(file, bound=_LEAST)
                model = file.spec().compile()
    except (ValueError, RuntimeError, MemoryError, mujoco.FatalError) as error:
        reason = ", ".join(line for line in str(error).split("\n") if line)
        reason = re.sub(
            r",? line (\d+)", lambda line: (place := source.place_of(int(line[1]))) and f", {place}", reason
        )
        raise AssetError(source.path, f"the engine refuses it: {reason:.300}") from None
    check_parts(source.path, int(model.nflexvert), "vertices of deformable bodies", MOST_VERTICES)
    return _Reading(model, file).data()


class _Reading:
    def __init__(self, model: mujoco.MjModel, file: MjcfFile) -> None:
        self.model, self.file = model, file
        self.lost: list[str] = []
        self._meshes: dict[int, tuple[NDArray[np.float32], NDArray[np.int32]]] = {}

    def name(self, kind: str, index: int) -> str:
        return mujoco.mj_id2name(self.model, _OBJECTS[kind], index) or f"{kind}{index}"

    def data(self) -> ModelData:
        m = self.model
        bodies = [self.body(index) for index in range(m.nbody)]
        joints = [self.joint(index) for index in range(m.njnt)]
        geoms = [self.geom(index) for index in range(m.ngeom)]
        for index in range(m.njnt):
            bodies[m.jnt_bodyid[index]].joints.append(index)
        for index in range(m.ngeom):
            bodies[m.geom_bodyid[index]].geoms.append(index)
        self._motors = motors = [motor for index in range(m.nu) if (motor := self.motor(index)) is not None]
        sensors = [*self.cameras(), *self.sensors()]
        return ModelData(
            self.file,
            bodies,
            joints,
            geoms,
            motors,
            sensors,
            self.follows(),
            self.apart(),
            self.joined(),
            self.lost,
            self.keyframes(),
            float(m.opt.timestep),
            {
                mujoco.mj_id2name(m, mujoco.mjtObj.mjOBJ_MATERIAL, index): (
                    _row(m.mat_rgba[index]),
                    self.surface(index),
                )
                for index in range(m.nmat)
            },
            self.flexes(bodies),
        )

    def body(self, index: int) -> BodyData:
        m = self.model
        inertial = (
            float(m.body_mass[index]),
            _row(m.body_ipos[index]),
            _row(m.body_iquat[index]),
            _row(m.body_inertia[index]),
        )
        return BodyData(
            "world" if index == 0 else self.name("body", index),
            int(m.body_parentid[index]),
            _row(m.body_pos[index]),
            _row(m.body_quat[index]),
            inertial,
            is_mocap=bool(m.body_mocapid[index] >= 0),
        )

    def joint(self, index: int) -> JointData:
        m = self.model
        kind, dof, qpos = _JOINTS[int(m.jnt_type[index])], int(m.jnt_dofadr[index]), int(m.jnt_qposadr[index])
        limits = _row(m.jnt_range[index]) if m.jnt_limited[index] else None
        effort = float(abs(m.jnt_actfrcrange[index]).max()) if m.jnt_actfrclimited[index] else np.inf
        return JointData(
            self.name("joint", index),
            kind,
            int(m.jnt_bodyid[index]),
            _row(m.jnt_pos[index]),
            _row(m.jnt_axis[index]),
            float(m.qpos0[qpos]) if kind in ("slide", "hinge") else 0.0,
            None if limits is None else (limits[0], limits[1]),
            float(m.dof_damping[dof]),
            float(m.dof_frictionloss[dof]),
            float(m.dof_armature[dof]),
            float(np.ravel(m.jnt_stiffness[index])[0]),
            float(m.qpos_spring[qpos]),
            effort,
        )

    def geom(self, index: int) -> GeomData:
        m = self.model
        kind = _GEOMS.get(int(m.geom_type[index]), "other")
        mesh = self.mesh(int(m.geom_dataid[index])) if kind == "mesh" else None
        material = int(m.geom_matid[index])
        plain = np.allclose(m.geom_rgba[index], (0.5, 0.5, 0.5, 1.0))
        color = m.mat_rgba[material] if material >= 0 and plain else m.geom_rgba[index]
        field = int(m.geom_dataid[index]) if kind == "hfield" else -1
        surface = self.surface(material) if material >= 0 else None
        counts = {"plane": 3, "sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
        return GeomData(
            self.name("geom", index),
            kind,
            _row(m.hfield_size[field]) if field >= 0 else _row(m.geom_size[index])[: counts.get(kind, 0)],
            _row(m.geom_pos[index]),
            _row(m.geom_quat[index]),
            _row(np.clip(color, 0.0, 1.0)),
            int(m.geom_group[index]),
            (
                *_row(m.geom_friction[index]),
                *_row(m.geom_solref[index]),
                *_row(m.geom_solimp[index]),
                *(float(a[index]) for a in (m.geom_solmix, m.geom_margin, m.geom_gap, m.geom_condim, m.geom_priority)),
            ),
            (int(m.geom_contype[index]), int(m.geom_conaffinity[index])),
            mesh,
            self.heights(field) if field >= 0 else None,
            surface,
            self.uvs(int(m.geom_dataid[index])) if mesh is not None and surface and surface.texture >= 0 else None,
        )

    def flexes(self, bodies: list[BodyData]) -> list[FlexData]:
        """Return the deformable bodies, and mark the bodies of which they consist."""
        m, flexes = self.model, []
        if not m.nflex:
            return []
        state = mujoco.MjData(m)
        mujoco.mj_kinematics(m, state)
        mujoco.mj_flex(m, state)
        for index in range(m.nflex):
            name = mujoco.mj_id2name(m, mujoco.mjtObj.mjOBJ_FLEX, index)
            first, count = int(m.flex_vertadr[index]), int(m.flex_vertnum[index])
            nodes, number = int(m.flex_nodeadr[index]), int(m.flex_nodenum[index])
            holders = {
                *m.flex_vertbodyid[first : first + count].tolist(),
                *m.flex_nodebodyid[nodes : nodes + number].tolist(),
            } - {-1}
            made = re.compile(re.escape(name) + r"_\d+")
            soft = [body for body in holders if made.fullmatch(bodies[body].name) and not bodies[body].geoms]
            for body in soft:
                bodies[body].is_soft = True
            carrier = bodies[min(soft)].parent if soft else min(holders, default=0)
            faces, corners = self.faces(index)
            material = int(m.flex_matid[index])
            plain = np.allclose(m.flex_rgba[index], (0.5, 0.5, 0.5, 1.0))
            surface = self.surface(material) if material >= 0 else None
            uvs = None
            if surface and surface.texture >= 0 and m.flex_texcoordadr[index] >= 0 and m.flex_dim[index] > 1:
                points = np.array(m.flex_texcoord[int(m.flex_texcoordadr[index]) :], dtype=np.float32)
                points[:, 1] = 1.0 - points[:, 1]
                uvs = points[corners]
            flexes.append(
                FlexData(
                    name,
                    carrier,
                    np.array(state.flexvert_xpos[first : first + count]),
                    faces,
                    float(m.flex_radius[index]),
                    uvs,
                    _row(np.clip(m.mat_rgba[material] if surface and plain else m.flex_rgba[index], 0.0, 1.0)),
                    int(m.flex_group[index]),
                    surface,
                )
            )
        return flexes

    def faces(self, index: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Return the triangles that are shown of a deformable body, by vertices and by texture coordinates."""
        m, dimension = self.model, int(self.model.flex_dim[index])
        first, count = int(m.flex_elemdataadr[index]), int(m.flex_elemnum[index])
        elements = np.array(m.flex_elem[first : first + count * (dimension + 1)], dtype=np.int32)
        elements = elements.reshape(count, dimension + 1)
        if dimension < 3:
            corners = np.array(m.flex_elemtexcoord[first : first + elements.size], dtype=np.int32)
            return elements, corners.reshape(elements.shape)
        start, number = int(m.flex_shelldataadr[index]), int(m.flex_shellnum[index])
        shell = np.array(m.flex_shell[start : start + 3 * number], dtype=np.int32).reshape(-1, 3)
        return shell, shell

    def surface(self, index: int) -> SurfaceData:
        m = self.model
        texture = int(m.mat_texid[index][int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])
        number = -1
        if texture >= 0:
            # the colour of its pixel, see `take_textures`
            red, green, blue = (int(value) for value in m.tex_data[m.tex_adr[texture] :][:3])
            number = red + (green << 8) + (blue << 16)
        across, down = _row(m.mat_texrepeat[index])
        return SurfaceData(
            number,
            (across, down),
            bool(m.mat_texuniform[index]),
            *(
                float(values[index])
                for values in (m.mat_emission, m.mat_specular, m.mat_shininess, m.mat_metallic, m.mat_roughness)
            ),
        )

    def uvs(self, index: int) -> NDArray[np.float32] | None:
        m = self.model
        start, count = int(m.mesh_texcoordadr[index]), int(m.mesh_texcoordnum[index])
        if start < 0:
            return None
        faces = slice(m.mesh_faceadr[index], m.mesh_faceadr[index] + m.mesh_facenum[index])
        points = np.array(m.mesh_texcoord[start : start + count], dtype=np.float32)
        points[:, 1] = 1.0 - points[:, 1]
        corners: NDArray[np.float32] = points[m.mesh_facetexcoord[faces]]
        return corners

    def heights(self, index: int) -> NDArray[np.float64]:
        m = self.model
        start, rows, columns = int(m.hfield_adr[index]), int(m.hfield_nrow[index]), int(m.hfield_ncol[index])
        data = np.array(m.hfield_data[start : start + rows * columns], dtype=np.float64)
        return data.reshape(rows, columns) * float(m.hfield_size[index][2])

    def mesh(self, index: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """The arrays of a mesh; the shapes that use it share them."""
        if index not in self._meshes:
            m = self.model
            points = slice(m.mesh_vertadr[index], m.mesh_vertadr[index] + m.mesh_vertnum[index])
            faces = slice(m.mesh_faceadr[index], m.mesh_faceadr[index] + m.mesh_facenum[index])
            vertices = np.array(m.mesh_vert[points], dtype=np.float32)
            self._meshes[index] = vertices, np.array(m.mesh_face[faces], dtype=np.int32)
        return self._meshes[index]

    def motor(self, index: int) -> MotorData | None:
        m = self.model
        name = mujoco.mj_id2name(m, mujoco.mjtObj.mjOBJ_ACTUATOR, index) or f"actuator{index}"
        joint = int(m.actuator_trnid[index][0])
        at_joint = int(m.actuator_trntype[index]) in (0, 1) and m.jnt_type[joint] in (2, 3)
        if not at_joint:
            return None
        gains, bias = m.actuator_gainprm[index], m.actuator_biasprm[index]
        affine = int(m.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
        has_fixed_gain = int(m.actuator_gaintype[index]) == int(mujoco.mjtGain.mjGAIN_FIXED)
        plain = affine or int(m.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_NONE)
        static = int(m.actuator_dyntype[index]) == int(mujoco.mjtDyn.mjDYN_NONE)
        gain, stiffness, slowing = float(gains[0]), -float(bias[1]) * affine, -float(bias[2]) * affine
        pull = stiffness or slowing or gain
        low, high = m.actuator_forcerange[index] if m.actuator_forcelimited[index] else (-1.0, 1.0)
        linear = has_fixed_gain and plain and static and gain > 0.0 and not (affine and bias[0]) and low == -high
        return MotorData(
            name,
            joint,
            float(m.actuator_gear[index][0]),
            float(gains[0]),
            (float(bias[0]), float(bias[1]), float(bias[2])) if affine else (0.0, 0.0, 0.0),
            bool(linear and min(stiffness, slowing) >= 0.0 and abs(gain - pull) <= 1e-9 * gain),
            float(abs(m.actuator_forcerange[index]).max()) if m.actuator_forcelimited[index] else np.inf,
            float(abs(m.actuator_ctrlrange[index]).max()) if m.actuator_ctrllimited[index] else np.inf,
        )

    def cameras(self) -> list[SensorData]:
        m = self.model
        return [
            SensorData(
                self.name("camera", index),
                "camera",
                int(m.cam_bodyid[index]),
                _row(m.cam_pos[index]),
                _row(m.cam_quat[index]),
                (float(np.ravel(m.cam_fovy[index])[0]), *_row(m.cam_resolution[index])),
            )
            for index in range(m.ncam)
            # a camera of the world observes the robot, and is not a part of it
            if m.cam_bodyid[index] > 0 and int(m.cam_mode[index]) == int(mujoco.mjtCamLight.mjCAMLIGHT_FIXED)
        ]

    def sensors(self) -> list[SensorData]:
        m = self.model
        sensors = []
        for index in range(m.nsensor):
            word = mujoco.mjtSensor(int(m.sensor_type[index])).name.removeprefix("mjSENS_").lower()
            place = int(m.sensor_objid[index])
            if int(m.sensor_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
                body, position, rotation = int(m.site_bodyid[place]), m.site_pos[place], m.site_quat[place]
            elif int(m.sensor_objtype[index]) in (int(mujoco.mjtObj.mjOBJ_BODY), int(mujoco.mjtObj.mjOBJ_XBODY)):
                body, position, rotation = place, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
            else:
                body, position, rotation = -1, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
            sensors.append(
                SensorData(
                    self.name("sensor", index),
                    word,
                    body,
                    _row(position),
                    _row(rotation),
                    (float(m.sensor_cutoff[index]),),
                )
            )
        return sensors

    def follows(self) -> list[tuple[int, int, float, float]]:
        m = self.model
        couplings: list[tuple[int, int, float, float]] = []
        motor_joints = {motor.joint for motor in self._motors}
        for index in range(m.neq):
            one, other = int(m.eq_obj1id[index]), int(m.eq_obj2id[index])
            is_joint = int(m.eq_type[index]) == int(mujoco.mjtEq.mjEQ_JOINT)
            if not is_joint or other < 0 or any(m.eq_data[index][2:5]) or m.jnt_type[one] < 2 or m.jnt_type[other] < 2:
                continue
            factor, offset = float(m.eq_data[index][1]), float(m.eq_data[index][0])
            if factor and one in motor_joints and other not in motor_joints:
                # the joint with the motor leads
                one, other, factor, offset = other, one, 1.0 / factor, -offset / factor
            if not m.eq_active0[index] or any(one == joint for joint, *_ in couplings):
                continue
            start, leading = (float(m.qpos0[m.jnt_qposadr[joint]]) for joint in (one, other))
            couplings.append((one, other, factor, start + offset - factor * leading))
        return couplings

    def keyframes(self) -> dict[str, dict[int, tuple[float, ...]]]:
        m = self.model
        widths = {0: 7, 1: 4, 2: 1, 3: 1}
        values: dict[str, dict[int, tuple[float, ...]]] = {}
        for index in range(m.nkey):
            name = mujoco.mj_id2name(m, mujoco.mjtObj.mjOBJ_KEY, index) or str(index)
            qpos = m.key_qpos[index]
            values[name] = {
                joint: _row(qpos[start : start + widths[int(m.jnt_type[joint])]])
                for joint, start in enumerate(m.jnt_qposadr.tolist())
            }
        return values

    def joined(self) -> list[tuple[int, int]]:
        m = self.model
        places = {
            int(mujoco.mjtObj.mjOBJ_BODY): range(m.nbody),
            int(mujoco.mjtObj.mjOBJ_SITE): m.site_bodyid,
            int(mujoco.mjtObj.mjOBJ_JOINT): m.jnt_bodyid,
        }
        return [
            (int(bodies[m.eq_obj1id[index]]), int(bodies[max(m.eq_obj2id[index], 0)]))
            for index in range(m.neq)
            if (bodies := places.get(int(m.eq_objtype[index]))) is not None
        ]

    def apart(self) -> list[tuple[int, int]]:
        return [(int(signature) >> 16, int(signature) & 0xFFFF) for signature in self.model.exclude_signature]


def _row(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
