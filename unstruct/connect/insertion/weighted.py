"""Regular (weighted Delaunay) triangulations: the duals of power diagrams. See the book, 2.1."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import counted_off
from ...base.progress import progress_bar
from ...geometry.ordering import brio
from ...mesh.mesh import Mesh
from ...predicates.power import power_factor
from .copies import distinct_points
from .engine import Compiled
from .first import first_simplex, not_spanning
from .weighted_general import WeightedGeneral
from .weighted_plane import WeightedPlanar
from .weighted_space import WeightedSpatial

__all__ = ["regular_triangulation"]

WEIGHTED: dict[int, type[Compiled]] = {2: WeightedPlanar, 3: WeightedSpatial}


def regular_triangulation(
    rows: NDArray[np.float64], weights: NDArray[np.float64], *, progress: bool = False
) -> Mesh:
    """The regular triangulation of weighted points; see `delaunay`.

    Parameters
    ----------
    rows : (n, d) array
        At least d + 1 finite points.
    weights : (n,) array
    progress : bool

    Returns
    -------
    Mesh
        With ``weights``, ``hidden`` and ``duplicates``.

    Raises
    ------
    DegenerateInputError
        For points that do not span the space.
    """
    n, d = rows.shape
    kept, duplicates = distinct_points(rows, weights)
    order = kept[brio(rows[kept])]
    factor = power_factor(rows, weights)
    lifted = np.column_stack([rows[order], weights[order]])
    inserted, exact = _scaled(lifted, factor)
    exact = exact and d in WEIGHTED
    if not exact:
        inserted = lifted
    first = first_simplex(np.ascontiguousarray(inserted[:, :-1]), compiled=exact)
    if len(first) <= d:
        raise not_spanning(rows, len(first) - 1)
    front = np.concatenate([first, np.delete(np.arange(len(order)), first)])
    order, inserted = order[front], inserted[front]
    kind: Any = WEIGHTED[d] if exact else WeightedGeneral
    engine = kind(inserted[: d + 1])
    engine.add(inserted[d + 1 :])
    with progress_bar(progress, " points", total=engine.size, initial=engine.done) as bar:
        while engine.done < engine.size:
            before = engine.done
            engine.advance()
            bar.update(engine.done - before)
    simplices, neighbors, _ = engine.cells(order.astype(np.int32))
    shown = np.zeros(n, dtype=bool)
    shown[simplices] = True
    shown[duplicates[:, 0]] = True
    return Mesh(
        rows,
        simplices,
        neighbors=neighbors,
        origin=counted_off(n),
        duplicates=duplicates,
        weights=weights,
        hidden=np.flatnonzero(~shown).astype(np.int32),
    )


def _scaled(lifted: NDArray[np.float64], factor: float) -> tuple[NDArray[np.float64], bool]:
    """Coordinates times the factor and weights times its square; and whether both are exact."""
    with np.errstate(over="ignore", under="ignore"):
        result = lifted * factor
        result[:, -1] *= factor
        back = result / factor
        back[:, -1] /= factor
    return result, bool(np.array_equal(back, lifted))
