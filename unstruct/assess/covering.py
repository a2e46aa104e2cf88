"""Does a mesh of solids cover each point at most once? By degree: only its boundary has to be looked at.

**Theorem.** Let solids have a Jacobian that is positive inside, let each face belong to at most two of them,
which list it in opposite directions, and let the faces of the boundary, triangles and bilinear patches, meet
one another in common corners and edges alone. Let the outer side of each be outside by the even-odd rule.
Then no point lies inside two cells, or inside one of them twice.

*Proof.* Join the cells along common faces. Both cells of a face map it in the same way, since bilinear maps
depend on the corners alone; so there is one continuous map F of the whole. Let N(y) be the number of points
inside cells that F maps to y, and let y lie on no face. There F is a local diffeomorphism that keeps the
orientation, so that N(y) is the degree of F over y. The boundaries of the cells cancel on inner faces, so the
degree is the winding number w(y) of the faces of the boundary, directed outward (M. W. Hirsch, *Differential
Topology*, 1976, chapter 5). It is constant off these faces, and on the inner side of each it is larger by 1
than on the outer side, because no other face lies there. It is even where a ray to infinity meets an even
number of faces, so on the outer side of each face. On a path from infinity, where w = 0, it becomes 1 at the
first face. From there a face can be passed from inside to outside alone, as w is even on all outer sides;
then w is 0 again. So w is 0 or 1 everywhere off the boundary, and N <= 1 for all y that lie on no face. If a
point were the image of two points inside cells, all points near it would be images of two, as F is open
there: but most of these lie on no face. QED. (Faces inside, and cells that could not be divided into positive
tetrahedra, do not matter.)

The hypothesis on the boundary is decided so. A bilinear face lies in the tetrahedron of its corners. Where
these tetrahedra, and plane faces, meet in common corners and edges alone, so do the faces (exact); and they
may be replaced by two triangles each in the rule of even and odd, since nothing else lies in a tetrahedron.
Pairs for which this fails, and which are not both plane, are divided into smaller and smaller patches until
planes separate these: see `unstruct.geometry.patches`. They then meet as they may, but triangles must not
replace them everywhere. In that case each edge of the boundary must have two faces. Then each part of the
boundary that hangs together over edges divides space into two (a closed surface, some of whose vertices may
coincide). At a vertex of one part that lies in no other part's tetrahedra, triangles may stand for these
others; and the outer side of a part is its unbounded one if the volume in it is positive, which for a
bilinear face is the mean of those of its two divisions into triangles.
"""

from __future__ import annotations

import numpy as np

from ..base.report import Problem, Report, problem
from ..geometry.boxes import BoxTree
from ..geometry.inside_shell import enclosed_volume, even_odd_in_space, front_inside, triangle_components
from ..geometry.patches import patches_apart
from ..mesh.cells import incident_facets
from ..mesh.embedding import crossing_facets
from ..mesh.holding import SimplexCells
from ..mesh.mesh import Mesh
from ..predicates.batch import orient_rows

__all__ = ["check_covering"]

SURE_SUM = 2.0**-48  # of sums of two numbers that are rounded: their sign is sure
HULL_FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]])


def check_covering(mesh: Mesh, report: Report) -> None:
    """Test that cells of space, whose Jacobians are positive, do not overlap: by the theorem above."""
    faces, owner = outer_faces(mesh)
    quads = np.flatnonzero(faces[:, 3] != faces[:, 2])
    bent = np.zeros(len(faces), dtype=bool)
    bent[quads] = orient_rows(mesh.points, faces[quads]) != 0
    pairs = _touching(mesh.points, faces, bent)
    one, other = faces[pairs[:, 0]], faces[pairs[:, 1]]
    apart = np.zeros(len(pairs), dtype=bool)
    some = np.flatnonzero(bent[pairs].any(axis=1))
    apart[some] = patches_apart(mesh.points, one[some], other[some])
    crossed = pairs[~apart]
    plane = ~bent[crossed].any(axis=1)
    text = "boundary faces that meet in more than common corners and edges"
    near = "bilinear faces of the boundary that cross, or are too near each other to be told apart"
    free = report.note(
        "boundary faces, bilinear ones too, meet in common corners and edges alone",
        *(
            problem("crossing", words, owner[rows.ravel()], faces[rows.ravel()].ravel())
            for words, rows in ((text, crossed[plane]), (near, crossed[~plane]))
        ),
    )
    if free:
        _note_nesting(mesh, report, faces, owner, bent if len(pairs) else bent[:0])


def outer_faces(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """The faces of the boundary, outward, in rows of four, and their cells; triangles end with one twice."""
    rows, owner, group = incident_facets(mesh.cells)
    outer = np.flatnonzero(np.bincount(group)[group] == 1)
    faces = np.full((len(outer), 4), -1, dtype=np.int64)
    faces[:, : rows.shape[1]] = rows[outer]
    faces[:, 3] = np.where(faces[:, 3] < 0, faces[:, 2], faces[:, 3])
    return faces, owner[outer]


def _touching(points: np.ndarray, faces: np.ndarray, bent: np.ndarray) -> np.ndarray:
    """Pairs of faces whose hulls meet in more than common corners and edges: (c, 2), each once."""
    triangles, of = _hulls(faces, bent)
    pairs = of[crossing_facets(points, triangles.astype(np.int32))]
    face, vertex = _held(points, faces, bent)
    holder = np.zeros(len(points), dtype=np.int64)
    holder[faces] = np.arange(len(faces))[:, None]
    found = np.sort(np.concatenate([pairs, np.column_stack([face, holder[vertex]])]), axis=1)
    return np.unique(found[found[:, 0] != found[:, 1]], axis=0)


def _held(points: np.ndarray, faces: np.ndarray, bent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a bilinear face and a vertex of others that its tetrahedron contains."""
    rows = np.flatnonzero(bent)
    if len(rows) == 0:
        return rows, rows
    cells, vertices = SimplexCells(points, faces[rows]), np.unique(faces)
    x = points[vertices]
    query, hit = BoxTree(cells.low, cells.high).pairs(x, x)
    inside = cells.foreign(vertices[query], hit)
    inside[inside] = cells.holds(x[query[inside]], hit[inside])
    return rows[hit[inside]], vertices[query[inside]]


def _hulls(faces: np.ndarray, bent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the hulls of faces, and the face of each."""
    triangle = faces[:, 3] == faces[:, 2]
    parts, of = [], []
    for rows, many in (
        (np.flatnonzero(triangle), 1),
        (np.flatnonzero(~triangle & ~bent), 2),
        (bent.nonzero()[0], 4),
    ):
        parts.append(faces[rows][:, HULL_FACES[:many]].reshape(-1, 3))
        of.append(np.repeat(rows, many))
    return np.concatenate(parts), np.concatenate(of)


def _note_nesting(mesh: Mesh, report: Report, faces: np.ndarray, owner: np.ndarray, bent: np.ndarray) -> None:
    """Test that the outer sides of boundary faces are outside; ``bent`` are faces that triangles replace not.

    Where it is empty, they replace all.
    """
    triangles, of = _hulls(faces, np.zeros(len(faces), dtype=bool))
    if len(bent) == 0:
        found: np.ndarray | None = front_inside(mesh.points, triangles)
    else:
        found = _sides(mesh.points, faces, bent, triangles, of)
    wrong = None
    if found is None:
        text = "bilinear faces of the boundary are so near others that it is not told what lies within what"
        wrong = Problem("undecided", text)
    elif found.any():
        text = "cells that lie within others: the outer side of their boundary is inside"
        wrong = problem("overlap", text, owner[of[found]], faces[of[found]].ravel())
    report.note("no cells overlap: the boundary winds once around all that is inside (exact)", wrong)


def _sides(
    points: np.ndarray, faces: np.ndarray, bent: np.ndarray, triangles: np.ndarray, of: np.ndarray
) -> np.ndarray | None:
    """As `front_inside`, where triangles must not replace all faces; None where that does not tell.

    ``of`` are the faces that the triangles stand for, of which those of a face follow each other.
    """
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    if (np.unique(sides, axis=0, return_counts=True)[1] != 2).any():
        return None
    part, _, count = triangle_components(triangles)
    part_of = np.zeros(len(faces), dtype=np.int64)
    part_of[of] = part
    quads = faces[:, 3:] != faces[:, 2:3]
    other, of_other = _hulls(np.where(quads, faces[:, [1, 2, 3, 0]], faces), np.zeros(len(faces), dtype=bool))
    front = np.zeros(count, dtype=bool)
    for p in range(count):
        mine = part == p
        divided = triangles[mine], other[part_of[of_other] == p]  # by both diagonals of quadrilaterals
        volumes = [enclosed_volume(points, rows) for rows in divided]
        least = abs(sum(volumes)) <= SURE_SUM * (abs(volumes[0]) + abs(volumes[1]))
        free = np.setdiff1d(faces[part_of == p], faces[part_of != p])
        free = np.setdiff1d(free, _held(points, faces, bent & (part_of != p))[1])
        if least or len(free) == 0:
            return None
        odd, _ = even_odd_in_space(points, triangles[~mine], points[free[:1]])
        front[p] = bool(odd[0]) ^ (sum(volumes) < 0.0)
    return front[part]
