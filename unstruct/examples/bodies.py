"""Bodies by formulas: functions that are positive inside, zero on the surface and negative outside.

A `LevelSet` is called with points (..., 3). Sphere and torus give the distance from the surface exactly, and
the others a lower bound of it. Random fields are sums of waves, so that they are smooth, and the same for the
same seed on every processor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import as_count, as_seed, finite, positive
from ..base.arrays import as_numbers, frozen, refrozen
from ..base.elementary import cosine, sine, sines
from ..base.errors import InputError
from ..domain.domain import Domain

__all__ = [
    "LevelSet",
    "cube",
    "merged_body",
    "noise",
    "noisy_ball",
    "notch",
    "notched_box",
    "sphere",
    "torus",
]

Array = NDArray[np.float64]
BOX_ROOM = 1.125  # the box of a body is larger than it by this factor


@dataclass(frozen=True, eq=False)
class LevelSet:
    """A body {x : f(x) > 0} in space.

    Attributes
    ----------
    name : str
    function : callable
        Points (k, 3) -> (k,) float64.
    box : (2, 3) float64
        Two corners of a box that contains the body with some room.
    change : float
        No difference of two values is larger than this times the distance of their points.
    """

    name: str
    function: Callable[[Array], Array]
    box: Array
    change: float = 1.0

    def __call__(self, x: ArrayLike) -> Array:
        """The values at points (..., 3): positive inside.

        Raises
        ------
        InputError
            For arrays of another shape.
        """
        points = as_numbers(x, "x").astype(np.float64)
        if points.ndim == 0 or points.shape[-1] != 3:
            raise InputError(f"x must have shape (..., 3), not {points.shape}")
        return self.function(points.reshape(-1, 3)).reshape(points.shape[:-1])

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(refrozen(state))

    def __repr__(self) -> str:
        return f"<LevelSet: {self.name}>"


def _room(half: float | Array) -> Array:
    reach = np.broadcast_to(np.asarray(half, dtype=float) * BOX_ROOM, 3)
    return frozen(np.stack([-reach, reach]))


def _length(*columns: Array) -> Array:
    total = columns[0] * columns[0]
    for column in columns[1:]:
        total = total + column * column
    return np.sqrt(total)


# Functions of the module, not of a call: so bodies can be pickled.


def _in_sphere(radius: float, x: Array) -> Array:
    return radius - _length(*x.T)


def _in_torus(radius: float, tube: float, x: Array) -> Array:
    return tube - _length(_length(x[:, 0], x[:, 1]) - radius, x[:, 2])


def _in_cube(half: float, x: Array) -> Array:
    away = np.abs(x) - half
    out = np.maximum(away, 0.0)
    return np.where((away <= 0.0).all(axis=1), -away.max(axis=1), -_length(*out.T))


def _in_notched_cube(steep: float, depth: float, length: float, x: Array) -> Array:
    below = ((1.0 - depth) + steep * np.abs(x[:, 0]) - x[:, 2]) / length
    return np.minimum(_in_cube(1.0, x), below)


def _in_waves(height: float, rows: list[list[float]], x: Array) -> Array:
    total = np.zeros(len(x))
    for p, q, r, phase in rows:
        total += sines(p * x[:, 0] + q * x[:, 1] + r * x[:, 2] + phase)
    return height * total


def _in_noisy_ball(height: float, field: Callable[[Array], Array], most: float, x: Array) -> Array:
    return 1.0 - _length(*x.T) + np.clip(height * field(x), -most, most)


def sphere(radius: float = 1.0) -> LevelSet:
    """A ball around the origin: the distance from its surface, positive inside.

    Parameters
    ----------
    radius : float

    Returns
    -------
    LevelSet
    """
    r = positive(radius, "radius")
    return LevelSet(f"sphere of radius {r:g}", partial(_in_sphere, r), _room(r))


def torus(radius: float = 1.0, tube: float = 0.4) -> LevelSet:
    """A torus around the z axis: the distance from its surface, positive inside.

    Parameters
    ----------
    radius : float
        Of the circle in the middle of the tube.
    tube : float
        The radius of the tube, less than the other.

    Returns
    -------
    LevelSet
    """
    r, t = positive(radius, "radius"), positive(tube, "tube")
    if t >= r:
        raise InputError(f"tube = {t:g} must be less than radius = {r:g}")
    box = _room(np.array([r + t, r + t, t]))
    return LevelSet(f"torus of radii {r:g} and {t:g}", partial(_in_torus, r, t), box)


def cube(half: float = 1.0) -> LevelSet:
    """The cube from -half to half along each axis: the distance from its surface, positive inside.

    Parameters
    ----------
    half : float

    Returns
    -------
    LevelSet
    """
    h = positive(half, "half")
    return LevelSet(f"cube of side {2 * h:g}", partial(_in_cube, h), _room(h))


def _notch(width: float, depth: float) -> tuple[float, float]:
    w, t = positive(width, "width"), positive(depth, "depth")
    if w >= 1.0 or t >= 2.0:
        raise InputError(f"width = {w:g} must be less than 1, and depth = {t:g} less than 2")
    return w, t


def notch(width: float = 0.4, depth: float = 1.0) -> LevelSet:
    """The cube from -1 to 1 with a notch in the shape of a V in its upper side, along the y axis.

    Parameters
    ----------
    width : float
        Half of that of the notch at the side z = 1; less than 1.
    depth : float
        How deep it is; less than 2.

    Returns
    -------
    LevelSet
        Its absolute value is at most the distance from the surface.
    """
    w, t = _notch(width, depth)
    steep = t / w
    length = float(np.sqrt(1.0 + steep * steep))
    function = partial(_in_notched_cube, steep, t, length)
    return LevelSet(f"cube with a notch of depth {t:g}", function, _room(1.0))


def notched_box(width: float = 0.4, depth: float = 1.0) -> Domain:
    """The body of `notch` as a domain with its edges; the markers are "notch" and the sides of a box.

    Parameters
    ----------
    width, depth : float
        As for `notch`.

    Returns
    -------
    Domain
    """
    w, t = _notch(width, depth)
    around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (w, 1.0), (0.0, 1.0 - t), (-w, 1.0), (-1.0, 1.0)]
    n = len(around)
    points = [(x, y, z) for y in (-1.0, 1.0) for x, z in around]
    facets = [list(range(n)), list(range(2 * n - 1, n - 1, -1))]
    facets += [[k, n + k, n + (k + 1) % n, (k + 1) % n] for k in range(n)]
    names = {"front": [0], "back": [1], "bottom": [2], "right": [3], "top": [4, 7], "left": [8]}
    return Domain(points, facets, markers=names | {"notch": [5, 6]})


def noise(seed: int = 0, *, waves: int = 24, shortest: float = 1.0) -> LevelSet:
    """A random smooth field: a sum of waves of equal heights in random directions.

    Parameters
    ----------
    seed : int
    waves : int
        How many.
    shortest : float
        The length of the shortest waves; the longest are four times as long.

    Returns
    -------
    LevelSet
        Its values have the mean 0 and the mean square 1, over all of space. Its surface is not closed: its
        box is a cube of two of the longest waves.
    """
    count, unit = as_count(waves, "waves"), positive(shortest, "shortest")
    if count == 0:
        raise InputError("waves must be at least 1")
    rng = np.random.default_rng(as_seed(seed))
    rows = []
    for a, b, c, phase in rng.random((count, 4)).tolist():
        z, length = 2.0 * a - 1.0, unit * 2.0 ** (2.0 * c)
        flat, turn = float(np.sqrt(1.0 - z * z)), 2.0 * np.pi * b
        scale = 2.0 * np.pi / length
        rows.append([scale * flat * cosine(turn), scale * flat * sine(turn), scale * z, 2.0 * np.pi * phase])
    height = float(np.sqrt(2.0 / count))
    change = height * sum(float(np.sqrt(p * p + q * q + r * r)) for p, q, r, _ in rows)
    function = partial(_in_waves, height, rows)
    box = frozen(np.array([[-4.0 * unit] * 3, [4.0 * unit] * 3]))
    return LevelSet(f"noise of {count} waves, seed {seed}", function, box, change)


def noisy_ball(seed: int = 0, *, height: float = 0.15, waves: int = 24, shortest: float = 0.5) -> LevelSet:
    """A ball of radius 1 whose surface is moved by a random smooth field: closed, with bumps and dents.

    Parameters
    ----------
    seed, waves, shortest
        As for `noise`.
    height : float
        By how much the surface is moved: the square root of the mean square; at least 0, less than 0.5.

    Returns
    -------
    LevelSet
        Moves are at most three times the height, and at most 0.9.
    """
    h = finite(height, "height")
    if not 0.0 <= h < 0.5:
        raise InputError(f"height = {h:g} must be at least 0 and less than 0.5")
    field = noise(seed, waves=waves, shortest=shortest)
    most = min(0.9, 3.0 * h)
    function = partial(_in_noisy_ball, h, field.function, most)
    return LevelSet(f"noisy ball, seed {seed}", function, _room(1.0 + most), 1.0 + h * field.change)


# ---------------------------------------------------------------------- merged bodies


def merged_body(seed: int = 0, *, parts: int = 5) -> LevelSet:
    """A union of balls, turned boxes and cylinders by seed: concave creases, edges and corners anywhere.

    Parameters
    ----------
    seed : int
    parts : int
        How many. The center of each lies in one of those before, so that the union is connected.

    Returns
    -------
    LevelSet
        Its absolute value is at most the distance from the surface outside, and less inside.
    """
    count = as_count(parts, "parts")
    if count == 0:
        raise InputError("parts must be at least 1")
    rng = np.random.default_rng(as_seed(seed))
    made: list[Callable[[Array], Array]] = []
    centers: list[Array] = []
    reach = 0.0
    for k in range(count):
        kind = int(rng.integers(3))
        around = centers[int(rng.integers(k))] if k else np.zeros(3)
        center = around + rng.uniform(-0.3, 0.3, 3) * bool(k)
        frame, half = _turned(rng), rng.uniform(0.35, 0.7, 3)
        made.append((_ball_at, _box_at, _cylinder_at)[kind](center, frame, half))
        centers.append(center)
        reach = max(reach, float(np.abs(center).max()) + float(_length(*half)))

    def function(x: Array) -> Array:
        total = made[0](x)
        for one in made[1:]:
            total = np.maximum(total, one(x))
        return total

    return LevelSet(f"merged body of {count} parts, seed {seed}", function, _room(reach))


def _turned(rng: np.random.Generator) -> Array:
    """Three directions at right angles, by a random quaternion."""
    q = rng.uniform(-1.0, 1.0, 4)
    a, b, c, d = (q / _length(*q)).tolist()
    return np.array([
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ])  # fmt: skip


def _along(x: Array, center: Array, frame: Array) -> list[Array]:
    """Coordinates of points in a frame."""
    away = x - center
    return [away[:, 0] * row[0] + away[:, 1] * row[1] + away[:, 2] * row[2] for row in frame]


def _ball_at(center: Array, frame: Array, half: Array) -> Callable[[Array], Array]:
    return lambda x: half[0] - _length(*_along(x, center, frame))


def _box_at(center: Array, frame: Array, half: Array) -> Callable[[Array], Array]:
    def function(x: Array) -> Array:
        away = [np.abs(u) - h for u, h in zip(_along(x, center, frame), half)]
        out = _length(*(np.maximum(u, 0.0) for u in away))
        return -out - np.minimum(np.maximum(np.maximum(away[0], away[1]), away[2]), 0.0)

    return function


def _cylinder_at(center: Array, frame: Array, half: Array) -> Callable[[Array], Array]:
    def function(x: Array) -> Array:
        u, v, w = _along(x, center, frame)
        away = [_length(u, v) - half[0], np.abs(w) - half[2]]
        out = _length(*(np.maximum(u, 0.0) for u in away))
        return -out - np.minimum(np.maximum(away[0], away[1]), 0.0)

    return function
