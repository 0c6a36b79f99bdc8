"""Loading of models into the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets import find, load
from morse.assets.search import worlds_with
from morse.builder import workspace
from morse.builder.assembly.selection import take
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.core.exceptions import MorseBuilderNoComponentError
from morse.scene import Choice

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.scene import Library, Node, Role


class Models:
    """The part of `AbstractComponent` that loads model files.

    Objects whose names begin with ``_`` are not loaded.
    """

    _category: str
    _blendname: str
    _role: Role = "prop"
    #: of a file of xacro
    _arguments: Mapping[str, str] | None = None

    def _library(self, component: str | None = None) -> Library:
        """The content of a model file.

        Args:
            component: its name (see `morse.assets.find`), if it differs from the name of this component.

        Raises:
            FileNotFoundError: there is no such model; the message lists the searched directories.
        """
        return load(find(component or self._blendname, self._category), self._arguments)

    def append_meshes(
        self, objects: Iterable[str] | None = None, component: str | None = None, prefix: str | None = None
    ) -> list[SceneObject]:
        """Add objects of a model file to the scene, and return those without a parent.

        Args:
            objects: names of objects, each with all objects below it; None for all objects.
            component: name of the model, if it differs from the name of this component.
            prefix: only objects whose names begin with it, or that are in the collection of that name.

        Raises:
            FileNotFoundError: there is no such model.
            MorseBuilderNoComponentError: no object in the model has such a name.
        """
        library = self._library(component)
        names = None if objects is None else tuple(checks.names(objects, "append_meshes(objects)"))
        roots = _into_scene(library, Choice(self._role, names=names, prefix=prefix))
        if not roots:
            pattern = prefix if prefix is not None else ", ".join(names or ())
            candidates = [node.plain_name for node in library.nodes()] + list(library.collections)
            what = f"'{pattern}'" if pattern else "object"
            hint = checks.suggestion(pattern, candidates) + worlds_with(pattern)
            raise MorseBuilderNoComponentError(f"no {what} in {library.path}{hint}")
        return [SceneObject(root) for root in roots]

    def append_scenes(self, filename: str | None = None) -> list[SceneObject]:
        """Add all objects of a model file to the scene, and return those without a parent.

        Raises:
            FileNotFoundError: there is no such model.
        """
        roots = _into_scene(self._library(filename), Choice(self._role))
        return [SceneObject(root) for root in roots]

    def append_model(self, component: str | None = None) -> SceneObject:
        """Add a whole model file to the scene as one object, the root, with all other objects below it.

        Raises:
            FileNotFoundError: there is no such model.
            AssetError: the model contains no object.
        """
        roots = _into_scene(self._library(component), Choice(self._role, whole=True))
        return SceneObject(roots[0])

    def append_collada(self, component: str | None = None) -> list[SceneObject]:
        """Add all objects of a COLLADA file to the scene, and return those without a parent.

        Args:
            component: name of the file; ``.dae`` may be omitted.

        Raises:
            FileNotFoundError: there is no such file.
            AssetError: it is damaged, or the package that reads COLLADA files is not installed.
        """
        name = component or self._blendname
        return self.append_scenes(name if name.lower().endswith(".dae") else f"{name}.dae")


def _into_scene(library: Library, choice: Choice) -> list[Node]:
    roots, use = take(library, choice)
    workspace.current().add_model(roots, use)
    return roots
