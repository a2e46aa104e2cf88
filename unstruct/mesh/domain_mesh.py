"""DomainMesh: the mesh of a domain, with a record of what was reached and what was not."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, Self, TypedDict, TypeVar, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import frozen
from ..base.errors import IncompleteWarning, InputError
from ..base.options import named
from .complex import NO_PAIRS, checked_markers, checked_regions
from .mesh import Mesh

__all__ = ["DomainMesh", "noticed"]

NO_FACES = frozen(np.empty((0, 3), dtype=np.int32))
NO_CELLS, NO_REASONS = frozen(np.empty(0, dtype=np.int32)), frozen(np.full(0, ""))


class MeshOptions(TypedDict, total=False):
    """The arguments of a `Mesh` after its points and simplices."""

    neighbors: Any
    origin: Any
    duplicates: Any
    markers: Mapping[str, Any] | None
    cells: Mapping[str, Any] | None
    weights: Any
    hidden: Any
    regions: Mapping[str, int] | None
    periodic: Iterable[Any] | None


class DomainMesh(Mesh):
    """A mesh of a domain, as the meshing methods return it.

    Parameters
    ----------
    points, simplices : array_like
        As for `Mesh`, and so are neighbors, origin, duplicates, markers, cells, weights, hidden, regions,
        periodic.
    unrefined : array_like of int, shape (k,), optional
        Cells that do not satisfy what was asked for.
    reasons : array_like of str, shape (k,), optional
        The reason for each of them.
    counts : dict of str to int, optional
        Counters of the run, by name: insertions, splits, exceptional cases.
    steps : dict of str to array, optional
        The record of the run, if it was asked for; the method describes its arrays.
    figures : dict of str to float, optional
        Values measured during the run, by name, such as the quality before the last step.
    segments : array_like of int, shape (s, 2), optional
        All subsegments of the domain's pieces that are in the mesh, in the direction of their piece.
    piece : array_like of int, shape (s,), optional
        The piece of the domain (facets first, then inner segments) that each is a part of.
    span : array_like, shape (s, 2), optional
        The parameters of its ends on that piece, between 0 and 1.
    faces : array_like of int, shape (f, 3) or (f, 4), optional
        In space: all faces of cells that lie on facets and inner facets of the domain; in rows of four,
        triangles end with -1. The subsegments are then those of inner segments.
    face_piece : array_like of int, shape (f,), optional
        The piece of the domain that each is a part of.

    Attributes
    ----------
    complete : bool
        Whether everything that was asked for was reached: ``unrefined`` is then empty, and there are cells,
        since no method takes a domain in which nothing is inside.
    left_out : ndarray of int32, shape (k,)
        The rows of points given besides the domain that are outside of it, and not in the mesh.
    """

    @named(MeshOptions)
    def __init__(
        self,
        points: Any,
        simplices: Any,
        *,
        unrefined: ArrayLike | None = None,
        reasons: ArrayLike | None = None,
        counts: Mapping[str, int] | None = None,
        figures: Mapping[str, float] | None = None,
        steps: Mapping[str, NDArray] | None = None,
        segments: ArrayLike | None = None,
        piece: ArrayLike | None = None,
        span: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        face_piece: ArrayLike | None = None,
        **rest: Unpack[MeshOptions],
    ):
        super().__init__(points, simplices, **rest)
        self._take_account(unrefined, reasons, counts, figures, steps)
        self.segments: np.ndarray = _pairs(() if segments is None else segments, np.int32)
        self.piece: np.ndarray = NO_CELLS if piece is None else frozen(np.asarray(piece, np.int32))
        self.span: np.ndarray = _pairs(() if span is None else span, np.float64)
        if not len(self.segments) == len(self.piece) == len(self.span):
            raise InputError("segments, piece and span must have one row per subsegment")
        self.faces: np.ndarray = NO_FACES
        self.face_piece: np.ndarray = NO_CELLS
        if faces is not None:
            rows = np.asarray(faces, np.int32)
            self.faces = frozen(rows if rows.ndim == 2 and rows.shape[1] == 4 else rows.reshape(-1, 3))
            self.face_piece = frozen(np.asarray(() if face_piece is None else face_piece, np.int32))
        if len(self.faces) != len(self.face_piece):
            raise InputError("face_piece must have one entry per face")

    @property
    def complete(self) -> bool:
        """Whether everything that was asked for was reached."""
        return self.size > 0 and len(self.unrefined) == 0

    @property
    def steiner(self) -> NDArray[np.int32]:
        """Vertices on pieces of the domain that it did not have, since there is no mesh without them: (k,).

        In the plane, vertices that were added on pieces for any reason.
        """
        used = np.zeros(len(self.points), dtype=bool)
        used[self.faces[self.faces >= 0]], used[self.segments.ravel()] = True, True
        return frozen(np.flatnonzero(used & (np.asarray(self.origin) < 0)).astype(np.int32))

    @classmethod
    def of_triangles(
        cls,
        points: NDArray[np.float64],
        origin: NDArray[np.int32],
        cells: tuple[NDArray[np.int32], NDArray[np.int32] | None],
        markers: dict[str, NDArray],
        subsegments: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]],
        *,
        regions: Mapping[str, int] | None = None,
        unrefined: ArrayLike | None = None,
        reasons: ArrayLike | None = None,
        counts: Mapping[str, int] | None = None,
        figures: Mapping[str, float] | None = None,
        steps: Mapping[str, NDArray] | None = None,
    ) -> Self:
        """A mesh of triangles whose arrays our own kernels have just made: nothing is checked.

        Parameters
        ----------
        points, origin : ndarray
            Views of them become read-only.
        cells : tuple of ndarray
            ``simplices`` and ``neighbors``, which may be None. These become read-only themselves, as do the
            following arrays.
        markers : dict of str to ndarray
        subsegments : tuple of ndarray
            ``segments``, ``piece`` and ``span``.
        regions : dict of str to int, optional
            The numbers of regions that have a name; nothing is checked.
        unrefined, reasons, counts, figures, steps
            As for `DomainMesh`.
        """
        mesh = cls.__new__(cls)
        for array in (*cells, *markers.values(), *subsegments):
            if array is not None:
                array.setflags(write=False)
        mesh.points, mesh.origin, mesh.duplicates = frozen(points), frozen(origin), NO_PAIRS
        mesh.dimension, mesh.cells = 2, {"triangle": cells[0]}
        mesh.markers = checked_markers(markers, mesh)
        mesh.regions = checked_regions(dict(regions or {}))
        if cells[1] is not None:
            mesh.__dict__["neighbors"] = cells[1]
        mesh.segments, mesh.piece, mesh.span = subsegments
        mesh.faces, mesh.face_piece = NO_FACES, NO_CELLS
        mesh._take_account(unrefined, reasons, counts, figures, steps)
        return mesh

    def _take_account(
        self,
        unrefined: ArrayLike | None,
        reasons: ArrayLike | None,
        counts: Mapping[str, int] | None,
        figures: Mapping[str, float] | None,
        steps: Mapping[str, NDArray] | None,
    ) -> None:
        self.unrefined: np.ndarray = NO_CELLS
        self.left_out: np.ndarray = NO_CELLS
        if unrefined is not None:
            self.unrefined = frozen(np.asarray(unrefined, np.int32))
        self.reasons: np.ndarray = NO_REASONS
        if len(self.unrefined) or reasons is not None:
            why = np.full(len(self.unrefined), "") if reasons is None else np.asarray(reasons, dtype=str)
            if why.shape != self.unrefined.shape:
                raise InputError(
                    f"{len(self.unrefined)} cells are unrefined, but {why.shape} reasons are given"
                )
            self.reasons = frozen(why)
        self.counts: dict[str, int] = {name: int(count) for name, count in (counts or {}).items()}
        self.figures: dict[str, float] = {name: float(x) for name, x in (figures or {}).items()}
        self.steps: dict[str, NDArray] | None = None if steps is None else dict(steps)


def _pairs(values: ArrayLike, kind: Any) -> np.ndarray:
    rows = np.asarray(values, kind)
    return frozen(rows if rows.ndim == 2 and rows.shape[1] == 2 else rows.reshape(-1, 2))


M = TypeVar("M", bound=DomainMesh)
MOST_REASONS = 3  # in a warning
IS_MISSING = " is missing"  # ends reasons by which a mesh is not one of its domain


def noticed(mesh: M, lacking: str = "") -> M:
    """The mesh itself, with a warning for the caller of a method if it is not complete.

    Parameters
    ----------
    mesh : DomainMesh
    lacking : str
        What is said first, in a warning of its own, of a mesh that is not one of the domain; reasons that end
        with "is missing" are not told again.
    """
    if lacking:
        warnings.warn(lacking, IncompleteWarning, stacklevel=3)
    reasons = [why for why in mesh.reasons.tolist() if not (lacking and why.endswith(IS_MISSING))]
    if reasons:
        often = Counter(reasons).most_common(MOST_REASONS + 1)
        texts = [f"{reason or 'no reason'} ({count})" for reason, count in often[:MOST_REASONS]]
        more = ", ..." if len(often) > MOST_REASONS else ""
        warnings.warn(
            f"{len(reasons)} of {mesh.size} cells are not as asked for: {', '.join(texts)}{more}; "
            "see mesh.unrefined and mesh.reasons",
            IncompleteWarning,
            stacklevel=3,
        )
    return mesh
