"""The pairs of vertices on sides of a domain that match."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ...base.arrays import frozen
from ...domain.domain import Domain
from ...geometry.motion import Motion
from ...mesh.domain_mesh import DomainMesh
from ...mesh.periodic import Periodic

__all__ = ["paired"]

P = TypeVar("P", bound=DomainMesh)


def paired(domain: Domain, mesh: P) -> P:
    """The mesh itself, with the pairs of vertices on matched pieces in ``mesh.periodic``.

    Such pieces got no vertices but those of `Domain.sampled`, so that both have equally many.
    """
    if not domain.matches:
        return mesh
    found: dict[Motion, list[np.ndarray]] = {}
    order = np.lexsort((mesh.span[:, 0], mesh.piece))
    ends, start = mesh.segments[order], np.searchsorted(mesh.piece[order], np.arange(len(domain.pieces) + 1))
    for match in domain.matches:
        one, two = (ends[start[k] : start[k + 1]] for k in (match.first, match.second))
        if len(one) == len(two) > 0:  # pieces outside of the domain are not in the mesh
            one, two = (np.append(chain[:1, 0], chain[:, 1]) for chain in (one, two))
            rows = np.column_stack([one, two[::-1] if match.turned else two])
            found.setdefault(match.motion, []).append(
                rows[one != rows[:, 1]]
            )  # no vertex about which is turned
    every = [(motion, np.unique(np.concatenate(rows), axis=0)) for motion, rows in found.items()]
    mesh.periodic = tuple(Periodic(motion, frozen(rows.astype(np.int32))) for motion, rows in every)
    return mesh
