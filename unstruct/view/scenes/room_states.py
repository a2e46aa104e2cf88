"""A front by empty circles in a room with a wall and one more point, which the reader moves."""

from __future__ import annotations

from ...base.errors import InputError
from ...plain.advancing_front import boundary_front
from ...plain.front_delaunay import front_delaunay
from ..draw import frames as fr
from .fronts import empty_circle_frames

__all__ = ["ROOM_CORNERS", "ROOM_WALLS", "ROOM_X", "ROOM_Y", "room_state"]

ROOM_CORNERS = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.9, 1.5), (3.1, 1.6)]
ROOM_WALLS = {"a wall": [(4, 5)], "no wall": []}
ROOM_X = [round(0.5 + 0.5 * k, 1) for k in range(7)]  # where the loose point may be: never on the wall
ROOM_Y = [0.3, 0.7, 1.1, 1.45, 1.75, 2.2, 2.6]


def room_state(x: float = 2.0, y: float = 1.45, wall: str = "a wall") -> list[fr.Frame]:
    """The plain front by empty circles in a rectangular room, step by step.

    Parameters
    ----------
    x, y : float
        The loose point 6, inside of the room and not on the wall; the reader can drag it.
    wall : "a wall" or "no wall"
        Whether 4 and 5 are joined.

    Returns
    -------
    list of dict
        One frame for each step, with the points in the circle that are hidden, and one for the result: in
        how many circles there were such points.

    Raises
    ------
    InputError
        For another wall.
    """
    if wall not in ROOM_WALLS:
        raise InputError(f"wall = {wall!r} must be one of {', '.join(map(repr, ROOM_WALLS))}")
    points, sides, inner = [*ROOM_CORNERS, (x, y)], [(0, 1), (1, 2), (2, 3), (3, 0)], ROOM_WALLS[wall]
    steps = list(front_delaunay(points, sides, inner=inner))
    frames = empty_circle_frames(points, boundary_front(points, sides, inner).edges, steps)
    hiding = sum(bool(step.hidden) for step in steps)
    frames[-1]["number"] = f"{len(steps)} triangles; circles with a hidden point: {hiding}"
    for one in frames:
        one["items"].append(fr.segments("constrained", [(points[a], points[b]) for a, b in inner]))
        one["items"].append(fr.dots("vertex", [(x, y)], handles=["6"]))
    return frames
