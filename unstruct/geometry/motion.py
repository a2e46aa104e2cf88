"""Motions of the plane or of space: translations, rotations about a point, other affine maps.

One function moves points, so that the same point gives the same image, bit for bit, wherever it is moved.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.elementary import cosine, sine

__all__ = ["Motion"]

Row = tuple[float, ...]


class Motion(NamedTuple):
    """The map of x to ``matrix (x - center) + (center + shift)``.

    Attributes
    ----------
    matrix : tuple of d rows of d floats
    shift, center : tuple of d floats

    Notes
    -----
    A translation has the identity as its matrix and the center 0; then the image is x plus the shift, rounded
    once. The images by other maps are rounded several times: they are equal to the true ones only up to
    rounding, but the center of a rotation is its own image exactly.
    """

    matrix: tuple[Row, ...]
    shift: Row
    center: Row

    @classmethod
    def translation(cls, shift: ArrayLike) -> Self:
        """The translation by a vector."""
        d = len(np.asarray(shift))
        rows = np.eye(d).tolist()
        return cls(tuple(map(tuple, rows)), tuple(np.asarray(shift, dtype=float).tolist()), (0.0,) * d)

    @classmethod
    def rotation(cls, degrees: float, center: ArrayLike = (0.0, 0.0)) -> Self:
        """The rotation of the plane about a point, counterclockwise; exact for multiples of 90 degrees."""
        quarter = round(degrees / 90.0)
        rest = math.radians(degrees - 90.0 * quarter)
        c, s = float(cosine(rest)), float(sine(rest))
        for _ in range(quarter % 4):
            c, s = -s, c
        c, s = c + 0.0, s + 0.0  # no negative zeros
        return cls(((c, 0.0 - s), (s, c)), (0.0, 0.0), tuple(np.asarray(center, dtype=float).tolist()))

    @classmethod
    def of_affine(cls, values: ArrayLike, d: int) -> Self:
        """The map of a matrix of 16 entries by rows, as Gmsh's files have it, in d dimensions."""
        table = np.asarray(values, dtype=np.float64).reshape(4, 4)
        return cls(tuple(map(tuple, table[:d, :d].tolist())), tuple(table[:d, 3].tolist()), (0.0,) * d)

    def affine(self) -> NDArray[np.float64]:
        """The matrix (4, 4) that `of_affine` takes; a center other than 0 is rounded into its last column."""
        d = len(self.shift)
        table = np.eye(4)
        table[:d, :d] = self.matrix
        center = np.array(self.center)
        table[:d, 3] = np.array(self.shift)
        if center.any():
            table[:d, 3] += center - np.array(self.matrix) @ center
        return table

    def __call__(self, x: Any) -> NDArray[np.float64]:
        """The images of points, shape (..., d), always by the same operations in the same order."""
        away = np.asarray(x, dtype=np.float64) - self.center
        columns = []
        for row, center, shift in zip(self.matrix, self.center, self.shift):
            column = row[0] * away[..., 0]
            for j in range(1, len(row)):
                column = column + row[j] * away[..., j]
            columns.append(column + (center + shift))
        return np.stack(columns, axis=-1)

    def __str__(self) -> str:
        (a, *_), *_ = self.matrix
        if np.array_equal(self.matrix, np.eye(len(self.shift))):
            return f"moved by ({', '.join(f'{x:.6g}' for x in self.shift)})"
        if len(self.shift) == 2 and not any(self.shift):
            angle = math.degrees(math.atan2(self.matrix[1][0], a))
            return f"turned by {angle:.6g}° about ({', '.join(f'{x:.6g}' for x in self.center)})"
        return "moved by an affine map"
