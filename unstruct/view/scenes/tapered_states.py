"""The shortest edge of a front in a channel that gets narrow, as a frame (section 3.2)."""

from __future__ import annotations

import warnings

import numpy as np

from ...base.errors import IncompleteWarning
from ...domain.domain import Domain
from ...generate.boundary.constrained import constrained_delaunay
from ...generate.front.advancing_front import advancing_front
from ...mesh.domain_mesh import DomainMesh
from ..draw import frames as fr
from .choices import preset_named, within

__all__ = ["TAPERED_RULES", "TAPERED_WIDTHS", "tapered_state"]

TAPERED_RULES = {name: name for name in ("equal sides", "circle", "angle")}
TAPERED_WIDTHS = [0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4]
TAPERED_LENGTH, TAPERED_MOUTH = 6.0, 2.6
TAPERED_WINDOW = (-0.3, 6.3, -0.3, 2.9)


def tapered_state(width: float = 1.4, rule: str = "angle") -> fr.Frame:
    """A channel that is meshed by a front with the wanted length 1, and its shortest edge.

    Parameters
    ----------
    width : float
        Of the left end of the channel; the right end is 2.6 wide.
    rule : str
        One of `TAPERED_RULES`.

    Returns
    -------
    dict
        The mesh as the front leaves it, its new vertices and its shortest edge. The number has the length of
        this edge, that of the shortest edge at the beginning, and the bound of Theorem 3.2.3.
    """
    placement = preset_named(TAPERED_RULES, rule)
    within("width", width, 0.05, TAPERED_MOUTH)
    corners = [(0.0, 0.0), (TAPERED_LENGTH, 0.0), (TAPERED_LENGTH, TAPERED_MOUTH), (0.0, width)]
    domain = Domain.polygon(corners)
    pieces = domain.sampled(1.0)
    with warnings.catch_warnings():  # triangles that had to be accepted are no matter of this picture
        warnings.simplefilter("ignore", IncompleteWarning)
        begun = constrained_delaunay(Domain(pieces.points, pieces.ends))
        mesh = advancing_front(domain, 1.0, placement=placement, finish=False)
    first, last = _lengths(begun).min(), _lengths(mesh)
    shortest = mesh.points[mesh.edges[last.argmin()]]
    items = [
        fr.polygons("cell", mesh.corners),
        fr.segments("constrained", mesh.points[mesh.segments]),
        fr.segments("highlight", [shortest]),
        fr.dots("inserted", mesh.points[len(begun.points) :]),
    ]
    bound = min(0.64, first)
    number = f"shortest edge {last.min():.2f} h; at the beginning {first:.2f} h; bound {bound:.2f} h"
    many = len(mesh.points) - len(begun.points)
    text = f"{rule}, {width:g} h wide at the left: {many} new point{'s' * (many != 1)}"
    return fr.frame(text, *items, number=number, view=TAPERED_WINDOW)


def _lengths(mesh: DomainMesh) -> np.ndarray:
    steps = np.diff(mesh.points[mesh.edges], axis=1)[:, 0]
    return np.asarray(np.sqrt((steps**2).sum(axis=1)))
