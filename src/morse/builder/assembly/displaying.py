"""Checks what a script wants to be shown, and finds the components by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

from morse.builder.errors import ScriptError, Step, checks
from morse.builder.names.classes import load_class
from morse.core.declarations import data_fields, properties
from morse.scene.scene import Display, Overlay, PanelPlace

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.builder.assembly.description import Wish
    from morse.builder.workspace import Workspace
    from morse.scene import ComponentDeclaration


class Displaying:
    """The components and objects of a scene, by their names.

    Args:
        workspace: the objects of the script.
        components: the declarations of the components.
    """

    def __init__(self, workspace: Workspace, components: Iterable[ComponentDeclaration]) -> None:
        self._components = {component.name: component for component in components}
        self._workspace = workspace

    def display(self, wishes: Mapping[str, Wish]) -> Display:
        """What the view shows at first.

        Args:
            wishes: the arguments of ``env.show``.

        Raises:
            ScriptError: a component, a field or a word is unknown.
        """
        display = Display()
        for name, (where, value) in wishes.items():
            try:
                getattr(self, f"_{name}")(display, value)
            except (TypeError, ValueError) as error:
                raise ScriptError(str(error), [Step(where)] if where else []) from None
        return display

    def _rays(self, display: Display, value: object) -> None:
        if isinstance(value, bool):
            display.overlays = tuple(dict.fromkeys((*display.overlays, *(("rays",) if value else ()))))
        else:
            display.rays = tuple(self._component(one, "env.show(rays=[...])") for one in _items(value, "rays"))

    def _images(self, display: Display, value: object) -> None:
        what = "env.show(images=[...])"
        names = [name for one in _items(value, "images") for name in self._cameras(one, what)]
        display.images = tuple(dict.fromkeys((*display.images, *names)))

    def _display_camera(self, display: Display, camera: Any) -> None:
        display.images = tuple(dict.fromkeys((*display.images, camera.name)))

    def _plots(self, display: Display, value: object) -> None:
        diagrams = [[one] if isinstance(one, str) else _items(one, "plots") for one in _items(value, "plots")]
        display.plots = tuple(tuple(self._curve(curve) for curve in curves) for curves in diagrams)

    def _follow(self, display: Display, value: object) -> None:
        names = {node.name: None for node in self._workspace.nodes()}
        display.follow = _name_of(value, names, "env.show(follow=...)", "object")

    def _select(self, display: Display, value: object) -> None:
        display.select = self._component(value, "env.show(select=...)")

    def _overlays(self, display: Display, value: object) -> None:
        words = [_word(one, get_args(Overlay), "overlays") for one in _items(value, "overlays")]
        display.overlays = tuple(dict.fromkeys((*display.overlays, *words)))

    def _layout(self, display: Display, value: object) -> None:
        display.panels = tuple(_word(one, get_args(PanelPlace), "layout") for one in _items(value, "layout"))

    def _component(self, value: object, what: str) -> str:
        return _name_of(value, self._components, what, "component")

    def _cameras(self, value: object, what: str) -> list[str]:
        """A camera, or the cameras of a part that consists of several, such as a Kinect."""
        cameras = [name for name, component in self._components.items() if _is_camera(component)]
        names = {name: None for camera in cameras for name in _prefixes(camera)}
        name = _name_of(value, names, what, "camera")
        return [camera for camera in cameras if camera == name or camera.startswith(f"{name}.")]

    def _curve(self, value: object) -> tuple[str, str]:
        """Component and field of the text ``component.field``."""
        what = "env.show(plots=[...])"
        text = checks.text(value, what)
        owner, dot, field = text.rpartition(".")
        if text in self._components:
            fields = self._fields(text)
            example = f", such as '{text}.{fields[0]}'" if fields else ", which has none"
            raise ValueError(f"{what} takes a field of '{text}'{example}")
        name = _name_of(owner if dot else text, self._components, what, "component")
        fields = self._fields(name)
        if field not in fields:
            raise ValueError(f"{what}: '{name}' has no field '{field}'{checks.suggestion(field, fields)}")
        return name, field

    def _fields(self, name: str) -> list[str]:
        component = self._components[name]
        fields = data_fields(load_class(component.classpath))
        return [field for field, declared in fields.items() if declared.on_level(component.level)]


def _is_camera(component: ComponentDeclaration) -> bool:
    cls = load_class(component.classpath)
    return "image" in data_fields(cls) or any(one.name == "cam_width" for one in properties(cls).values())


def _prefixes(text: str) -> Iterable[str]:
    """``a.b.c``, ``a.b``, ``a``."""
    while text:
        yield text
        text = text.rpartition(".")[0]


def _name_of(value: object, names: Iterable[str], what: str, kind: str) -> str:
    name = value if isinstance(value, str) else getattr(value, "name", None)
    if not isinstance(name, str):
        raise TypeError(
            f"{what} takes a {kind} or its name, got {checks.shown(value)}".replace("a object", "an object")
        )
    names = list(names)
    if name in names:
        return name
    last = name.rpartition(".")[2]
    same = [one for one in names if one.rpartition(".")[2] == last]
    hint = f"; did you mean '{same[0]}'?" if len(same) == 1 else checks.suggestion(name, names)
    raise ValueError(f"{what}: there is no {kind} '{name}'{hint}")


def _items(value: object, argument: str) -> list[Any]:
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        raise TypeError(f"env.show({argument}=[...]) takes a list, got {checks.shown(value)}")
    return list(value)


def _word(value: object, words: tuple[Any, ...], argument: str) -> Any:
    return checks.choice(value, words, f"env.show({argument}=[...])")
