"""What is said of a mesh in which facets of its body are missing."""

from __future__ import annotations

import numpy as np

from ...domain.domain import Domain
from ...mesh.domain_mesh import IS_MISSING, DomainMesh

__all__ = ["what_is_missing"]

MOST_NAMED = 3  # pieces in the message
PLACE_STEPS = 1024  # parts of the extent to which the place is rounded
VOLUME_OFF = 1e-9  # relative, up to which the volume is called right: it is rounded where points were added


def what_is_missing(domain: Domain, mesh: DomainMesh, remedy: str = "") -> str:
    """Which pieces of a body a mesh lacks, where, and by how much its volume is off; "" if it lacks none.

    Parameters
    ----------
    domain : Domain
        In space.
    mesh : DomainMesh
        Its mesh, of which reasons tell what is missing.
    remedy : str
        What may help.
    """
    facets, edges = mesh.counts["missing triangles"], mesh.counts["missing segments"]
    if facets == 0 and edges == 0:
        return ""
    names: dict[str, int] = {}
    for cell, reason in zip(mesh.unrefined.tolist(), mesh.reasons.tolist()):
        if reason.endswith(IS_MISSING):
            names.setdefault(reason.removesuffix(IS_MISSING), cell)
    named = ", ".join(list(names)[:MOST_NAMED]) + (", ..." if len(names) > MOST_NAMED else "")
    cell = next(iter(names.values()))
    low, high = domain.bounds
    unit = float(np.abs(high - low).max()) / PLACE_STEPS
    place = [
        float(f"{round(x / unit) * unit:.6g}")
        for x in mesh.points[mesh.simplices[cell]].mean(axis=0).tolist()
    ]
    found, wanted = mesh.volume, domain.volume
    off = (
        f"its volume is {found:.6g} instead of {wanted:.6g}"
        if abs(found - wanted) > VOLUME_OFF * wanted
        else "its volume is right"
    )
    what = f"missing triangles: {facets}, missing edges: {edges}"
    return (
        f"the mesh is not one of the body: {named} {'is' if len(names) == 1 else 'are'} missing near {place} "
        f"({what}), and {off}" + (f"; {remedy}" if remedy else "")
    )
