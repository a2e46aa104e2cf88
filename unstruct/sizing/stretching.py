"""How the heights of layers at a wall grow: geometric, exponential, hyperbolic tangent, or any function.

Nothing here depends on a dimension: the layers of fronts and of prisms are given by the same class.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import as_points
from ..base.asking import asked_at
from ..base.elementary import exponentials
from ..base.errors import InputError
from .layer_functions import asked_for_shares

__all__ = ["DEFAULT_GROWTH", "Layers"]

Array = NDArray[np.float64]
DEFAULT_GROWTH = 1.2  # where two values are given that leave the growth open
MOST_LAYERS = 10_000
SAME_THICKNESS = 1e-6  # relative: four values that agree so well are consistent
HALVINGS_OF_BRACKETS = 64
STEEPEST = 300.0  # the largest stretching parameter of the hyperbolic tangent that is tried
LAYER_VALUES = ("first", "growth", "count", "thickness")
STRETCHINGS = ("geometric", "exponential", "tanh")


class Stretching(NamedTuple):
    """Values that fit each other; arrays of one row for each place, or of one row for all of them."""

    first: Array
    growth: Array
    number: int | None  # of layers
    thickness: Array | None


class Layers:
    """The heights of layers of cells along a wall.

    Parameters
    ----------
    first : float, (r,) array_like, or function (r, d) -> (r,), optional
        The height of the first layer: one for all, one for each vertex of the wall, or by the place.
    growth : float, array_like or function, optional
        The quotient of the second height and the first; in a geometric sequence, of each and the one before.
    count : int, optional
        The number of layers.
    thickness : float, array_like or function, optional
        Their total height.
    function : "geometric", "exponential", "tanh", or a function, optional
        "geometric": the heights are a geometric sequence. "exponential": the total height after k of n layers
        is proportional to exp(b k / n) - 1. This is the same sequence, with growth exp(b / n). "tanh":
        proportional to 1 + tanh(b (k / n - 1)) / tanh(b), which grows fast at the wall and ends in layers of
        nearly equal heights. A function takes shares k / n from 0 to 1, as an array, and returns increasing
        values: the total height is proportional to them, less the first; give count, and thickness or first.

    Attributes
    ----------
    first, growth, count, thickness
        As given, or as they follow from the others; None where they are open, or not known before there are
        places.

    Raises
    ------
    InputError
        For values that are not positive and finite (growth may be below 1), that contradict each other or are
        too few; the message says which, and names a value that fits.

    Notes
    -----
    Any two or three that fit each other are enough. Where first, growth and thickness are given, or two of
    them without a growth (1.2 is taken then), the number of layers is rounded and the growth adapted, so that
    first and thickness are met. A geometric sequence given by first and growth alone has no end: what makes
    the layers decides where it stops. All four must fit each other to six digits.
    """

    def __init__(
        self,
        first: Any = None,
        growth: Any = None,
        count: int | None = None,
        thickness: Any = None,
        *,
        function: str | Callable[[Array], ArrayLike] = "geometric",
    ):
        if not (callable(function) or (isinstance(function, str) and function in STRETCHINGS)):
            raise InputError(
                f"function must be one of {', '.join(map(repr, STRETCHINGS))}, or a function of shares, not "
                f"{function!r}"
            )
        if count is not None:
            whole = isinstance(count, int | np.integer) and not isinstance(count, bool)
            if not whole or not 1 <= int(count) <= MOST_LAYERS:
                raise InputError(f"count = {count!r} must be a whole number of layers, 1 to {MOST_LAYERS}")
        self.function = function
        self.given = {
            name: value if name == "count" or callable(value) else _values(value, name)
            for name, value in zip(LAYER_VALUES, (first, growth, count, thickness))
            if value is not None
        }
        _enough(set(self.given), function)
        found = self._found = None if self.varies else _resolved(self.given, function)
        self.count: int | None = count if found is None else found.number
        self.first, self.growth = _shown(first, found and found.first), _shown(growth, found and found.growth)
        self.thickness = _shown(thickness, found and found.thickness)

    @cached_property
    def varies(self) -> bool:
        """Whether a value is a function of the place."""
        return any(callable(value) for value in self.given.values())

    def cumulative(self, count: int | None = None, *, at: Any = None) -> Array:
        """The total heights after 0, 1, ... layers.

        Parameters
        ----------
        count : int, optional
            How many layers; all by default. More than all are continued by the last height; a sequence
            without an end needs a number.
        at : array_like, shape (r, d), optional
            Places on the wall; needed if values are functions of the place.

        Returns
        -------
        ndarray, shape (count + 1,), or (r, count + 1) with places or values for each vertex
        """
        found = self._at(at)
        if found.number is None and count is None:
            raise InputError(
                "these layers have no end: say how many heights are wanted, cumulative(count=40)"
            )
        rows = len(np.broadcast_arrays(found.first, found.growth)[0])
        total = (found.number or 0) if found.number or count is None else count
        heights = np.zeros((rows, total + 1))
        heights[:] = found.first[:, None] * _units(total, found.growth, self.function)
        if found.thickness is not None:
            heights[:, -1] = found.thickness
        if count is not None and total != count:
            last = heights[:, -1:] - heights[:, -2:-1]
            more = heights[:, -1:] + last * np.arange(1, max(count - total, 0) + 1)
            heights = np.concatenate([heights, more], axis=1)[:, : count + 1]
        return heights if at is not None or rows > 1 else heights[0]

    def heights(self, count: int | None = None, *, at: Any = None) -> Array:
        """The height of each layer, as `cumulative` gives their sums: shape (count,) or (r, count)."""
        return np.diff(self.cumulative(count, at=at))

    def _at(self, at: Any) -> Stretching:
        if at is None and self.varies:
            raise InputError("these layers depend on the place: give places, cumulative(at=points)")
        if self._found is not None and at is None:
            return self._found
        given = dict(self.given)
        if at is not None:
            places = as_points(at, "at")
            for name, value in given.items():
                if callable(value):
                    takes = "places (k, d) and returns k positive numbers"
                    asked = asked_at(value, places, f"the function for {name}", takes, name="places")
                    given[name] = _values(asked, f"{name}(places)")
                if name != "count" and np.size(given[name]) not in (1, len(places)):
                    raise InputError(
                        f"{name} has {np.size(given[name])} values, but there are {len(places)} places; give "
                        "one value, one for each place, or a function of the place"
                    )
                if name != "count":
                    given[name] = np.broadcast_to(given[name], len(places))
        return _resolved(given, self.function)

    def __repr__(self) -> str:
        parts = [f"{k}={v if np.ndim(v) == 0 else '...'}" for k, v in self._known() if v is not None]
        return f"<Layers: {', '.join(parts)}, {self.function}>"

    def _known(self) -> list[tuple[str, Any]]:
        values = [(name, getattr(self, name)) for name in LAYER_VALUES]
        return [(n, "function" if callable(v) else float(f"{v:.6g}") if np.ndim(v) == 0 and v else v)
                for n, v in values]  # fmt: skip


def _values(value: Any, name: str) -> Array:
    """A positive number or one for each place, as an array of one or more rows."""
    if type(value) is float and 0.0 < value < np.inf:
        return np.array([value])
    try:
        if isinstance(value, str | bytes | bool):
            raise TypeError
        array = np.atleast_1d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, numbers, or a function, not {value!r:.60}") from None
    if array.ndim != 1 or len(array) == 0:
        raise InputError(f"{name} must be one number or one for each vertex, not shape {np.shape(value)}")
    bad = ~(np.isfinite(array) & (array > 0))
    if bad.any():
        row = int(np.argmax(bad))
        where = f"[{row}]" if np.ndim(value) else ""
        raise InputError(f"{name}{where} = {array[row]} must be positive and finite")
    return array


def _shown(given: Any, found: Array | None) -> Any:
    """A value as given, or as it follows: a number if it is the same everywhere."""
    if callable(given) or found is None:
        return given
    return float(found[0]) if len(found) == 1 else found


def _enough(names: set[str], function: Any) -> None:
    """Raise if the values do not determine the layers."""
    if callable(function):
        if "count" not in names or not names & {"thickness", "first"} or "growth" in names:
            raise InputError(
                "layers by a function of shares take count, and thickness or first (no growth): for instance "
                f"count=20, thickness=0.1; given are {sorted(names) or 'none'}"
            )
        return
    scale, several = names & {"first", "thickness"}, len(names) > 1
    if scale and several and not names == {"growth", "thickness"}:
        if function == "tanh" and names == {"first", "growth"}:
            raise InputError(
                "function='tanh' ends at a thickness: with first and growth give also count (20, for "
                "instance) or thickness"
            )
        return
    missing = "first or thickness (0.001, for instance)" if not scale else "growth (1.2, for instance)"
    if names == {"growth", "thickness"}:
        missing = "first or count (20, for instance)"
    raise InputError(f"{sorted(names) or 'no values'} do not determine the layers: give also {missing}")


def _resolved(given: dict[str, Any], function: Any) -> Stretching:
    """All four values by those that are given; each an array of the same number of rows."""
    arrays = {name: value for name, value in given.items() if name != "count"}
    rows = max(len(value) for value in arrays.values())
    for name, value in arrays.items():
        if len(value) not in (1, rows):
            raise InputError(f"{name} has {len(value)} values, and another value {rows}: give equally many")
        arrays[name] = value.copy() if len(value) == rows else np.broadcast_to(value, rows).astype(np.float64)
    n: Any = given.get("count")
    first: Any = arrays.get("first")
    thickness: Any = arrays.get("thickness")
    growth = arrays.get("growth")
    if callable(function):
        units = _units(n, np.ones(rows), function)[:, -1]
        first = thickness / units if first is None else first
        _agree(first, thickness, first * units, "count")
        return Stretching(first, np.ones(rows), n, first * units)
    if first is None or thickness is None or (growth is not None and n is not None):
        growth = np.full(rows, DEFAULT_GROWTH) if growth is None else growth
        _possible(growth, n, function)
        if n is None:
            return Stretching(first, growth, None, None)
        units = _units(n, growth, function)[:, -1]
        first = thickness / units if first is None else first
        _agree(first, thickness, first * units, "growth and count")
        return Stretching(first, growth, n, first * units)
    if n is None:
        n = _number(thickness / first, np.full(rows, DEFAULT_GROWTH) if growth is None else growth, function)
    return Stretching(first, _growth(first, thickness, n, function), n, thickness)


def _agree(first: Array, thickness: Array | None, found: Array, others: str) -> None:
    if thickness is not None and (np.abs(thickness - found) > SAME_THICKNESS * found).any():
        row = int(np.argmax(np.abs(thickness - found)))
        raise InputError(
            f"thickness = {thickness[row]:.6g} contradicts first = {first[row]:.6g} with {others}, which "
            f"give thickness = {found[row]:.6g}: give that, or leave out one of them"
        )


def _possible(growth: Array, n: int | None, function: Any) -> None:
    if function == "tanh" and n is not None and n > 1 and (growth <= 1.0).any():
        low = float(growth.min())
        raise InputError(f"growth = {low:.6g} must be above 1 for function='tanh': 1.2, for instance")


# ---------------------------------------------------------------------- sequences


def _units(n: int, growth: Array, function: Any) -> Array:
    """Total heights after 0 to n layers in units of the first height: (rows, n + 1)."""
    if callable(function):
        shares = asked_for_shares(function, n)
        return np.broadcast_to((shares - shares[0]) / (shares[1] - shares[0]), (len(growth), n + 1))
    if function == "tanh":
        return _tanh_units(n, _steepness(n, growth)) if n > 1 else np.tile([0.0, 1.0], (len(growth), 1))
    return _sums(n, growth)


def _sums(n: int, growth: Array) -> Array:
    """1 + g + ... + g^(k - 1) for k from 0 to n, (rows, n + 1): products alone, the same on every machine."""
    steps = np.ones((len(growth), n + 1))
    steps[:, 0] = 0.0
    steps[:, 2:] = growth[:, None]
    with np.errstate(over="ignore"):
        steps[:, 1:] = np.cumprod(steps[:, 1:], axis=1)
        return np.cumsum(steps, axis=1)


def _below_one(x: Array) -> Array:
    """1 - e^(-x) for x >= 0, without loss of digits where x is small."""
    series = np.ones_like(x)
    small = np.minimum(x, 0.1)
    for k in range(12, 1, -1):
        series = 1.0 - small / k * series
    return np.where(x < 0.1, small * series, 1.0 - exponentials(-np.maximum(x, 0.1)))


def _tanh_units(n: int, b: Array) -> Array:
    """The hyperbolic tangent's sequence, by sinh(b k / n) / cosh(b (k / n - 1)), which loses no digits."""
    s = np.arange(n + 1) / n
    b = b[:, None]
    # 1 + tanh(b (s - 1)) / tanh(b) = sinh(b s) / (sinh(b) cosh(b (s - 1))), with factors e^b taken out.
    rest = exponentials(-2 * b * (1.0 - s))
    total = _below_one(2 * b * s) / (1.0 + rest) * rest
    return total / total[:, 1:2]


def _bisected(low: Array, high: Array, below: Callable[[Array], NDArray[np.bool_]]) -> Array:
    """Where ``below`` turns from true to false between two bounds."""
    for _ in range(HALVINGS_OF_BRACKETS):
        middle = (low + high) / 2
        less = below(middle)
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    return (low + high) / 2


def _steepness(n: int, growth: Array) -> Array:
    """The parameter of the hyperbolic tangent whose second step is ``growth`` times the first."""
    return _bisected(
        np.full(len(growth), 1e-9),
        np.full(len(growth), STEEPEST),
        lambda b: _tanh_units(n, b)[:, 2] - 1.0 < growth,
    )


def _number(ratio: Array, growth: Array, function: Any) -> int:
    """How many layers with this growth come nearest to ``ratio`` first heights; the most of all rows."""
    if (ratio < 1.0 - SAME_THICKNESS).any():
        raise InputError(
            f"thickness must not be below first, but it is {float(ratio.min()):.3g} times first: give at "
            "least first"
        )
    if function == "tanh":
        if (ratio < 1.0 + SAME_THICKNESS).all():
            return 1
        low, high = 1, MOST_LAYERS  # more layers reach higher
        while high - low > 1:
            n = (low + high) // 2
            reaches = _units(n, np.maximum(growth, 1 + 1e-9), function)[:, -1] >= ratio
            low, high = (low, n) if reaches.all() else (n, high)
        return max(min(high, int(ratio.min() + SAME_THICKNESS)), 1)
    even = np.abs(growth - 1.0) < 1e-12
    with np.errstate(divide="ignore", invalid="ignore"):
        number = np.where(even, ratio, np.log1p(ratio * (growth - 1.0)) / np.log(growth))
    if not np.isfinite(number).all():
        row = int(np.argmin(np.isfinite(number)))
        raise InputError(
            f"heights that shrink by growth = {growth[row]:.6g} never reach {ratio[row]:.6g} times the "
            f"first: a growth above {1.0 - 1.0 / ratio[row]:.6g} does"
        )
    most = float(number.max())
    if most > MOST_LAYERS:
        raise InputError(f"these values ask for {most:.3g} layers; {MOST_LAYERS} are the most: raise growth")
    many = max(round(most), 1)
    return many if many > 1 or (ratio < 1.0 + SAME_THICKNESS).all() else 2


def _growth(first: Array, thickness: Array, n: int, function: Any) -> Array:
    """The growth with which n layers from ``first`` on have this thickness."""
    ratio = thickness / first
    if n == 1:
        _agree(first, thickness, first, "count = 1")
        return np.ones(len(first))
    least = float(n) if function == "tanh" else 1.0
    if (ratio <= least * (1.0 + 1e-12) - (least > 1) * 1e-9).any():
        row = int(np.argmin(ratio))
        fits = first[row] * float(_sums(n, np.array([DEFAULT_GROWTH]))[0, -1])
        raise InputError(
            f"thickness = {thickness[row]:.6g} is too small for {n} layers from first = {first[row]:.6g} on"
            f"{' by the hyperbolic tangent' if function == 'tanh' else ''}: it must exceed "
            f"{least * first[row]:.6g}; growth {DEFAULT_GROWTH} gives {fits:.6g}"
        )
    if function == "tanh":
        b = _bisected(
            np.full(len(first), 1e-9),
            np.full(len(first), STEEPEST),
            lambda b: _tanh_units(n, b)[:, -1] < ratio,
        )
        return _tanh_units(n, b)[:, 2] - 1.0
    # The last of n terms alone is at most the sum, and so is the mean of all.
    high = np.maximum(ratio ** (1.0 / (n - 1)), 1.0) * (1.0 + 1e-12)
    return _bisected(np.zeros(len(first)) + 1e-300, high, lambda g: _sums(n, g)[:, -1] < ratio)
