"""The services of the package simulation_interfaces that MORSE supports.

Source: github.com/ros-simulation/simulation_interfaces, version 1. They are offered below ``/morse`` if the package is
installed; each is implemented by services of the simulation, so that the journal contains it.
"""

from __future__ import annotations

import math
import re
from time import thread_time
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.core import status
from morse.core.exceptions import MorseBuilderError
from morse.core.validation.names import check_name, word_of
from morse.helpers.descriptions import is_description
from morse.mathutils import Quaternion
from morse.middleware.ros2 import NODE
from morse.middleware.ros2.domain import Served
from morse.middleware.ros2.simulation_steps import action_type
from morse.rosmsgs.parts import from_quaternion, from_xyz, header_at, pose_of, quaternion, quaternion_of, xyz
from morse.scene.extent import box_around
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

    from morse.core.context import Context
    from morse.core.request_manager import Outcome
    from morse.core.values import DecodedMessage, RosMessage
    from morse.middleware.ros2.domain import Reply
    from morse.rosmsgs.topics.backend import Backend
    from morse.scene.node import Node
    from morse.scene.scene import Zone

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.values import DecodedMessage, RosMessage
    from morse.core.world import World
    from morse.scene.node import Node

    Box = tuple[NDArray[np.float64], NDArray[np.float64]]

#: constants of Bounds
EMPTY, BOX, HULL, SPHERE = 0, 1, 2, 3


def box_of(world: World, root: Node) -> Box | None:
    """Return the lower and the upper corner (3,) in the world, m, of the shapes of an entity; None without shapes."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node in root.walk():
        part = world.find_object(node) if node.shapes else None
        if part is None:
            continue
        position, rotation = part.world_pose()
        place, turn = np.array(position), np.reshape(rotation, (3, 3))
        for shape in node.shapes or ():
            lower, upper = box_around(shape, place, turn)
            low, high = np.minimum(low, lower), np.maximum(high, upper)
    return (low, high) if low[0] <= high[0] else None


def bounds(box: Box | None) -> RosMessage:
    """The message; the points of a box are its upper and its lower corner."""
    if box is None:
        return {"type": EMPTY, "points": []}
    return {"type": BOX, "points": [xyz(box[1].tolist()), xyz(box[0].tolist())]}


def mistake(message: DecodedMessage) -> str | None:
    """What is wrong with bounds that are a filter; they are a box or a sphere."""
    points = message["points"]
    if message["type"] not in (BOX, SPHERE):
        return "filters.bounds.type is 1 (box) or 3 (sphere)"
    if len(points) != 2:
        return f"filters.bounds.points has {len(points)} points; a box or a sphere has 2"
    numbers = [number for point in points for number in from_xyz(point)]
    if not all(math.isfinite(number) for number in numbers):
        return "filters.bounds.points has a number that is not finite"
    if message["type"] == SPHERE and numbers[3] < 0.0:
        return "filters.bounds.points[1].x, the radius of the sphere, is negative"
    return None


def overlap(box: Box, message: DecodedMessage) -> bool:
    """Whether a box has a point in common with the bounds of a filter without a `mistake`."""
    one, other = (np.array(from_xyz(point)) for point in message["points"])
    if message["type"] == SPHERE:
        return bool(math.dist(np.clip(one, *box).tolist(), one.tolist()) <= other[0])
    return bool((np.minimum(one, other) <= box[1]).all() and (np.maximum(one, other) >= box[0]).all())


#: categories: object, robot, human, dynamic and static object
_CATEGORIES = range(5)
_ALL = 1
#: longest description and tag, letters, and the number of tags of an entity
_LONGEST_TEXT, _LONGEST_TAG, _MOST = 2000, 200, 100


class Notes:
    """Notes of clients; those about an entity end with it."""

    def __init__(self) -> None:
        self._notes: WeakKeyDictionary[Node, DecodedMessage] = WeakKeyDictionary()

    def of(self, root: Node) -> DecodedMessage | None:
        """The EntityInfo that a client has set."""
        return self._notes.get(root)

    def set(self, root: Node, info: DecodedMessage) -> str | None:
        """Replace the notes about an entity; returns what is wrong with them."""
        category, tags = info["category"]["category"], [str(tag) for tag in info["tags"]]
        if category not in _CATEGORIES:
            return f"info.category is 0 to {_CATEGORIES[-1]}, not {category}"
        if len(info["description"]) > _LONGEST_TEXT:
            return f"info.description has {len(info['description'])} letters; at most {_LONGEST_TEXT} are possible"
        if len(tags) > _MOST or any(len(tag) > _LONGEST_TAG for tag in tags):
            return f"info.tags has at most {_MOST} tags of up to {_LONGEST_TAG} letters"
        self._notes[root] = {**info, "tags": tags}
        return None


def chosen(tags: Collection[str], message: DecodedMessage) -> bool:
    """Whether something with some tags passes a TagsFilter; an empty filter passes everything."""
    wanted = {str(tag) for tag in message["tags"]}
    if message.get("filter_mode") == _ALL:
        return wanted <= set(tags)
    return not wanted or not wanted.isdisjoint(tags)


def named_poses(zones: Sequence[Zone], tags: RosMessage) -> list[RosMessage]:
    """The centres of the zones whose type passes a TagsFilter; the tag of a zone is its type."""
    return [
        {
            "name": zone.node.name,
            "description": f"zone of the type {zone.type}",
            "tags": [zone.type],
            "pose": {"position": xyz(zone.node.location), "orientation": quaternion((1.0, 0.0, 0.0, 0.0))},
        }
        for zone in zones
        if chosen([zone.type], tags)
    ]


def pose_bounds(zones: Sequence[Zone], name: str) -> RosMessage | None:
    """The bounds of a zone in the world; None if there is none of that name."""
    for zone in zones:
        if zone.node.name == name:
            centre, half = np.array(zone.node.location), np.abs(zone.node.scale)
            return bounds((centre - half, centre + half))
    return None


_UNSUPPORTED, _OK, _NOT_FOUND, _INCORRECT_STATE, _FAILED = 0, 1, 2, 3, 4
#: constants of SetSimulationState and SpawnEntity
_ALREADY, _NOT_UNIQUE, _NAME_INVALID, _NO_FORMAT, _NO_RESOURCE, _NO_NAMESPACE, _BAD_POSE = (
    101,
    101,
    102,
    103,
    104,
    105,
    109,
)
_STOPPED, _PLAYING, _PAUSED, _QUITTING = 0, 1, 2, 3
#: spawning, deleting, named poses and their bounds, tags, bounds of entities (boxes), categories, resource strings,
#: state of entities (get, set), their info (get, set), spawnables, reset, state of the simulation (get, set, pause),
#: steps
FEATURES = (0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 20, 24, 25, 26, 31, 32)
#: services of newer versions of the package, and their features: the present world, the available ones
_NEWER = {"get_current_world": 44, "get_available_worlds": 45}
#: steps as an action
_STEPS_ACTION = 33
#: of resource strings
_FORMATS = ("urdf", "sdf", "mjcf")
#: the name of a robot in a resource string
_NAME = re.compile(r"<(?:robot|model|mujoco)\b[^<>]*?\b(?:name|model)\s*=\s*[\"']([^\"']*)")
#: constants of EntityCategory
_OBJECT, _ROBOT = 0, 1
#: scopes of ResetSimulation: the default; time, state and spawned entities together; everything
_WHOLE = (0, 7, 255)
_WORLDS = ("", "map", "world")
#: a filter of names without constructs with exponential time
_HARMLESS, _MOST_STARS = re.compile(r"[^(){}+?\\*]*(?:\*[^(){}+?\\*]*){0,3}"), 3
_LONGEST = 200
#: longest name to which a number is added
_LONGEST_BASE = 90
#: processor time, s
_LONGEST_SEARCH = 0.02


class SimulationInterfaces(Served):
    """Answers the calls.

    Args:
        backend: a backend with services.
        call: calls a service of MORSE: component, service, arguments, and a callback for the outcome.
    """

    def __init__(self, context: Context, backend: Backend, call: Callable[..., object]) -> None:
        self._context, self._call, self._notes = context, call, Notes()
        handlers = {
            "get_simulator_features": ("GetSimulatorFeatures", self._features),
            "get_simulation_state": ("GetSimulationState", self._state),
            "set_simulation_state": ("SetSimulationState", self._set_state),
            "reset_simulation": ("ResetSimulation", self._reset),
            "step_simulation": ("StepSimulation", self._step),
            "get_entities": ("GetEntities", self._entities),
            "get_entities_states": ("GetEntitiesStates", self._entities_states),
            "get_entity_state": ("GetEntityState", self._entity_state),
            "set_entity_state": ("SetEntityState", self._set_entity_state),
            "get_entity_info": ("GetEntityInfo", self._entity_info),
            "set_entity_info": ("SetEntityInfo", self._set_entity_info),
            "get_entity_bounds": ("GetEntityBounds", self._entity_bounds),
            "get_named_poses": ("GetNamedPoses", self._named_poses),
            "get_named_pose_bounds": ("GetNamedPoseBounds", self._named_pose_bounds),
            "get_current_world": ("GetCurrentWorld", self._world),
            "get_available_worlds": ("GetAvailableWorlds", self._worlds),
            "get_spawnables": ("GetSpawnables", self._spawnables),
            "spawn_entity": ("SpawnEntity", self._spawn),
            "delete_entity": ("DeleteEntity", self._delete),
        }
        kinds = {name: (f"simulation_interfaces/srv/{kind}", one) for name, (kind, one) in handlers.items()}
        super().__init__(backend, {f"/{NODE}/{name}": entry for name, entry in kinds.items()})

    # -- the simulation ----------------------------------------------------------------------

    def _features(self, request: RosMessage, reply: Reply) -> None:
        info = "MORSE: entities are robots (ATRV) and models (props/crates) by name, or described by a text"
        newer = [number for name, number in _NEWER.items() if f"/{NODE}/{name}" in self.names]
        features = [*FEATURES, *newer, *([_STEPS_ACTION] if action_type() is not None else [])]
        reply({"features": {"features": features, "spawn_formats": list(_FORMATS), "custom_info": info}})

    def _state(self, request: RosMessage, reply: Reply) -> None:
        reply({"state": {"state": _PAUSED if self._context.paused() else _PLAYING}, "result": _result()})

    def _set_state(self, request: DecodedMessage, reply: Reply) -> None:
        target = request["state"]["state"]
        services = {_STOPPED: ("reset", "pause"), _PLAYING: ("resume",), _PAUSED: ("pause",), _QUITTING: ("quit",)}
        if target not in services:
            reply({"result": _result(_UNSUPPORTED, f"there is no state {target}")})
        elif target == (_PAUSED if self._context.paused() else _PLAYING):
            reply({"result": _result(_ALREADY, "it is in that state already")})
        else:
            outcomes: list[Outcome] = []
            for service in services[target]:
                self._call("simulation", service, [], outcomes.append)
            bad = [text for state, text in outcomes if state != status.SUCCESS]
            reply({"result": _result(_FAILED, str(bad[0])) if bad else _result()})

    def _reset(self, request: RosMessage, reply: Reply) -> None:
        if request["scope"] not in _WHOLE:
            text = "only everything together can be reset: time, state and what was spawned (scope 0 or 255)"
            reply({"result": _result(_UNSUPPORTED, text)})
            return
        self._call("simulation", "reset", [], _then(reply))

    def _step(self, request: DecodedMessage, reply: Reply) -> None:
        if not self._context.paused():
            reply({"result": _result(_INCORRECT_STATE, "the simulation is not paused")})
            return
        self._call("simulation", "step", [int(request["steps"])], _then(reply))

    # -- entities ----------------------------------------------------------------------------

    def _names(self) -> Iterator[str]:
        return (root.name for root in self._roots())

    def _roots(self) -> Iterator[Node]:
        for root in self._context.scene.roots:
            if root.name in self._context.world.objects_by_name:
                yield root

    def _root(self, name: str, reply: Reply) -> Node | None:
        """The node of an entity; without one, the call is answered."""
        for root in self._roots():
            if root.name == name:
                return root
        reply({"result": _result(_NOT_FOUND, f"there is no entity {name!r:.80}")})
        return None

    def _chosen(self, request: DecodedMessage) -> tuple[list[str], RosMessage]:
        filters = request["filters"]
        categories = {category["category"] for category in filters["categories"]}
        wrong = mistake(filters["bounds"]) if filters["bounds"]["type"] else None
        if wrong is not None:
            return [], _result(_UNSUPPORTED if filters["bounds"]["type"] == HULL else _FAILED, wrong)
        roots, result = self._of_names(filters["filter"])
        roots = [root for root in roots if not categories or self._info(root)["category"]["category"] in categories]
        roots = [root for root in roots if chosen(self._info(root)["tags"], filters["tags"])]
        if filters["bounds"]["type"]:
            inside, until = [], thread_time() + _LONGEST_SEARCH
            for root in roots:
                box = box_of(self._context.world, root)
                if box is not None and overlap(box, filters["bounds"]):
                    inside.append(root)
                if thread_time() > until:
                    return [], _result(_FAILED, "filters.bounds takes too long: choose entities by their names as well")
            roots = inside
        return [root.name for root in roots], result

    def _of_names(self, pattern: str) -> tuple[list[Node], RosMessage]:
        roots = list(self._roots())
        if not pattern:
            return roots, _result()
        if len(pattern) > _LONGEST or not _HARMLESS.fullmatch(pattern):
            text = f"a filter has no groups, no + ? {{}} and at most {_MOST_STARS} times *; | is allowed"
            return [], _result(_UNSUPPORTED, text)
        try:
            expression = re.compile(pattern)
        except re.error as error:
            return [], _result(_FAILED, f"the filter is not a regular expression: {error}")
        # names are chosen by clients as well: some expressions take tens of milliseconds for some names
        matches, until = [], thread_time() + _LONGEST_SEARCH
        for root in roots:
            if expression.search(root.name):
                matches.append(root)
            if thread_time() > until:
                return [], _result(_FAILED, "the filter takes too long: use fewer *")
        return matches, _result()

    def _entities(self, request: RosMessage, reply: Reply) -> None:
        names, result = self._chosen(request)
        reply({"result": result, "entities": names})

    def _entities_states(self, request: RosMessage, reply: Reply) -> None:
        names, result = self._chosen(request)
        reply({"result": result, "entities": names, "states": [self._state_of(name) for name in names]})

    def _entity_state(self, request: DecodedMessage, reply: Reply) -> None:
        name = request["entity"]
        if name not in self._names():
            reply({"result": _result(_NOT_FOUND, f"there is no entity {name!r:.80}")})
        else:
            reply({"result": _result(), "state": self._state_of(name)})

    def _info(self, root: Node) -> DecodedMessage:
        notes = self._notes.of(root)
        if notes is not None:
            return notes
        robot = self._context.robots.get(root.name)
        text = f"robot, {type(robot).__name__}" if robot is not None else "object"
        return {"category": {"category": _OBJECT if robot is None else _ROBOT}, "description": text, "tags": []}

    def _entity_info(self, request: DecodedMessage, reply: Reply) -> None:
        root = self._root(request["entity"], reply)
        if root is not None:
            reply({"result": _result(), "info": self._info(root)})

    def _set_entity_info(self, request: DecodedMessage, reply: Reply) -> None:
        root = self._root(request["entity"], reply)
        if root is not None:
            wrong = self._notes.set(root, request["info"])
            reply({"result": _result() if wrong is None else _result(_FAILED, wrong)})

    def _entity_bounds(self, request: DecodedMessage, reply: Reply) -> None:
        root = self._root(request["entity"], reply)
        if root is not None:
            reply({"result": _result(), "bounds": bounds(box_of(self._context.world, root))})

    def _named_poses(self, request: DecodedMessage, reply: Reply) -> None:
        reply({"result": _result(), "poses": named_poses(self._context.scene.zones, request["tags"])})

    def _named_pose_bounds(self, request: DecodedMessage, reply: Reply) -> None:
        limits = pose_bounds(self._context.scene.zones, request["name"])
        if limits is None:
            reply({"result": _result(_NOT_FOUND, f"there is no zone {request['name']!r:.80}")})
        else:
            reply({"result": _result(), "bounds": limits})

    def _state_of(self, name: str) -> RosMessage:
        body = self._context.world.objects_by_name[name]
        from morse.helpers.transformation import Transformation3d

        pose = Transformation3d(body)
        linear, angular = body.velocity()
        return {
            "header": header_at(self._context.clock.stamp(), "map"),
            "pose": {"position": xyz((pose.x, pose.y, pose.z)), "orientation": quaternion(quaternion_of(pose))},
            "twist": {"linear": xyz(linear), "angular": xyz(angular)},
        }

    def _set_entity_state(self, request: DecodedMessage, reply: Reply) -> None:
        name, state = request["entity"], request["state"]
        speeds = [*from_xyz(state["twist"]["linear"]), *from_xyz(state["twist"]["angular"])]
        if name not in self._names():
            reply({"result": _result(_NOT_FOUND, f"there is no entity {name!r:.80}")})
        elif state["header"]["frame_id"] not in _WORLDS:
            reply({"result": _result(_FAILED, "a pose is given in the frame 'map'")})
        elif any(speeds):
            reply({"result": _result(_UNSUPPORTED, "an entity is put somewhere at rest: its twist has to be zero")})
        else:
            pose = state["pose"]
            arguments = [name, from_xyz(pose["position"]), _turn(pose)]
            self._call("simulation", "set_object_pose", arguments, _then(reply))

    # -- worlds ------------------------------------------------------------------------------

    def _world(self, request: RosMessage, reply: Reply) -> None:
        reply({"result": _result(), "world": _resource(self._context.scene.environment)})

    def _worlds(self, request: DecodedMessage, reply: Reply) -> None:
        def ended(outcome: Outcome) -> None:
            state, names = outcome
            if state == status.SUCCESS:
                reply({"result": _result(), "worlds": [_resource(name) for name in names]})
            else:
                reply({"result": _result(_FAILED, str(names or state))})

        if len(request["additional_sources"]):
            reply({"result": _result(_FAILED, "worlds come from MORSE and from the project: sources are empty")})
        elif len(request["filter"]["tags"]):
            reply({"result": _result(), "worlds": []})  # they have no tags
        else:
            self._call("simulation", "list_environments", [], ended)

    # -- spawning and deleting ---------------------------------------------------------------

    def _spawnables(self, request: DecodedMessage, reply: Reply) -> None:
        def ended(outcome: Outcome) -> None:
            state, kinds = outcome
            if state != status.SUCCESS:
                reply({"result": _result(_FAILED, str(kinds or state))})
                return
            spawnables = [{"uri": uri, "description": text} for uri, text in kinds.items()]
            reply({"result": _result(), "spawnables": spawnables})

        if len(request["sources"]):
            reply({"result": _result(_FAILED, "spawnables come from MORSE and from the project: sources are empty")})
            return
        self._call("simulation", "list_spawnables", [], ended)

    def _spawn(self, request: DecodedMessage, reply: Reply) -> None:
        # version 2 of the package has both in a message of their own
        request = {**request, **request.get("entity_resource", {})}
        name, wrong = self._name_of(request)
        pose = request["initial_pose"]
        kind = request["resource_string"] or request["uri"]
        if wrong is None and request["resource_string"] and not is_description(kind):
            wrong = _result(_NO_FORMAT, f"a resource string is the text of a robot in one of {', '.join(_FORMATS)}")
        if wrong is None and not kind:
            text = "give a uri, the name of a robot (ATRV) or of a model (props/crates), or a resource string"
            wrong = _result(_NO_RESOURCE, text)
        if wrong is None and request["entity_namespace"].strip("/") not in ("", name):
            wrong = _result(_NO_NAMESPACE, "the topics of a robot are below its name")
        if wrong is None and pose["header"]["frame_id"] not in _WORLDS:
            wrong = _result(_BAD_POSE, "a pose is given in the frame 'map'")
        if wrong is not None:
            reply({"result": wrong, "entity_name": ""})
            return
        position = from_xyz(pose["pose"]["position"])
        roll, pitch, yaw = Quaternion(_turn(pose["pose"])).to_euler()
        arguments = [name, kind, position, [roll, pitch, yaw]]
        self._call("simulation", "spawn", arguments, _then(reply, {"entity_name": name}))

    def _name_of(self, request: DecodedMessage) -> tuple[str, RosMessage | None]:
        match = _NAME.search(request["resource_string"]) if request["resource_string"] else None
        kind = match[1] if match is not None else request["uri"].rpartition("/")[2]
        base = request["name"] or word_of(kind).lower()
        try:
            check_name(base)
        except MorseBuilderError as error:
            return base, _result(_NAME_INVALID, str(error))
        if base not in self._context.world.objects_by_name:
            return base, None
        if request["name"] and not request["allow_renaming"]:
            return base, _result(_NOT_UNIQUE, f"there is an entity {base!r:.80} already")
        present = {name.lower() for name in self._context.world.objects_by_name}
        return free_name(base[:_LONGEST_BASE], lambda name: name.lower() in present, first=1), None

    def _delete(self, request: DecodedMessage, reply: Reply) -> None:
        name = request["entity"]
        if name not in self._names():
            reply({"result": _result(_NOT_FOUND, f"there is no entity {name!r:.80}")})
        else:
            self._call("simulation", "delete", [name], _then(reply))


def _resource(name: str) -> RosMessage:
    """WorldResource of an environment."""
    return {
        "name": name,
        "world_resource": {"uri": name, "resource_string": ""},
        "description": f"environment of MORSE: Environment({name!r})",
        "tags": [],
    }


def _result(code: int = _OK, text: str = "") -> RosMessage:
    return {"result": code, "error_message": text}


def _then(reply: Reply, more: RosMessage | None = None) -> Callable[[Outcome], object]:
    """A callback that answers with the outcome of a service."""

    def ended(outcome: Outcome) -> None:
        state, text = outcome
        good = state == status.SUCCESS
        reply({"result": _result(), **(more or {})} if good else {"result": _result(_FAILED, str(text or state))})

    return ended


def _turn(pose: DecodedMessage) -> list[float]:
    """W, x, y, z; the identity if all are 0."""
    quaternion = from_quaternion(pose["orientation"])
    if not any(quaternion):
        return [1.0, 0.0, 0.0, 0.0]
    return list(quaternion_of(pose_of((0.0, 0.0, 0.0), _unit(quaternion))))


def _unit(quaternion: list[float]) -> list[float]:
    length = sum(number * number for number in quaternion) ** 0.5
    return [number / length for number in quaternion] if 0.0 < length < float("inf") else [1.0, 0.0, 0.0, 0.0]
