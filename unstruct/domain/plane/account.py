"""One entry of the account that repairs and simplification give."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Place", "Repair"]

Place = tuple[float, ...]


@dataclass(frozen=True)
class Repair:
    """One repair.

    Attributes
    ----------
    kind : str
        "index out of range", "duplicate points", "zero length", "repeated segment", "crossing", "overlap",
        "vertex on a segment", "vertex on an arc", "closed curve", "open boundary" or "vertex without
        pieces"; of `Domain.simplified` "dropped vertices", "dropped ring" or "joined facets". In space also
        "repeated vertex", "not flat", "crossing itself", "zero area", "repeated facet", "vertex on a facet",
        "vertex near an edge", "edge in a facet" or "turned facets"; "close points" of ``merge``; "left out"
        of a file.
    text : str
        What was found and what was done. Pieces and points have the numbers of the input; new points are
        named by their coordinates.
    place : tuple of float
        Coordinates; NaN if there are none.
    pieces, vertices : tuple of int
        Pieces and points of the input that had the fault.
    """

    kind: str
    text: str
    place: Place
    pieces: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"
