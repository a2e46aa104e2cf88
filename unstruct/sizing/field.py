"""A size field: the wanted edge length at every point, from a number, a function, or other fields.

Everywhere in the library a *size* is the wanted length of an edge. An equilateral triangle with edges of
length h has the circumradius h / sqrt(3), which is the chapter's f. See the book, chapter 2.3.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arguments import positive
from ..base.arrays import FLOAT64, all_positive, as_points
from ..base.asking import asked_at
from ..base.errors import InputError
from ..geometry.simplex import circumcenter, circumradius
from .table import SizeTable, build

__all__ = [
    "SizeField", "as_size", "clip", "control", "maximum", "minimum", "product",
]  # fmt: skip

Array = NDArray[np.float64]
ASKED_AT_ONCE = 1 << 18  # the largest number of points in one call of a user's function, to bound its memory


class SizeField:
    """A wanted edge length at every point.

    Parameters
    ----------
    function : callable
        Takes points of shape (k, d) and returns k positive, finite lengths.
    landmarks : array_like, shape (j, d), optional
        Places where the field has details that coarse sampling would miss, such as point sources; `table`
        evaluates the field there, too.
    name : str, optional
        The name that `repr` shows.
    growth : float, optional
        A bound on the change of the field per unit of length, if one is known for certain.

    Attributes
    ----------
    constant : float or None
        The value, if it is the same everywhere; otherwise None.
    growth : float or None
        A bound on the change per unit of length; None if none is known.
    most : float
        A number that no value exceeds; infinite if none is known.
    thorough : bool
        Whether finishing may take most of the time, for the sake of the least angle: True but for sizes that
        grow fast nearly everywhere.

    Notes
    -----
    Methods in the plane read a table of it (see `table`): a detail of the function that lies between all of
    its places is not seen, and ``complete`` then means that the table is kept to. Give such details as
    ``landmarks``; `too_large` asks the size itself again in a finished mesh. Methods in space do so
    themselves."""

    thorough = True
    most = np.inf

    def __init__(
        self,
        function: Callable[[Array], Any],
        *,
        landmarks: ArrayLike | None = None,
        name: str = "function",
        growth: float | None = None,
    ):
        if not callable(function):
            raise InputError(f"a size field needs a function of points, not {type(function).__name__}")
        self.function = function
        self.constant: float | None = None
        self.landmarks: Array = np.empty((0, 2)) if landmarks is None else as_points(landmarks, "landmarks")
        self.name = name
        self.growth = growth

    def __call__(self, x: ArrayLike) -> Array:
        """The wanted edge lengths at the points x, shape (k, d) -> (k,).

        Raises
        ------
        InputError
            If the function raises an error or returns anything but k positive, finite numbers; the message
            names the first point concerned.
        """
        points = as_points(x, "x")
        result = np.empty(len(points))
        for i in range(0, len(points), ASKED_AT_ONCE):
            result[i : i + ASKED_AT_ONCE] = self._values(points[i : i + ASKED_AT_ONCE], i)
        return result

    def below(self, x: Array, bound: Array) -> Array:
        """The smaller of the size and a bound at each of the points x (k, d); some fields are quicker so."""
        return np.minimum(self(x), bound)

    def _values(self, points: Array, first: int) -> Array:
        """The function at some points; ``points[0]`` is row ``first`` of the array that the caller gave."""
        if self.constant is not None:
            return np.full(len(points), self.constant)
        values = asked_at(
            lambda x: np.asanyarray(self.function(x)), points, "the size function",
            "points (k, d) and returns k lengths", first=first,
        )  # fmt: skip
        if _are_plain(values, len(points)) and all_positive(values):
            return values
        if values.shape != (len(points),):
            raise InputError(
                f"the size function must return shape ({len(points)},) for {len(points)} points, not "
                f"{values.shape}; give a constant size as a plain number"
            )
        if values.dtype.kind not in "fiu" or np.ma.isMaskedArray(values):
            raise InputError(
                f"the size function must return plain real numbers, not {type(values)} of {values.dtype}"
            )
        bad = ~(np.isfinite(values) & (values > 0))
        if bad.any():
            row = int(np.argmax(bad))
            raise InputError(
                f"size must be positive and finite: it is {float(values[row])!r} at "
                f"x[{first + row}] = {points[row].tolist()}; clip or correct the size function"
            )
        return values.astype(np.float64)

    def table(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        factor: float = 1.0,
        tolerance: float = 0.02,
        max_depth: int = 24,
        max_nodes: int = 1_000_000,
    ) -> SizeTable:
        """The field over a box of the plane, as arrays that kernels read; see `SizeTable`.

        Parameters
        ----------
        lower, upper : array_like, shape (2,)
            Opposite corners of the box.
        factor : float
            Coordinates and sizes of the table are multiplied by it.
        tolerance : float
            A leaf is divided while the relative error of its bilinear interpolant exceeds this at one of nine
            points, or at a landmark.
        max_depth, max_nodes : int
            Limits beyond which no leaf is divided; `error` and `capped` of the result report their effect.

        Returns
        -------
        SizeTable

        Raises
        ------
        InputError
            For an empty or infinite box, or sizes that are not positive or leave the range of doubles.
        """
        return build(
            self,
            lower,
            upper,
            landmarks=self.landmarks,
            factor=factor,
            tolerance=tolerance,
            max_depth=max_depth,
            max_nodes=max_nodes,
        )

    def __repr__(self) -> str:
        if self.constant is not None:
            return f"<SizeField: constant {self.constant:g}>"
        return f"<SizeField: {self.name}>"


def _are_plain(values: Any, many: int) -> bool:
    """Whether these are so many doubles in an array as kernels take it."""
    return (
        type(values) is np.ndarray
        and values.dtype is FLOAT64
        and values.shape == (many,)
        and values.flags.carray
    )


def as_size(size: Any) -> SizeField:
    """Make a size field from any of the forms in which a size can be given.

    Parameters
    ----------
    size : float, callable, or SizeField
        A length; a function of points (k, d) that returns k lengths; or a field, which is returned as it is.

    Returns
    -------
    SizeField

    Raises
    ------
    InputError
        For a number that is zero, negative, NaN or infinite, and for anything else that is not a size. The
        values of a function are checked only when it is called; the error then names the point.
    """
    if isinstance(size, SizeField):
        return size
    if callable(size):
        return SizeField(size, name=getattr(size, "__name__", "function"))
    array = np.asarray(size) if not isinstance(size, str) else np.empty(0, dtype=object)
    if array.ndim != 0 or array.dtype.kind not in "fiu":
        raise InputError(f"size must be a number, a function of points or a SizeField, not {size!r:.60}")
    value = float(array)
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"size must be positive and finite, not {value!r}")
    field = SizeField(partial(_everywhere, value), growth=0.0)
    field.constant = field.most = value
    return field


def _everywhere(value: float, x: Array) -> Array:
    return np.full(len(x), value)


# Fields use functions of the module and `partial` instead of lambdas, so that they can be pickled.
def _combine(operation: Callable[..., Any], fields: list[SizeField], x: Array) -> Array:
    return operation([field(x) for field in fields])


def _clipped(lower: float, upper: float, rows: Any) -> Array:
    return np.clip(rows[0], lower, upper)


def _combined(name: str, operation: Callable[..., Any], sizes: tuple[Any, ...]) -> SizeField:
    if not sizes:
        raise InputError(f"{name} needs at least one size")
    fields = [as_size(size) for size in sizes]
    constants = [field.constant for field in fields if field.constant is not None]
    if len(constants) == len(fields):
        return as_size(float(operation(constants)))
    marks = [field.landmarks for field in fields if len(field.landmarks)]
    growths = [field.growth for field in fields if field.growth is not None]
    known = len(growths) == len(fields) and name != "product"
    return SizeField(
        partial(_combine, operation, fields),
        landmarks=np.concatenate(marks) if marks else None,
        name=f"{name} of {len(fields)}",
        growth=max(growths) if known else None,
    )


def minimum(*sizes: Any) -> SizeField:
    """The smallest of several sizes at each point, which is as fine as each of them requires.

    Parameters
    ----------
    *sizes : float, callable, or SizeField

    Returns
    -------
    SizeField
    """
    return _combined("minimum", partial(np.min, axis=0), sizes)


def maximum(*sizes: Any) -> SizeField:
    """The largest of several sizes at each point.

    Parameters
    ----------
    *sizes : float, callable, or SizeField

    Returns
    -------
    SizeField
    """
    return _combined("maximum", partial(np.max, axis=0), sizes)


def product(*sizes: Any) -> SizeField:
    """The product of sizes and factors at each point: ``product(0.5, size)`` is twice as fine.

    Parameters
    ----------
    *sizes : float, callable, or SizeField

    Returns
    -------
    SizeField
    """
    return _combined("product", partial(np.prod, axis=0), sizes)


def clip(size: Any, lower: float, upper: float) -> SizeField:
    """A size clipped to two bounds.

    Parameters
    ----------
    size : float, callable, or SizeField
    lower, upper : float
        Positive, ``lower <= upper``.

    Returns
    -------
    SizeField

    Raises
    ------
    InputError
        For bounds that are not positive, or not in order.
    """
    lower, upper = positive(lower, "lower"), positive(upper, "upper")
    if lower > upper:
        raise InputError(f"clip needs lower <= upper, not {lower!r} > {upper!r}")
    return _combined("clip", partial(_clipped, lower, upper), (size,))


def control(mesh: Any, size: Any) -> Array:
    """The chapter's control quantity: the circumradius of each triangle over that wanted at its circumcenter.

    Parameters
    ----------
    mesh : Mesh
        A mesh of triangles in the plane.
    size : float, callable, or SizeField
        The wanted edge length h. The chapter's f is a circumradius: f = h / sqrt(3).

    Returns
    -------
    ndarray, shape (m,)
        alpha: the circumradius of each triangle over f at its circumcenter. The circumcenter may lie outside
        the triangle and outside the region; the size is evaluated there nevertheless. Flat triangles have no
        circumcenter, and alpha is infinite.

    Notes
    -----
    Source: the chapter's generalized choice of the insertion triangle. See the book, chapters 2.3 and 2.6b.
    """

    corners = mesh.corners
    if corners.shape[1:] != (3, 2):
        raise InputError(f"control needs triangles in the plane, not cells of shape {corners.shape[1:]}")
    alpha = np.full(len(corners), np.inf)
    radius, centers = circumradius(corners), circumcenter(corners)
    solid = np.isfinite(radius) & np.isfinite(centers).all(axis=1)
    alpha[solid] = radius[solid] * np.sqrt(3.0) / as_size(size)(centers[solid])
    return alpha
