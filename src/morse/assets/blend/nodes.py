"""A shader node tree: nodes, their sockets, and the links between them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.assets.blend.record import Record

_MUTED = 1 << 9
_OUTPUT = 1 << 6
#: maximum number of reroutes and muted nodes between a socket and the node that feeds it
_DEPTH = 32


class Node:
    """A node of the tree.

    Attributes:
        kind: e.g. ``ShaderNodeBsdfPrincipled``.
    """

    def __init__(self, tree: NodeTree, record: Record) -> None:
        self.tree = tree
        self.record = record
        self.kind = record.text("idname") or _OLD_KINDS.get(record.integer("type"), "")

    @cached_property
    def inputs(self) -> list[Record]:
        """The input sockets."""
        return list(self.record.chain("inputs", "bNodeSocket"))

    @cached_property
    def _named_inputs(self) -> dict[str, Record]:
        # the first of each name
        return {socket.text("name"): socket for socket in reversed(self.inputs)}

    def socket(self, *names: str) -> Record | None:
        """The first input of one of these names."""
        return next((self._named_inputs[name] for name in names if name in self._named_inputs), None)

    def source(self, *names: str) -> Node | None:
        """The node that feeds an input."""
        socket = self.socket(*names)
        return None if socket is None else self.tree.source(socket)

    def value(self, *names: str, default: float) -> float:
        """Return the value of an unconnected input; the default otherwise."""
        socket = self.socket(*names)
        if socket is None or self.tree.source(socket) is not None:
            return default
        holder = socket.follow("default_value")
        return default if holder is None else holder.real("value", default)

    def color(self, *names: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the colour of an input or of the RGB node that feeds it; the default otherwise."""
        socket = self.socket(*names)
        if socket is None:
            return default
        source = self.tree.source(socket)
        if source is not None:
            if source.kind != "ShaderNodeRGB":
                return default
            socket = next(source.record.chain("outputs", "bNodeSocket"), None)
        holder = None if socket is None else socket.follow("default_value")
        if holder is None:
            return default
        red, green, blue = holder.reals("value", default)
        return red, green, blue

    def image(self, *names: str) -> Record | None:
        """Return the image that feeds an input, directly or through nodes that change its colours."""
        source = self.source(*names)
        queue, nodes_so_far = [source] if source else [], set[Node]()
        while queue:
            node = queue.pop()
            if node in nodes_so_far:
                continue
            nodes_so_far.add(node)
            if node.kind in ("ShaderNodeTexImage", "ShaderNodeTexEnvironment"):
                return node.record.follow("id", "Image")
            sources = [self.tree.source(socket) for socket in node.inputs]
            queue.extend(source for source in reversed(sources) if source)
        return None


class NodeTree:
    """A shader node tree."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self._nodes = {node.block.address: Node(self, node) for node in record.chain("nodes", "bNode")}
        self._sources = {
            link.integer("tosock"): link.integer("fromnode") for link in record.chain("links", "bNodeLink")
        }

    def nodes(self) -> Iterator[Node]:
        """All nodes."""
        yield from self._nodes.values()

    def source(self, socket: Record) -> Node | None:
        """The node that feeds a socket, directly or through reroutes and muted nodes."""
        for _ in range(_DEPTH):
            node = self._nodes.get(self._sources.get(socket.block.address, 0))
            if node is None or not (node.kind == "NodeReroute" or node.record.integer("flag") & _MUTED):
                return node
            entry_socket = next((entry for entry in node.inputs if entry.block.address in self._sources), None)
            if entry_socket is None:
                return None
            socket = entry_socket
        return None

    def output(self, kind: str) -> Node | None:
        """The active output node."""
        outputs = [node for node in self._nodes.values() if node.kind == kind]
        return next(
            (node for node in outputs if node.record.integer("flag") & _OUTPUT), outputs[0] if outputs else None
        )


#: numbers of the kinds before nodes had names of their kind (2.5 to 2.65)
_OLD_KINDS = {
    101: "ShaderNodeRGB", 124: "ShaderNodeOutputMaterial", 125: "ShaderNodeEmission", 126: "ShaderNodeBsdfDiffuse",
    128: "ShaderNodeMixShader", 129: "ShaderNodeAddShader", 140: "ShaderNodeEmission", 143: "ShaderNodeTexImage",
}  # fmt: skip
