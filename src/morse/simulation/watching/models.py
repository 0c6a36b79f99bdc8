"""Updates the scene when a model file was saved."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.assets import load
from morse.assets.following import follow, resolve
from morse.builder.assembly.selection import take
from morse.physics.model.bottom import bottom_of

if TYPE_CHECKING:
    from morse.assets.following import Revision
    from morse.physics.state.scene_change import SceneChange
    from morse.scene import ModelUse, Node
    from morse.simulation.simulation import Simulation


@dataclass
class ModelEdit:
    """The changes of a saved file, computed in another thread and applied between two ticks.

    Attributes:
        arrangement: arrangement of the scene for which the edit was computed, see `morse.physics.World`.
        latest: the uses of the file, and their records after the edit.
    """

    path: str
    arrangement: int
    latest: list[tuple[ModelUse, Revision]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def summary(self) -> str:
        """Return a description of the changes for the user."""
        revisions = [revision for _, revision in self.latest]
        counts = (
            (sum(len(revision.replaced) for revision in revisions), "changed"),
            (sum(len(revision.come) for revision in revisions), "new"),
            (sum(len(revision.gone) for revision in revisions), "gone"),
        )
        return ", ".join(f"{count} {word}" for count, word in counts if count) or "nothing visible"


def prepare(simulation: Simulation, path: str) -> ModelEdit:
    """Read a file and compute its changes; may be called in another thread than the simulation.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is damaged.
        LookupError: the file does not contain any of the objects that the scene uses.
    """
    scene = simulation.scene
    edit = ModelEdit(path, simulation.world.arrangement)
    library = load(path)
    for use in [use for use in scene.models if use.path == path]:
        roots, latest = take(library, use.choice)
        if not roots:
            raise LookupError("it no longer contains any of the objects that the scene uses")
        revision = follow(scene, use, roots, latest)
        edit.latest.append((use, revision))
        edit.warnings += revision.warnings
    edit.warnings += resolve([revision for _, revision in edit.latest])
    return edit


def carry_out(simulation: Simulation, edit: ModelEdit) -> None:
    """Insert the new nodes into the running scene.

    Raises:
        ValueError: the engine refuses a shape; the scene is then unchanged.
    """
    revisions = [revision for _, revision in edit.latest]
    pairs = [pair for revision in revisions for pair in revision.replaced]
    come: list[Node] = [root for revision in revisions for root in revision.come]
    nodes: list[Node] = [node for revision in revisions for node in revision.gone]

    def rebuild(change: SceneChange) -> None:
        for revision in revisions:
            for node, place in revision.moved:
                change.move(node, place)
        for now, after in pairs:
            change.replace(now, after)
        change.remove(nodes)
        change.add(come, ())

    if pairs or come or nodes:
        world = simulation.world
        bottoms = {now.name: bottom_of(world, now) for now, _ in pairs if world.object_of(now).is_dynamic}
        world.rebuild(rebuild)
        for _, after in pairs:
            _lift(simulation, after, bottoms.get(after.name))
        simulation.population.edited(pairs, come, nodes)
    records = {id(use): revision.use for use, revision in edit.latest}
    models = simulation.scene.models
    models[:] = [records.get(id(use), use) for use in models]


def _lift(simulation: Simulation, node: Node, bottom: float | None) -> None:
    """Raise a body whose new model reaches lower than the old one, so that it does not penetrate the ground."""
    reaches = bottom_of(simulation.world, node)
    if bottom is not None and reaches is not None and reaches < bottom:
        body = simulation.world.object_of(node)
        x, y, z = body.worldPosition
        body.worldPosition = (x, y, z + bottom - reaches)
