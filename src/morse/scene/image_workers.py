"""Where the images of cameras are rendered."""

from __future__ import annotations

from morse.kernel.threads import processors

#: one worker for each processor of this machine
PROCESSES = "processes"
#: begin of the address of a cluster of Ray
RAY = "ray://"
_MOST = 256


def image_workers(place: object) -> int | str:
    """Return the number of worker processes that ``cameras_on`` stands for, 0 for none; or the address of a cluster.

    Args:
        place: ``"processes"``, a number, a text with a number, or None; or ``"ray://auto"`` for the cluster of this
            machine, ``"ray://local"`` for a new one, ``"ray://host:10001"`` for one elsewhere.

    Raises:
        ValueError: it is something else.
    """
    if place is None:
        return 0
    if place == PROCESSES:
        return processors()
    if isinstance(place, str) and place.startswith(RAY) and place != RAY:
        return place
    if isinstance(place, str) and place.isascii() and place.isdigit():
        place = int(place)
    if isinstance(place, int) and not isinstance(place, bool) and 0 <= place <= _MOST:
        return place
    raise ValueError(
        f"cameras_on is 'processes' or a number of processes from 0 to {_MOST}, or 'ray://auto', not {place!r:.80}"
    )
