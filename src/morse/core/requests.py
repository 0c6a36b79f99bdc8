"""Batched requests of components to servers: rays, images.

A component creates its requests once. In each tick the simulation passes the requests of all components that act in
this tick to the servers, in one call per server. The components then act and find the answers in their requests.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike

    from morse.core.guard import Guard
    from morse.core.interfaces import Component, Simulated
    from morse.core.world import Body, RayBundle
    from morse.core.world.world import Request, Server

_R = TypeVar("_R", bound="Request")


class Requesting:
    """The part of a component that manages its requests to servers.

    Attributes:
        requests: all requests, in the order of `add_request`.
        rays: the first bundle of rays (`morse.core.world.RayBundle`), or None.
    """

    requests: Sequence[Request] = ()
    rays: RayBundle = None  # type: ignore[assignment] # who reads it has called `add_rays`
    bge_object: Body
    context: Simulated

    def add_request(self, request: _R) -> _R:
        """Register a request that is answered before each action; call it in ``__init__``.

        Returns:
            The request.
        """
        self.requests = [*self.requests, request]
        return request

    def remove_request(self, request: object) -> None:
        """Remove a request."""
        self.requests = [one for one in self.requests if one is not request]
        if request is self.rays:
            self.rays = None  # type: ignore[assignment]

    def add_rays(
        self, directions: ArrayLike, reach: float, origins: ArrayLike | None = None, *, upright: bool = False
    ) -> RayBundle:
        """Cast a bundle of rays before each action; call it in ``__init__``, once for each bundle.

        The rays are cast together with those of all other components before ``default_action``, which reads the results
        from the bundle: ``distances``, ``points``, ``hit``, ``object_of(i)``, ``remissions``. Rays ignore the robot of
        the component and objects that do not collide. The first bundle is ``self.rays``.

        Args:
            directions: (N, 3) vectors in the frame of the component.
            reach: largest distance, m.
            origins: (N, 3) metres in the frame of the component; None if all rays start at its origin.
            upright: whether directions and origins are given along the axes of the world, independent of the
                orientation of the component.

        Returns:
            The bundle.

        Raises:
            ValueError: an array has another shape, a number is not finite, a direction has length 0, or the reach is
                not positive.
        """
        bundle = self.context.world.rays.bundle(self.bge_object, directions, reach, origins, upright=upright)
        if self.rays is None:
            self.rays = bundle
        self.add_request(bundle)
        return bundle


def serve(components: Sequence[Component], guard: Guard) -> None:
    """Answer the requests of the active components, with one call per server.

    If a server fails, or a component cannot tell its requests, each component is served alone: those whose requests
    fail are deactivated, because they have no data to measure from.
    """
    guard.run(lambda: _serve(components), lambda _: guard.each(components, _serve_one, guard.deactivate))


def prepare(components: Iterable[Component]) -> None:
    """Let the servers do now what would delay the first tick; a server may have a method ``prepare`` for this."""
    for server, requests in _by_server(components).items():
        if (do := getattr(server, "prepare", None)) is not None:
            do(requests)


def _serve(components: Iterable[Component]) -> None:
    for server, requests in _by_server(components).items():
        server.serve(requests)


def _by_server(components: Iterable[Component]) -> dict[Server[Request], list[Request]]:
    by_server: dict[Server[Request], list[Request]] = {}
    for component in components:
        if component.active and component.is_wanted():
            for request in component.requests:
                by_server.setdefault(request.server, []).append(request)
    return by_server


def _serve_one(component: Component) -> None:
    _serve((component,))
