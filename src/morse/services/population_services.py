"""Services that spawn and delete robots and objects; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import EulerAngles, Point
from morse.core.services import service
from morse.helpers.descriptions import OWN_CLASS, is_description
from morse.services.foreign_models import check_model

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence


class Population(Protocol):
    """The robots and objects of a simulation."""

    def restart(self, name: str, seed: int | None) -> None:
        """Restart one robot."""

    def kinds(self) -> dict[str, str]:
        """Robots and models by name, each with a sentence."""

    def environments(self) -> list[str]:
        """Environments by name."""


class Populated(Protocol):
    """The part of a simulation that the services need."""

    def spawn(
        self, name: str, kind: str, position: Sequence[float], rotation: Sequence[float], *, by_client: bool
    ) -> object:
        """Spawn a robot or an object."""

    def delete(self, name: str) -> None:
        """Delete a robot or an object."""

    @property
    def population(self) -> Population:
        """The present robots and objects."""


class PopulationServices(AbstractObject):
    """Spawning and deletion of robots and objects.

    Args:
        folders: returns the folders with models that clients may spawn.
    """

    def __init__(self, simulation: Populated, folders: Callable[[], Sequence[str | os.PathLike[str]]]) -> None:
        super().__init__()
        self._simulation = simulation
        self._folders = folders

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)  # the simulation records the call itself
    def spawn(self, name: str, kind: str, position: Point | None = None, orientation: EulerAngles | None = None) -> str:
        """Spawn a robot or an object in the scene, or a component of a robot.

        Models are read from the folders of the project, of ``MORSE_RESOURCE_PATH`` and of MORSE, and from the folder in
        which the simulation was started.

        Args:
            name: name of the new object: letters (a to z), digits and ``_``; it must not exist in the simulation, nor
                be reserved, such as ``simulation``; for a component, the name of its robot, or of the arm, pan-tilt
                unit or other component that carries it, a dot, and such a name: ``robot.camera``.
            kind: name of a robot in scene scripts, e.g. ``ATRV``, of a robot of the project, e.g.
                ``ranger_sim.builder.robots:Ranger``, of a model, e.g. ``props/crates``, or of an object of a model,
                e.g. ``props/crates#small_crate``; a robot of a file, e.g. ``Robot('arm/arm.urdf')``; or the text of a
                robot in URDF, SDF or MJCF: it has the sensors and the drive of the text. For a component, a class of
                scene scripts, e.g. ``VideoCamera``, which lines with calls may follow: ``frequency(10)``,
                ``alter('Noise')``, and ``append(child='hand')`` for a part of what carries it. For an object, the
                lines ``scale(2.0, 2.0, 1.0)``, ``set_physics_type('RIGID_BODY')``, ``set_mass(2.0)``,
                ``set_friction(0.5)``, ``set_restitution(0.8)``, ``set_damping(0.1, 0.1)`` and, for a solid,
                ``color(1.0, 0.0, 0.0)`` may follow.
            position: x, y, z in the world, m; for a component, in the frame of what carries it; the origin if not
                given, and for the end of an arm its tip.
            orientation: roll, pitch, yaw, rad.
        """
        own = kind if is_description(kind) else kind.partition("\n")[0]
        if not is_description(kind) and not OWN_CLASS.fullmatch(own):
            check_model(own, self._folders())
        place, angles = position or [0.0] * 3, orientation or [0.0] * 3
        self._attempt(lambda: self._simulation.spawn(name, kind, place, angles, by_client=True))
        return name

    @service(changes=False)  # the simulation records the call itself
    def delete(self, name: str) -> None:
        """Delete a robot, an object or a component with all its parts."""
        self._attempt(lambda: self._simulation.delete(name))

    @service(changes=False)
    def list_spawnables(self) -> dict[str, str]:
        """The robots and models that can be spawned by name, with a sentence about each.

        Models are those in the folders of the project, of ``MORSE_RESOURCE_PATH`` and of MORSE.
        """
        return self._simulation.population.kinds()

    @service(changes=False)
    def list_environments(self) -> list[str]:
        """The environments of MORSE and of the project by name, as scene scripts have them."""
        return self._simulation.population.environments()

    @service
    def restart_robot(self, name: str, seed: int | None = None) -> None:
        """Restart one robot as after the launch; time, the other robots and the objects go on.

        Args:
            seed: seed of its random numbers; the present one if not given.
        """
        self._attempt(lambda: self._simulation.population.restart(name, seed))

    @staticmethod
    def _attempt(change: Callable[[], object]) -> None:
        try:
            change()
        except (ValueError, TypeError, SyntaxError, OSError) as error:
            raise MorseRPCInvokationError(str(error)) from None
