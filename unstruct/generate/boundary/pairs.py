"""The pairs of vertices on sides of a domain that match."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ...base.arrays import frozen
from ...domain.domain import Domain
from ...mesh.domain_mesh import DomainMesh

__all__ = ["paired"]

P = TypeVar("P", bound=DomainMesh)


def paired(domain: Domain, mesh: P) -> P:
    """The mesh itself, with the pairs of vertices on matched pieces in ``mesh.pairs``.

    Such pieces got no vertices but those of `Domain.sampled`, so that both have equally many.
    """
    if not domain.matches:
        return mesh
    order = np.lexsort((mesh.span[:, 0], mesh.piece))
    ends, start = mesh.segments[order], np.searchsorted(mesh.piece[order], np.arange(len(domain.pieces) + 1))
    rows = []
    for match in domain.matches:
        one, two = (ends[start[k] : start[k + 1]] for k in (match.first, match.second))
        if len(one) == len(two) > 0:  # pieces outside of the domain are not in the mesh
            one, two = (np.append(chain[:1, 0], chain[:, 1]) for chain in (one, two))
            rows.append(np.column_stack([one, two[::-1] if match.turned else two]))
    if rows:
        mesh.pairs = frozen(np.unique(np.concatenate(rows), axis=0).astype(np.int32))
    return mesh
