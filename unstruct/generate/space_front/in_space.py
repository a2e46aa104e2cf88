from __future__ import annotations
import numpy as np
from ...base.progress import progress_bar
from ...domain.domain import Domain
from ...domain.space.by_part import size_by_part
from ...sizing.field import as_size
from ..bodies.dividing import divided
from ..bodies.tetrahedralize import as_parts
from ..volume.lattice import MOST_INNER
from ..volume.improving import improve
from ..volume_points.limits import REGULAR, make_body_limits
from ..volume_points.run import recovered
from .run import SpaceFrontRun

def space_front(domain, size, *, order="widest", placement="equal edges", finish=True, split_boundary=None, budget=None, history=False, progress=False, tune={}):
    field = as_size(size_by_part(domain, size))
    most = 10**7
    parts = None
    if split_boundary is None or split_boundary:
        parts = divided(domain, field, bool(split_boundary), most)
    body = domain if parts is None else parts.domain
    cells, found = recovered(body, progress)
    if not found.complete:
        raise NotImplementedError
    run = SpaceFrontRun(body, cells, found, order, placement, history)
    names = [*body.regions, *[""] * (int(run.regions.max()) + 1 - len(body.regions))]
    limits = make_body_limits(names, np.asarray(domain.bounds), cells.factor, size=size, reach=1.35*REGULAR)
    with progress_bar(progress, " points") as bar:
        run.march(limits, most, bar, tune)
    mesh = run.result()
    if parts is not None:
        mesh = as_parts(domain, parts, mesh)
    if finish:
        return improve(mesh)
    return mesh
