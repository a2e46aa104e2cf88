"""Which pieces of a domain must get no further vertices."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError

__all__ = ["SplitBoundary", "check_split_boundary", "kept_pieces"]

SplitBoundary = bool | Literal["inner"]


def check_split_boundary(split_boundary: SplitBoundary) -> None:
    """Raise an error unless this is True, False or "inner"."""
    named = isinstance(split_boundary, str) and split_boundary == "inner"
    if not (named or isinstance(split_boundary, bool | np.bool_)):
        raise InputError(f"split_boundary must be True, False or 'inner', not {split_boundary!r}")


def kept_pieces(
    split_boundary: SplitBoundary, facets: int, pieces: int, held: NDArray[np.bool_] | None = None
) -> NDArray[np.uint8]:
    """For each piece, facets first, whether it must stay as it is: 1 or 0.

    Parameters
    ----------
    split_boundary : bool or "inner"
        Whether all pieces may be split, or none, or only the inner ones.
    facets, pieces : int
        The number of facets, and that of all pieces.
    held : ndarray of bool, shape (pieces,), optional
        Pieces that must stay as they are in any case: those with a spacing or an image.

    Raises
    ------
    InputError
        For another choice.
    """
    check_split_boundary(split_boundary)
    kept = np.zeros(pieces, dtype=np.uint8)
    if split_boundary == "inner":
        kept[:facets] = 1
    elif not split_boundary:
        kept[:] = 1
    if held is not None:
        kept[held] = 1
    return kept
