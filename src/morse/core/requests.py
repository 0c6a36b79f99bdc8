"""Requests of components to servers that answer many of them in one call: rays, images.

A component makes its requests once. In every tick in which it is due, the simulation hands the requests of all such
components to their servers, each in one call, and then the components act and find the answers in their requests.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


class Server(Protocol):
    """Answers requests."""

    def serve(self, requests: Sequence[Any]) -> None:
        """Answer these requests, all of them its own, as the world is now."""


class Request(Protocol):
    """Something that a component wants to know whenever it acts; the server writes the answer into it."""

    @property
    def server(self) -> Server:
        """Who answers it."""


class Requesting:
    """The part of a component that asks servers.

    Attributes:
        requests: all that it asks for, in the order of `add_request`.
        rays: the first bundle of rays (`morse.physics.RayBundle`), or None.
    """

    requests: Sequence[Request] = ()
    rays: Any = None
    bge_object: Any
    context: Any

    def add_request(self, request: Any) -> Any:
        """Have a request answered before each action; call it in ``__init__``.

        Returns:
            The request.
        """
        self.requests = [*self.requests, request]
        return request

    def remove_request(self, request: Any) -> None:
        """Have a request answered no more."""
        self.requests = [one for one in self.requests if one is not request]
        if request is self.rays:
            self.rays = None

    def add_rays(self, directions: Any, reach: float, origins: Any = None, *, upright: bool = False) -> Any:
        """Look along rays; call it in ``__init__``, once for each bundle of rays.

        They are cast together with those of all other components, before ``default_action``, which finds what they
        met in the bundle: ``distances``, ``points``, ``hit``, ``object_of(i)``, ``remissions``. They pass
        through the own robot and through everything that does not collide. The first bundle is ``self.rays``.

        Args:
            directions: (N, 3) vectors in the frame of the component.
            reach: metres.
            origins: (N, 3) metres in the frame of the component; None if all rays start at its origin.
            upright: directions and origins are along the axes of the world, however the component is turned.

        Returns:
            The bundle.

        Raises:
            ValueError: arrays of another shape, numbers that are not finite, directions of no length, no reach.
        """
        bundle = self.context.world.rays.bundle(self.bge_object, directions, reach, origins, upright=upright)
        if self.rays is None:
            self.rays = bundle
        return self.add_request(bundle)


def serve(components: Iterable[Any]) -> None:
    """Have the requests of the active ones among some components answered, with one call for each server."""
    waiting: dict[Server, list[Request]] = {}
    for component in components:
        if component.active:
            for request in component.requests:
                waiting.setdefault(request.server, []).append(request)
    for server, requests in waiting.items():
        server.serve(requests)
