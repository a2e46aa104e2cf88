"""Second-order triangles: a node in the middle of each edge, on the true curve where there is one.

A triangle with six nodes is the image of a straight one under a map of degree two. Its Jacobian determinant
is a polynomial of degree two, so in Bernstein form it has six coefficients, and it lies between the smallest
and the largest of them. If all are positive, the map is invertible everywhere in the triangle.

Sources: P. L. George, H. Borouchaki, International Journal for Numerical Methods in Engineering 90 (2012)
1156-1182; A. Johnen, J.-F. Remacle, C. Geuzaine, Journal of Computational Physics 233 (2013) 359-372.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ..base.arrays import frozen
from ..base.errors import InputError
from ..base.files import as_path, suffix_of
from ..base.optional import optional
from ..base.telling import tell, tell_renamed
from ..geometry.outline import Outline
from .domain_mesh import DomainMesh
from .gmsh import coded
from .mesh import Mesh, is_planar
from .periodic import facet_images

__all__ = ["CurvedMesh", "bernstein", "second_order"]

ROUNDING = 2.0**-46  # relative to the squared extent of a triangle: more than the rounding of a coefficient
BISECTIONS = 60  # of a parameter interval, until its ends are neighbors
CUTS_IN_FOUR = 3  # how often a triangle is cut into four before its Jacobian counts as not positive
EDGES_OF_SIX = ((0, 1), (1, 2), (2, 0))  # in the order of VTK and Gmsh: node 3 + k is on side k


class CurvedMesh:
    """Triangles with six nodes, some with curved edges; see `second_order`.

    Attributes
    ----------
    mesh : Mesh
        The mesh of straight triangles that it was made of, with its markers.
    points : (n + e, 2) float64
        The n points of ``mesh``, then the node of each of its e edges.
    triangles : (m, 6) int32
        Corners 0, 1, 2 as in ``mesh.simplices``, then the nodes of the edges 01, 12, 20.
    edges : (e, 3) int32
        The ends and the node of each edge, in the order of ``mesh.edges``.
    curved : (c,) int32
        Edges whose node is off their middle.
    straightened : (s,) int32
        Edges on a curve that had to stay straight, since a triangle would not have been valid otherwise.
    """

    def __init__(self, mesh: Mesh, points: np.ndarray, triangles: np.ndarray, edges: np.ndarray):
        self.mesh, self.points, self.triangles = mesh, frozen(points), frozen(triangles)
        self.edges = frozen(edges)
        self.curved: np.ndarray = frozen(np.empty(0, dtype=np.int32))
        self.straightened: np.ndarray = self.curved

    @property
    def complete(self) -> bool:
        """Whether every edge on a curve has its node on it."""
        return len(self.straightened) == 0

    def jacobians(self) -> np.ndarray:
        """The smallest Bernstein coefficient of each triangle's Jacobian determinant: (m,) float64.

        The determinant, as the map from the triangle (0, 0), (1, 0), (0, 1), is nowhere smaller.
        """
        return bernstein(self.points[self.triangles]).min(axis=1)

    @property
    def area(self) -> float:
        """The area within the curved edges."""
        return float(bernstein(self.points[self.triangles]).mean(axis=1).sum() / 2)

    def to_meshio(self) -> Any:
        """A meshio mesh of "triangle6" and, for named edges, "line3" cells; names are in ``field_data``.

        Regions and named edges are physical groups of Gmsh ("gmsh:physical"). An edge in several groups is
        listed once for each.
        """
        meshio = optional("meshio", "writing curved cells")

        cells: list[tuple[str, np.ndarray]] = [("triangle6", self.triangles)]
        region = self.mesh.markers.get("region")
        known = region is not None and region.ndim == 1
        groups = [np.asarray(region, dtype=np.int64) + 1 if known else np.ones(len(self.triangles), np.int64)]
        called = {number: name for name, number in self.mesh.regions.items() if name not in self.mesh.markers}
        field_data = {
            called.get(r, f"region {r}"): np.array([r + 1, 2])
            for r in sorted({int(g) - 1 for g in groups[0]})
        }
        number = int(groups[0].max(initial=0))
        for name, rows in self.mesh.markers.items():
            if rows.ndim == 2 and rows.shape[1] == 2 and len(rows):
                number += 1
                cells.append(("line3", self._lines(rows)))
                groups.append(np.full(len(rows), number))
                field_data[name] = np.array([number, 1])
        data = {"gmsh:physical": groups, "gmsh:geometrical": [g.copy() for g in groups]}
        places = np.column_stack([self.points, np.zeros(len(self.points))])  # these formats are of space
        return meshio.Mesh(places, cells, cell_data=data, field_data=field_data)

    def _lines(self, rows: np.ndarray) -> np.ndarray:
        """Edges, given by their ends, with their nodes: (k, 3)."""
        keys = _keys(self.edges[:, :2], len(self.points))
        order = np.argsort(keys)
        place = order[np.searchsorted(keys, _keys(rows, len(self.points)), sorter=order)]
        return np.column_stack([rows, self.edges[place, 2]]).astype(np.int32)

    def to_skfem(self) -> Any:
        """A scikit-fem mesh `MeshTri2`, with the named edges and cells of the straight one."""
        import skfem

        linear = self.mesh.to_skfem()
        used = np.unique(self.mesh.simplices)
        ends = np.sort(self.edges[:, :2], axis=1)
        number = np.full(len(self.points), -1)
        number[used] = np.arange(len(used))
        keys = _keys(number[ends], len(self.points))
        order = np.argsort(keys)
        theirs = _keys(linear.facets.T, len(self.points))
        nodes = self.edges[order[np.searchsorted(keys, theirs, sorter=order)], 2]
        places = np.hstack([linear.p, self.points[nodes].T])
        return skfem.MeshTri2(
            places, linear.t, _boundaries=linear.boundaries, _subdomains=linear.subdomains, validate=False
        )

    def write(self, path: Any, *, file_format: str | None = None, binary: bool | None = None) -> None:
        """Write to a file that meshio knows and that holds second-order cells: .vtu, .msh, .xdmf, ...

        Parameters
        ----------
        path : str or Path
        file_format : str, optional
            meshio's name of the format, for example "gmsh"; by default the suffix decides (.msh: "gmsh22").
        binary : bool, optional
            Binary instead of text, in formats that have both.
        """
        if self.mesh.periodic:
            tell("not written: 'periodic'; files of curved cells do not store it")
        options = {} if binary is None else {"binary": binary}
        target, theirs = as_path(path), self.to_meshio()
        if file_format is None and suffix_of(target) == ".msh":
            file_format = "gmsh22"  # meshio would write another format of this suffix
        names = {name: coded(name) for name in theirs.field_data}
        theirs.field_data = {names[name]: row for name, row in theirs.field_data.items()}
        try:
            theirs.write(target, file_format=file_format, **options)
        except OSError as error:
            raise InputError(f"cannot write {target}: {error.strerror or error}") from error
        except (Exception, SystemExit) as error:  # meshio raises many kinds
            why = f"{type(error).__name__}: {error}".removesuffix(": ")
            raise InputError(f"meshio cannot write cells of six nodes as {target.name} ({why})") from error
        if suffix_of(target) == ".msh":
            tell_renamed(names, "names in .msh have codes for quotes, brackets and percent signs")

    def __repr__(self) -> str:
        lost = f", {len(self.straightened)} straightened" if len(self.straightened) else ""
        return (
            f"<CurvedMesh: {len(self.triangles)} triangles of 6 nodes, {len(self.curved)} curved edges{lost}>"
        )


def second_order(mesh: Mesh, domain: Outline | None = None) -> CurvedMesh:
    """Triangles of six nodes, with edges that follow the curves of a domain.

    Parameters
    ----------
    mesh : Mesh
        Planar triangles. Which edges are parts of which piece is known for the mesh of a domain
        (`DomainMesh.segments`, ``piece``, ``span``).
    domain : Domain, optional
        The domain that was meshed. Without it, or for a mesh that keeps no record of pieces, all edges stay
        straight.

    Returns
    -------
    CurvedMesh
        Every triangle has a positive Jacobian everywhere, by its Bernstein coefficients. If a triangle would
        not, its curved edges stay straight, and are listed in ``straightened``.

    Raises
    ------
    InputError
        If the mesh is not one of planar triangles, or not a mesh of this domain.

    Notes
    -----
    The node of an edge is the point of its curve that is equally far from both ends. With it, the boundary is
    off by O(h^4) in the area and O(h^3) in the place, instead of O(h^2) for both. On sides that match
    (``mesh.periodic``) the nodes are images of each other, as the vertices are. O(n log n).
    Book: 2.6d.
    """
    if not is_planar(mesh):
        raise InputError("second_order takes a planar mesh of triangles")
    ends = np.asarray(mesh.edges, dtype=np.int64)
    nodes = mesh.points[ends].mean(axis=1)
    n = len(mesh.points)
    keys = _keys(ends, n)
    order = np.argsort(keys)
    place, wanted = _on_curves(mesh, domain, keys, order) if domain is not None else (_NONE, nodes[:0])
    straight = nodes.copy()
    nodes[place] = wanted
    image = np.arange(len(ends))  # edges on sides that match are bent, or stay straight, together
    for motion, pairs in mesh.periodic:
        one, two = facet_images(pairs, mesh.edges, n)
        image[one], image[two] = two, one
        if motion is not None:
            nodes[two], straight[two] = motion(nodes[one]), motion(straight[one])
    corner = mesh.simplices.astype(np.int64)
    sides = np.stack([_keys(corner[:, list(side)], n) for side in EDGES_OF_SIX], axis=1)
    side = order[np.searchsorted(keys, sides, sorter=order)]
    bent = (nodes != straight).any(axis=1)
    lost = np.zeros(len(ends), dtype=bool)
    while True:
        rows = np.nonzero(bent[side].any(axis=1))[0]
        six = np.concatenate([mesh.points[corner[rows]], nodes[side[rows]]], axis=1)
        bad = side[rows[~_positive_everywhere(six)]].ravel()
        bad = np.concatenate([bad, image[bad]])
        bad = bad[bent[bad]]
        if len(bad) == 0:
            break
        lost[bad], bent[bad], nodes[bad] = True, False, straight[bad]
    result = CurvedMesh(
        mesh,
        np.concatenate([mesh.points, nodes]),
        np.column_stack([corner, n + side]).astype(np.int32),
        np.column_stack([ends, n + np.arange(len(ends))]).astype(np.int32),
    )
    result.curved = frozen(np.nonzero(bent)[0].astype(np.int32))
    result.straightened = frozen(np.nonzero(lost)[0].astype(np.int32))
    return result


_NONE = np.empty(0, dtype=np.int64)


def _keys(pairs: np.ndarray, n: int) -> np.ndarray:
    """One number for each unordered pair of vertices."""
    low, high = np.sort(np.asarray(pairs, dtype=np.int64), axis=1).T
    return low * n + high


def _on_curves(
    mesh: Mesh, domain: Outline, keys: np.ndarray, order: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The edges on curves, and the points of the curves that are equally far from their ends."""
    if not isinstance(domain, Outline):
        raise InputError(f"domain must be a Domain, not {type(domain).__name__}")
    if not isinstance(mesh, DomainMesh) or not len(mesh.piece) or not domain.curves:
        return _NONE, np.empty((0, 2))
    if mesh.piece.max() >= len(domain.pieces):
        raise InputError(f"the mesh has parts of piece {mesh.piece.max()}, which the domain does not have")
    rows = np.nonzero(np.isin(mesh.piece, list(domain.curves)))[0]
    piece, span = mesh.piece[rows].astype(np.int64), mesh.span[rows]
    ends = mesh.points[mesh.segments[rows]]
    scale = np.abs(domain.points).max()
    off = np.abs(domain.points_at(np.repeat(piece, 2), span.ravel()).reshape(-1, 2, 2) - ends).max(
        axis=(1, 2)
    )
    if (off > 2.0**-30 * scale).any():
        name = domain.name(int(piece[np.argmax(off)]))
        raise InputError(f"an edge of the mesh is not on {name}, as it should be: is this the meshed domain?")
    low, high = span.T.copy()
    for _ in range(BISECTIONS):
        t = (low + high) / 2
        x = domain.points_at(piece, t)
        nearer = ((x - ends[:, 0]) ** 2).sum(axis=1) < ((x - ends[:, 1]) ** 2).sum(axis=1)
        low, high = np.where(nearer, t, low), np.where(nearer, high, t)
    return order[np.searchsorted(keys, _keys(mesh.segments[rows], len(mesh.points)), sorter=order)], x


# ---------------------------------------------------------------------- the sign of the Jacobian


def bernstein(six: np.ndarray) -> np.ndarray:
    """The Bernstein coefficients of the Jacobian determinants of second-order triangles.

    Parameters
    ----------
    six : ndarray, shape (m, 6, 2)
        Three corners, then the nodes of the edges 01, 12, 20.

    Returns
    -------
    (m, 6) float64
        Of lambda_0^2, lambda_1^2, lambda_2^2, then of 2 lambda_i lambda_j for the edges 01, 12, 20.
    """
    return _coefficients(six, 2.0)


def _coefficients(six: Any, two: Any) -> np.ndarray:
    """The coefficients, with numbers of any kind; ``two`` is 2 as such a number."""
    six = np.asarray(six)
    c = [six[:, k] for k in range(3)]
    control = {
        pair: two * six[:, 3 + k] - (c[pair[0]] + c[pair[1]]) / two for k, pair in enumerate(EDGES_OF_SIX)
    }
    c01, c12, c20 = (control[pair] for pair in EDGES_OF_SIX)
    a = (c01 - c[0], c[1] - c01, c12 - c20)  # half of the derivative along the edge 01, at the corners
    b = (c20 - c[0], c12 - c01, c[2] - c20)  # along the edge 02
    found = [two * two * _cross(a[k], b[k]) for k in range(3)]
    found += [two * (_cross(a[i], b[j]) + _cross(a[j], b[i])) for i, j in EDGES_OF_SIX]
    return np.stack(found, axis=1)


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def _positive_everywhere(six: np.ndarray) -> np.ndarray:
    """Whether the Jacobian of each triangle is proved positive: by coefficients, also of its quarters."""
    found = bernstein(six)
    bound = ROUNDING * np.ptp(six, axis=1).max(axis=1, initial=0.0) ** 2
    sure = (found > bound[:, None]).all(axis=1)
    for row in np.nonzero(~sure)[0]:
        exact = np.array([[Fraction(x) for x in place] for place in six[row].tolist()], dtype=object)
        sure[row] = _proved(_coefficients(exact[None], Fraction(2))[0].tolist(), CUTS_IN_FOUR)
    return sure


def _proved(c: list[Fraction], depth: int) -> bool:
    """Whether a polynomial of degree two is positive on a triangle, by coefficients, or on its quarters."""
    if min(c) > 0:
        return True
    if min(c[:3]) <= 0 or depth == 0:  # at corners it has the value of the coefficient
        return False
    c0, c1, c2, c01, c12, c20 = c
    m01, m12, m20 = (c0 + 2 * c01 + c1) / 4, (c1 + 2 * c12 + c2) / 4, (c2 + 2 * c20 + c0) / 4
    quarters = (
        [c0, m01, m20, (c0 + c01) / 2, (c01 + c20 + c0 + c12) / 4, (c0 + c20) / 2],
        [m01, c1, m12, (c01 + c1) / 2, (c1 + c12) / 2, (c01 + c12 + c1 + c20) / 4],
        [m20, m12, c2, (c20 + c12 + c2 + c01) / 4, (c12 + c2) / 2, (c2 + c20) / 2],
        [
            m01,
            m12,
            m20,
            (c01 + c12 + c1 + c20) / 4,
            (c20 + c12 + c2 + c01) / 4,
            (c01 + c20 + c0 + c12) / 4,
        ],
    )
    return all(_proved(list(q), depth - 1) for q in quarters)
