"""A region meshed in parts, by as many workers as there are: `mesh_parts`, and what it returns unjoined."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from pickle import PicklingError
from typing import Any

import numpy as np

from ...base.arguments import as_count, as_flags
from ...base.errors import InputError
from ...base.progress import progress_bar
from ...domain.domain import Domain, as_domain
from ...mesh.domain_mesh import DomainMesh, noticed
from ..rebay.voronoi_segment import voronoi_segment
from .coarse import coarse_triangles
from .dividing import Division, divide
from .joining import joined
from .records import Part, mesh_part
from .writing import write_index

__all__ = ["Parts", "mesh_parts"]

FEWEST_CELLS = 16  # a part


@dataclass(frozen=True)
class Parts:
    """A region in parts that are not joined.

    Attributes
    ----------
    domain : Domain
        The whole.
    parts : list of Part
        What was given to the workers; ``part.domain`` is a domain by itself.
    meshes : list
        What ``map`` has returned for each: meshes, or an engine's promises of them.
    """

    domain: Domain
    division: Division
    meshes: list[Any]

    @property
    def parts(self) -> list[Part]:
        """What was given to the workers."""
        return self.division.parts

    def join(self, meshes: Iterable[DomainMesh] | None = None) -> DomainMesh:
        """One mesh of the whole region, as `mesh_parts` returns it.

        Parameters
        ----------
        meshes : iterable of DomainMesh, optional
            The meshes of all parts, in order; needed if ``self.meshes`` are promises.
        """
        if meshes is not None and not isinstance(meshes, Iterable):
            raise InputError(f"meshes must be those of all parts, not a {type(meshes).__name__}")
        found = self.meshes if meshes is None else list(meshes)
        for k, mesh in enumerate(found):
            if not isinstance(mesh, DomainMesh):
                raise InputError(
                    f"meshes[{k}] is a {type(mesh).__name__}, not a mesh: gather the results first"
                )
        return noticed(joined(self.domain, self.division, found))

    def write(self, path: str | Path, *, map: Callable[..., Iterable[Any]] = map) -> list[Path]:
        """Write each part as .vtu, and an index .pvtu that ParaView and pyvista open as one mesh.

        Parameters
        ----------
        path : str or Path
            Of the index; the parts get its name and their number. On a cluster all workers must see it.
        map : callable
            ``map(work, meshes, parts, paths)`` returns the results in order; where meshes are promises of
            Dask, ``lambda work, *rows: client.gather(client.map(work, *rows))``, so that each is written
            where it was made. Needs the package meshio.

        Returns
        -------
        list of Path
            The index, then the parts.
        """
        return write_index(self.parts, self.meshes, path, map)

    def __repr__(self) -> str:
        return f"<Parts: {len(self.parts)} parts of about {self.parts[0].predicted:.0f} cells>"


def mesh_parts(
    domain: Domain,
    size: Any,
    parts: int,
    *,
    method: Callable[..., DomainMesh] | None = None,
    map: Callable[..., Iterable[Any]] = map,
    join: bool = True,
    progress: bool = False,
) -> Any:
    """Mesh a planar region in parts that are independent of each other, and join them exactly.

    Parameters
    ----------
    domain : Domain
    size : number, function (k, 2) -> (k,), SizeField, or dict of region name to one of these
        The wanted edge length.
    parts : int
        How many parts; each must have room for 16 cells.
    method : callable, optional
        Takes a domain and a size, and returns a `DomainMesh`; `voronoi_segment` by default. For options
        give ``functools.partial(method, ...)``; a ``history`` stays in the meshes of the parts. It must keep
        pieces with a `Spacing` as they are, as the methods of this book do.
    map : callable
        ``map(work, parts)`` returns the meshes in the order of the parts. The builtin one works in this
        process; ``ThreadPoolExecutor().map`` in threads, which is worth it since kernels release Python's
        lock; ``ProcessPoolExecutor().map`` in processes; and with Dask, on any number of machines,
        ``lambda work, parts: client.gather(client.map(work, parts))``.
    join : bool
        Whether to join. Otherwise the result is a record `Parts`, and with ``map=client.map`` of Dask the
        meshes stay on the cluster: see `Parts.write`.
    progress : bool
        Show a bar of the parts that are done.

    Returns
    -------
    DomainMesh or Parts
        Its cells have a marker "part". ``unstruct.check(mesh, domain=domain)`` holds. ``counts`` are the sums
        over the parts, besides "parts", "coarse triangles", "interface edges"; ``figures`` has "largest
        part" (its cells by the mean) and "least coarse angle", in degrees. With one part the mesh is the
        method's own.

    Raises
    ------
    InputError
        For more parts than there is room for, and for metrics; for a size, a curve or a method that cannot
        be sent to another process, with the remedy.
    MeshError
        If a part fails; the message names it.

    Notes
    -----
    The boundary is cut by the size. Coarse triangles whose edges grow from there (`voronoi_segment`, about
    400 a part) are divided by recursive bisection into parts of equal predicted numbers of cells, the
    integral of 1 / size^2; single triangles then change sides while the cut becomes shorter. Edges between
    parts are cut once, by the size, and held. So both sides have the same points bit for bit, whoever works
    on them, and the result depends neither on the executor nor on the number of workers. Every corner of a
    part has one or more coarse triangles, so that *its angle is at least the least coarse angle*;
    straightening lets no coarse angle become smaller that is below 25 degrees, and none go below. Pieces of
    the boundary may be split within a part, on the true curve, and pieces between two parts not; so triangles
    there are a little less good, and the constrained Delaunay property may fail across interfaces. Parts are
    even within a few hundredths if the size has no jumps and a part has some hundred cells. Sources:
    E. Ivanov, O. Gluchshenko, H. Andrä, A. Kudryavtsev, *Parallel software tool for decomposing and meshing
    of 3d structures*, Fraunhofer ITWM 110, 2007; C. M. Fiduccia, R. M. Mattheyses, Design Automation
    Conference, 1982.
    """
    as_flags(join=join, progress=progress)
    domain = as_domain(domain)
    many = as_count(parts, "parts")
    if many < 1:
        raise InputError("parts must be at least 1")
    chosen = voronoi_segment if method is None else method
    for what, value in (("method", chosen), ("map", map)):
        if not callable(value):
            raise InputError(f"{what} must be a function, not {type(value).__name__}")
    if many == 1 and join:
        mesh = chosen(domain, size)
        mesh.markers["part"] = np.zeros(mesh.size, dtype=np.int32)
        return mesh
    coarse = coarse_triangles(domain, size, many)
    room = int(coarse.cells.sum() / FEWEST_CELLS)
    most = max(min(room, coarse.mesh.size), 1)
    if many > most:
        raise InputError(
            f"parts = {many} is too many: about {coarse.cells.sum():.0f} cells of this size fit into "
            f"the region; take at most {most} parts, or a smaller size"
        )
    division = divide(domain, size, coarse, many, chosen)
    meshes = []
    with progress_bar(progress, " parts", total=many) as bar:
        for mesh in _sent(map, division.parts):
            meshes.append(mesh)
            bar.update(1)
    found = Parts(domain, division, meshes)
    return found.join() if join else found


def _sent(map_: Callable[..., Iterable[Any]], parts: list[Part]) -> Iterable[Any]:
    """What ``map_`` returns; an error says what to do if something cannot be sent to another process."""
    try:
        yield from map_(mesh_part, parts)
    except (PicklingError, AttributeError, TypeError) as error:
        if "pickle" not in str(error):
            raise
        raise InputError(
            f"a part cannot be sent to another process: {error}; the size, the functions of curves and the "
            "method must be functions of a module (or functools.partial of one), not lambdas"
        ) from error
