"""Cubes and what is between them and the surface as one mesh, with all names. See the book, chapter 4c."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import flagged
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh
from ..tree.cells import TreeCells
from ..tree.lookup import located
from ..volume.rounder import faces_of_cells
from .choosing import Kinds
from .numbering import numbered_parts
from .pattern import Cubes
from .skin import Skin, places_of_vertices
from .strip import Strip

__all__ = ["KINDS_OF_CELLS", "of_cubes", "of_cubes_alone", "together"]

LONG_AT_LEAF = (
    2.0  # edges of given facets over the side of the leaf there, from which cells at them are named
)
LARGE_FACET = "a facet is larger than the leaves there; split_boundary=True divides it"
FACES_ON_SIDES = "faces of leaves on facets"
KINDS_OF_CELLS = ("hexahedron", "pyramid", "tetra")


def of_cubes(
    cubes: Cubes, markers: Any = None, regions: Any = None, counts: Any = None, figures: Any = None
) -> DomainMesh:
    """The mesh of these cells only."""
    blocks = (cubes.hexahedra, cubes.pyramids, cubes.tetrahedra)
    used = np.flatnonzero(flagged(len(cubes.points), *blocks))
    number = np.full(len(cubes.points), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    cells = [number[rows] for rows in blocks]
    return DomainMesh(
        cubes.points[used],
        None,
        cells=_named_cells(cells),
        origin=np.full(len(used), -1, dtype=np.int32),
        markers=markers,
        regions=regions,
        counts=_counts(cells) | (counts or {}),
        figures=figures,
    )


def _named_cells(blocks: Any) -> dict[str, Any]:
    cells = {name: rows for name, rows in zip(KINDS_OF_CELLS, blocks, strict=True) if len(rows)}
    return cells or {"tetra": blocks[-1]}


def _counts(blocks: Any) -> dict[str, int]:
    return {f"cells: {name}": len(rows) for name, rows in zip(KINDS_OF_CELLS, blocks, strict=True)}


def together(
    tree: TreeCells, strip: Strip, cubes: Cubes, kinds: Kinds, skin: Skin, place: Any = None
) -> DomainMesh:
    """One mesh of the kernel and the strip around it.

    Parameters
    ----------
    tree : TreeCells
        With its domain.
    strip : Strip
    cubes, kinds
        The kernel.
    skin : Skin
        Its faces on facets.
    place : (v,) int64, optional
        The points of the domain, or others, at its vertices.
    """
    mesh, domain = strip.mesh, tree.domain
    number, new = _numbers(strip, cubes)
    tetrahedra = np.concatenate([number[cubes.tetrahedra], mesh.simplices])
    blocks = [number[cubes.hexahedra], number[cubes.pyramids], tetrahedra]
    own = np.asarray(mesh.origin)
    origin = np.where(own >= 0, strip.given[own], -1)
    more = np.full(len(new), -1)
    if place is not None:
        more = np.where(place[new] < len(domain.points), place[new], -1)
    pieces = _pieces(strip)
    large = _at_large_facets(tree, mesh, pieces["faces"])
    reasons = dict.fromkeys(large.tolist(), LARGE_FACET)
    reasons |= dict(zip(mesh.unrefined.tolist(), mesh.reasons.tolist(), strict=True))
    cells, before = sorted(reasons), len(cubes.leaf)
    if len(skin.faces):
        rows = np.where(skin.faces >= 0, number[skin.faces], -1)
        pieces["faces"] = np.concatenate([_four(pieces["faces"]), rows])
        pieces["face_piece"] = np.concatenate([pieces["face_piece"], skin.piece])
    return DomainMesh(
        np.concatenate([mesh.points, cubes.points[new]]),
        None,
        cells=_named_cells([rows.astype(np.int32) for rows in blocks]),
        origin=np.concatenate([origin, more]).astype(np.int32),
        markers=_markers(domain, pieces) | {"region": numbered_parts(tree, strip, cubes, kinds, number)},
        regions={name: k for k, name in enumerate(domain.regions)},
        **pieces,
        unrefined=[before + cell for cell in cells] if cells else None,
        reasons=[reasons[cell] for cell in cells] if cells else None,
        counts=mesh.counts | _counts(blocks) | {FACES_ON_SIDES: len(skin.faces)},
        figures={"share of hexahedra": _share(cubes, domain)},
    )


def of_cubes_alone(tree: TreeCells, cubes: Cubes, skin: Skin, region: NDArray[Any]) -> DomainMesh:
    """The mesh of a body that is its leaves; `region` has the number of that of each leaf."""
    domain = tree.domain
    blocks = (cubes.hexahedra, cubes.pyramids, cubes.tetrahedra)
    used = np.flatnonzero(flagged(len(cubes.points), *blocks))
    number = np.full(len(cubes.points), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    cells = [number[rows] for rows in blocks]
    none = np.empty((0, 2))
    faces = np.where(skin.faces >= 0, number[skin.faces], -1)
    pieces: dict[str, Any] = {"faces": faces, "face_piece": skin.piece, "segments": none.astype(np.int32)}
    pieces |= {"piece": none[:, 0].astype(np.int32), "span": none}
    return DomainMesh(
        cubes.points[used],
        None,
        cells=_named_cells(cells),
        origin=places_of_vertices(domain, cubes.points[used]).astype(np.int32),
        markers=_markers(domain, pieces) | {"region": region[cubes.leaf].astype(np.int32)},
        regions={name: k for k, name in enumerate(domain.regions)},
        **pieces,
        counts=_counts(cells) | {FACES_ON_SIDES: len(skin.faces)},
        figures={"share of hexahedra": _share(cubes, domain)},
    )


def _narrow(faces: NDArray[Any]) -> NDArray[Any]:
    """Rows of three, if all faces are triangles."""
    return faces[:, :3] if faces.shape[1] > 3 and (faces[:, 3] < 0).all() else faces


def _four(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """Triangles as rows of four."""
    return np.column_stack([faces, np.full(len(faces), -1, dtype=np.int32)])


def _numbers(strip: Strip, cubes: Cubes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The number in the whole of each vertex of the kernel, and those that the strip does not have."""
    origin = np.asarray(strip.mesh.origin)
    number = np.full(len(cubes.points), -1, dtype=np.int64)
    at = np.flatnonzero(origin >= 0)
    at = at[strip.core[origin[at]] >= 0]
    number[strip.core[origin[at]]] = at
    used = flagged(len(number), cubes.hexahedra, cubes.pyramids, cubes.tetrahedra)
    new = np.flatnonzero(used & (number < 0))
    number[new] = len(strip.mesh.points) + np.arange(len(new))
    return number, new


def _pieces(strip: Strip) -> dict[str, Any]:
    """Which faces and edges lie on which pieces of the domain."""
    mesh, many, parts = strip.mesh, len(strip.domain.facets) - strip.facets, strip.parts
    own = ~strip.of_kernel
    face_piece = np.asarray(mesh.face_piece)[own]
    face_piece = np.where(face_piece < strip.facets, face_piece, face_piece - many)
    piece, span = np.asarray(mesh.piece) - many, np.asarray(mesh.span)
    if parts is not None:
        low, high = parts.span[piece].T
        span = low[:, None] + span * (high - low)[:, None]
        face_piece, piece = parts.parent[face_piece], parts.parent[piece]
    return {
        "faces": np.asarray(mesh.faces)[own],
        "face_piece": face_piece,
        "segments": mesh.segments,
        "piece": piece,
        "span": span,
    }


def _markers(domain: Domain, pieces: dict[str, Any]) -> dict[str, NDArray[Any]]:
    faces, face_piece = pieces["faces"], pieces["face_piece"]
    bounding = face_piece < len(domain.facets)
    markers = {"facets": _narrow(faces[bounding]), "inner": _narrow(faces[~bounding])}
    for name, rows in domain.markers.items():
        named = _narrow(faces[np.isin(face_piece, rows)])
        edges = np.asarray(pieces["segments"])[np.isin(pieces["piece"], rows)]
        markers[name] = named if len(named) or not len(edges) else edges
    return markers


def _at_large_facets(tree: TreeCells, mesh: DomainMesh, faces: NDArray[np.int32]) -> NDArray[np.int64]:
    """The cells at faces on pieces with an edge that is much longer than leaves there."""
    x = mesh.points[faces]
    large = np.zeros(len(x), dtype=bool)
    low, high = tree.box
    for i, j in ((0, 1), (1, 2), (2, 0)):
        along = x[:, i] - x[:, j]
        length = np.sqrt(along[:, 0] ** 2 + along[:, 1] ** 2 + along[:, 2] ** 2)
        leaf = located(tree.grid, np.clip((x[:, i] + x[:, j]) / 2, low, high))
        large |= length > LONG_AT_LEAF * np.asarray(tree.sides)[leaf]
    return np.flatnonzero(faces_of_cells(mesh.simplices, faces[large], len(mesh.points)).any(axis=1))


def _share(cubes: Cubes, domain: Domain) -> float:
    """The volume of the hexahedra over that of the domain."""
    x = cubes.points[cubes.hexahedra]
    edge = x[:, 6] - x[:, 0]
    return float((edge[:, 0] * edge[:, 1] * edge[:, 2]).sum() / domain.volume)
