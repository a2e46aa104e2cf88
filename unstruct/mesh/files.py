"""Meshes in files and in other libraries: Gmsh, Triangle, SU2, OpenFOAM, meshio's formats, scikit-fem.

Files keep points, cells, `origin`, `duplicates`, cell markers, and named faces (as cells of lower dimension
with the data "faces:<name>"), as far as the format can store them. See the book, chapter 1.
"""

from __future__ import annotations

import warnings
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ..base.arguments import positive
from ..base.errors import InputError, MeshError
from ..base.files import as_path, bytes_of, replacing, suffix_of
from ..base.optional import optional
from .complex import CellComplex
from .conversion import arguments_of, exchange_of, named_faces
from .exchange import Block, Exchange
from .foam import write_foam
from .formats import MAY_BE_DOMAINS, NEED_H5PY, NOT_MESHES, fits, meshio_options, refuse_options
from .gmsh import coded, face_blocks, to_groups
from .grouping import group_rows
from .medit import with_names, write_medit
from .msh import msh_version, read_msh
from .msh_writing import write_msh
from .naming import WITH_NAMES, add_names, names_by_number
from .node_ele import read_node_ele, write_node_ele
from .su2 import read_su2, write_su2

__all__ = ["read", "to_meshio", "to_skfem", "write"]

SKFEM_HEX = [0, 4, 3, 1, 7, 5, 2, 6]  # the corners of a hexahedron in the order of scikit-fem
WITH_DATA = {".vtu", ".vtk", ".msh", ".xdmf", ".xmf"}  # formats that keep data at points and cells
LINES_BEYOND = 10  # after so many empty answers a reader has not noticed that a file has ended
MESHIO_READS_MSH = ("4.0", "4")  # versions of Gmsh's format that are left to meshio


def to_meshio(mesh: CellComplex) -> Any:
    """The mesh as a `meshio.Mesh`.

    Returns
    -------
    meshio.Mesh
        Kinds without cells are left out. Polygons are grouped by their number of corners; if there are
        several groups, ``cell_data`` has the number of each cell as "polygon:number". ``point_data`` contains
        "origin" and "kept" (the vertex itself, or the vertex that it duplicates); ``cell_data`` contains the
        markers. Named faces follow as blocks of lower dimension; "faces:<name>" is 1 on them and 0 elsewhere.
        For a name of k vertices per face that has no faces, it is -k everywhere. ``field_data`` has the names
        of regions, each with its number and the dimension of cells, as meshio has those of Gmsh's groups.

    Warns
    -----
    UserWarning
        Of weights and of sides that match, for which there is no place; `.msh` files have one for the sides.
    """
    meshio = optional("meshio", "Mesh.to_meshio")
    _say_lost(mesh, "meshio.Mesh")
    other = exchange_of(mesh)
    return meshio.Mesh(
        other.points,
        list(other.cells),
        point_data=other.point_data,
        cell_data=other.cell_data,
        field_data=other.field_data,
    )


def write(
    mesh: CellComplex,
    path: str | Path,
    *,
    version: str | None = None,
    binary: bool | None = None,
    thickness: float | None = None,
) -> None:
    """Write a file; see `Mesh.write`.

    Raises
    ------
    InputError
        For a suffix that no format has, for meshes and options that a format does not have, and if the file
        cannot be written. What was there before is then still there.
    """
    path = as_path(path)
    suffix = suffix_of(path)
    _say_lost(mesh, path.name if path.name == "polyMesh" else suffix)
    if path.name == "polyMesh":
        refuse_options("polyMesh", version=version, binary=binary)
        _write_foam(mesh, path, thickness)
        return
    refuse_options(suffix, thickness=thickness)
    if suffix not in (".msh",):
        refuse_options(suffix, version=version)
    if suffix in (".node", ".ele", ".su2"):
        refuse_options(suffix, binary=binary)
    if suffix in (".node", ".ele"):
        _drop(mesh, ".node and .ele store points and cells only", mesh.markers)
        with replacing(path) as beside:
            write_node_ele(mesh, beside)
        return
    fits([kind for kind, block in mesh.cells.items() if len(block)], path)
    if suffix == ".su2":
        with replacing(path) as beside:
            lost = write_su2(mesh, beside)
        why = ".su2 stores for each facet of the boundary its first marker other than facets"
        _drop(mesh, why, lost, duplicates=True)
        return
    if suffix == ".mesh":
        refuse_options(suffix, binary=binary)
        with replacing(path) as beside:
            write_medit(_for_groups(mesh, ".mesh", data=False), beside)
        _drop(mesh, ".mesh has no place for them", (), duplicates=True)
        return
    if suffix == ".msh":
        if version not in (None, "2.2", "4.1"):
            raise InputError(f"version {version!r} of Gmsh's format is not written: '2.2' or '4.1' is")
        with replacing(path) as beside:
            write_msh(_for_groups(mesh, ".msh"), beside, version or "2.2", bool(binary))
        return
    _write_by_meshio(mesh, path, suffix, binary)


def _write_foam(mesh: CellComplex, path: Path, thickness: float | None) -> None:
    if thickness is not None:
        thickness = positive(thickness, "thickness")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {path}: {error.strerror or error}") from None
    with replacing(path / "points") as beside:
        lost = write_foam(mesh, beside.parent, thickness)
    why = "polyMesh stores for each face its first marker other than facets, and of cells their regions"
    _drop(mesh, why, lost, duplicates=True)


def _widened(values: np.ndarray) -> np.ndarray:
    return values.astype(np.int32) if values.dtype.itemsize < 4 else values


def _padded(points: np.ndarray) -> np.ndarray:
    """Most formats have three coordinates; a zero third one is dropped on reading."""
    return np.pad(points, ((0, 0), (0, max(3 - points.shape[1], 0))))


def _write_by_meshio(mesh: CellComplex, path: Path, suffix: str, binary: bool | None) -> None:
    meshio = optional("meshio", f"writing {suffix or path.name!r}")
    if suffix not in meshio.extension_to_filetypes:
        raise InputError(
            f"cannot write this mesh as {suffix!r}: no format has this suffix; there are polyMesh, .node, "
            f".msh, .su2, {', '.join(sorted(meshio.extension_to_filetypes))}"
        )
    options = meshio_options(suffix, binary)
    other = exchange_of(mesh)
    other.points = _padded(other.points)
    if suffix not in WITH_DATA:
        _drop(mesh, f"{suffix} stores points and cells only", mesh.markers)
        other.point_data, other.cell_data = {}, {}
        del other.cells[len(other.cells) - len(face_blocks(named_faces(mesh))) :]
    else:
        spaces = suffix == ".vtk"
        other.cell_data = {coded(name, spaces=spaces): v for name, v in other.cell_data.items()}
        _drop_whole(mesh)
        if suffix not in WITH_NAMES:
            _drop(mesh, f"{suffix} stores no names of regions", [f"region {name}" for name in mesh.regions])
    if suffix in (".xdmf", ".xmf"):  # it has no short integers
        other.cell_data = {name: [_widened(v) for v in part] for name, part in other.cell_data.items()}
    if suffix in NEED_H5PY and options.get("data_format") != "XML":
        optional("h5py", f"writing {suffix}")
    theirs = meshio.Mesh(
        other.points, list(other.cells), point_data=other.point_data, cell_data=other.cell_data
    )
    with replacing(path) as beside:
        try:
            theirs.write(beside, **options)
            if mesh.regions and suffix in WITH_NAMES:
                add_names(beside, mesh.regions)
        except OSError:
            raise
        except (Exception, SystemExit) as error:  # meshio raises many kinds for suffixes and cells alike
            raise InputError(f"meshio cannot write this mesh as {suffix!r}: {error}") from error


def _say_lost(mesh: CellComplex, what: str, names: Iterable[str] = ()) -> None:
    """Warn of what no format stores, or all but .msh do not, and of these markers."""
    lost = [*names] if mesh.weights is None else [*names, "weights"]
    lost += ["periodic"] if mesh.periodic and what != ".msh" else []
    if lost:
        warnings.warn(f"not written: {', '.join(map(repr, lost))}; {what} does not store them", stacklevel=4)


def _drop(mesh: CellComplex, why: str, names: Any, *, duplicates: bool = False) -> None:
    lost = [repr(name) for name in names]
    if len(mesh.duplicates) and (duplicates or names is mesh.markers):
        lost.append("duplicates")
    if lost:
        warnings.warn(f"not written: {', '.join(lost)}; {why}", stacklevel=4)


def _drop_whole(mesh: CellComplex) -> None:
    named = named_faces(mesh)
    whole = [name for name, rows in mesh.markers.items() if rows.ndim == 2 and name not in named]
    _drop(mesh, "markers of faces have 1 to 4 vertices, and lower dimension than the cells", whole)


def _for_groups(mesh: CellComplex, suffix: str, *, data: bool = True) -> Exchange:
    """Make regions and named faces physical groups; keep real data if there is only one block of cells."""
    other = exchange_of(mesh, flags=False)
    other.points = _padded(other.points)
    _drop_whole(mesh)
    faces = named_faces(mesh)
    values = dict(other.cell_data)
    held, lost = to_groups(mesh, other, faces)
    why = f"{suffix} stores each face in one group, that of its first marker other than facets and inner"
    _drop(mesh, why, lost)
    rest = [name for name in values if name not in held and not name.startswith("gmsh:")]
    if not data:
        vertices = [name for name, rows in faces.items() if rows.shape[1] == 1]
        _drop(mesh, f"{suffix} has one number for each cell and face, and names of regions", rest + vertices)
        rest = []
    elif len(other.cells) > 1:  # other programs take data of cells for data of all elements
        _drop(mesh, ".msh keeps other cell data only where there is one kind of cell and no named face", rest)
        rest = []
    other.point_data = {name: column.astype(float) for name, column in other.point_data.items()}
    other.cell_data |= {coded(name): [v.astype(float) for v in values[name]] for name in rest}
    return other


def read(path: str | Path) -> dict[str, Any]:
    """Read a file: the arguments of a `Mesh`; see `Mesh.read`.

    The cells of the highest dimension are the mesh; lower ones become markers. A third coordinate that is
    zero throughout is dropped if the cells are plane.
    """
    path = as_path(path)
    suffix = suffix_of(path)
    if suffix in (".node", ".ele"):
        return read_node_ele(path)
    if suffix == ".su2":
        return read_su2(path)
    if suffix == ".msh":
        version, sections, order = msh_version(path)
        if version in MESHIO_READS_MSH:
            return arguments_of(path, _read_by_meshio(path, "gmsh"))
        return arguments_of(path, read_msh(path, version, sections, order))
    other = _read_by_meshio(path, None)
    return arguments_of(path, with_names(path, other) if suffix == ".mesh" else other)


def _read_by_meshio(path: Path, file_format: str | None) -> Exchange:
    """The contents of a file as meshio reads it, without its messages on the screen."""
    suffix = suffix_of(path)
    data = bytes_of(path)
    if suffix in NOT_MESHES:
        raise InputError(f"{path.name} is no mesh: {NOT_MESHES[suffix]}")
    meshio = optional("meshio", f"reading {path.name}")
    if suffix not in meshio.extension_to_filetypes:
        raise InputError(
            f"{path.name} cannot be read: no format has the suffix {suffix!r}; there are .node, .msh, .su2, "
            f"{', '.join(sorted(meshio.extension_to_filetypes))}"
        )
    if suffix in NEED_H5PY and not (suffix in (".xdmf", ".xmf") and b'Format="HDF"' not in data):
        optional("h5py", f"reading {path.name}")
    said = StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said), _without_mark(path, data) as plain:
            if meshio.extension_to_filetypes[suffix] == ["tecplot"]:
                text = _EndingText(plain.read_text(encoding="utf-8"))
                other = meshio.read(text, file_format="tecplot")
            else:
                other = meshio.read(plain, file_format=file_format)
    except (Exception, SystemExit) as error:  # meshio exits on what it cannot read
        why = " ".join(said.getvalue().split()) if isinstance(error, SystemExit) else str(error)
        raise InputError(
            f"meshio cannot read {path.name} ({type(error).__name__}: {why}): is it whole, and in the format "
            f"that {suffix} stands for? {MAY_BE_DOMAINS.get(suffix, '')}".rstrip()
        ) from None
    blocks = [Block(block.type, np.asarray(block.data)) for block in other.cells]
    return Exchange(
        np.asarray(other.points, dtype=np.float64),
        blocks,
        dict(other.point_data),
        dict(other.cell_data),
        dict(other.field_data),
    )


class _EndingText(StringIO):
    """A text that raises EOFError when it is read on after its end: meshio's reader of Tecplot goes on."""

    beyond = 0

    def readline(self, size: int = -1, /) -> str:  # type: ignore[override]
        line = super().readline(size)
        self.beyond = 0 if line else self.beyond + 1
        if self.beyond > LINES_BEYOND:
            raise EOFError("it ends too early")
        return line


@contextmanager
def _without_mark(path: Path, data: bytes) -> Iterator[Path]:
    """The file itself, or a copy without its byte order mark, which meshio does not expect."""
    if not data.startswith(BOM_UTF8):
        yield path
        return
    with TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(data.removeprefix(BOM_UTF8))
        yield copy


# ---------------------------------------------------------------------- scikit-fem


def to_skfem(mesh: CellComplex) -> Any:
    """The mesh as a scikit-fem mesh; named facets become boundaries, cell markers subdomains.

    A boolean marker of cells is one subdomain; one of integers has a subdomain for each value: "region 2", or
    the name of that region.

    Warns
    -----
    UserWarning
        Of what has no place there: weights, sides that match, markers with real numbers and of vertices.
    """
    skfem = optional("skfem", "Mesh.to_skfem")
    kinds = {
        ("line", 1): "MeshLine",
        ("triangle", 2): "MeshTri",
        ("quad", 2): "MeshQuad",
        ("tetra", 3): "MeshTet",
        ("hexahedron", 3): "MeshHex",
    }
    name = next(iter(mesh.cells))
    kind = kinds.get((name, mesh.points.shape[1]))
    if len(mesh.cells) > 1 or kind is None:
        what = ", ".join(mesh.cells)
        raise MeshError(
            f"scikit-fem has no mesh for cells of kind {what} in {mesh.points.shape[1]} dimensions"
        )
    if mesh.size == 0:
        raise MeshError("scikit-fem has no mesh without cells")
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.cells[name]] = True
    number = np.cumsum(used) - 1
    number[~used] = -1
    cells = mesh.cells[name][:, SKFEM_HEX] if name == "hexahedron" else mesh.cells[name]
    result = getattr(skfem, kind)(mesh.points[used].T.copy(), number[cells].T.copy())
    boundaries, subdomains = _skfem_facets(mesh, result, number), {}
    lost = [
        marker
        for marker, values in mesh.markers.items()
        if (values.dtype.kind not in "biu" if values.ndim == 1 else marker not in boundaries)
    ]
    _say_lost(mesh, "scikit-fem", lost)
    for marker, values in mesh.markers.items():
        if values.ndim == 1 and values.dtype == bool:
            subdomains[marker] = np.nonzero(values)[0]
        elif values.ndim == 1 and values.dtype.kind in "iu":
            order = np.argsort(values, kind="stable")
            different, first = np.unique(values[order], return_index=True)
            called = names_by_number(mesh.regions) if marker == "region" else {}
            for value, part in zip(different.tolist(), np.split(order, first[1:])):
                subdomains[called.get(value, f"{marker} {value}")] = part
    if boundaries:
        result = result.with_boundaries(boundaries)
    return result.with_subdomains(subdomains) if subdomains else result


def _skfem_facets(mesh: CellComplex, theirs: Any, number: np.ndarray) -> dict[str, np.ndarray]:
    """The numbers that scikit-fem gives to the facets of each marker."""
    named = {
        name: number[rows]
        for name, rows in mesh.markers.items()
        if rows.ndim == 2 and rows.shape[1] == len(theirs.facets) and (rows >= 0).all()
    }
    if not named:
        return {}
    wanted = np.concatenate(list(named.values()))
    marked = np.zeros(theirs.p.shape[1] + 1, dtype=bool)  # the last entry belongs to -1, an unused vertex
    marked[wanted] = True
    near = np.flatnonzero(marked[theirs.facets].all(axis=0))  # few, so that nothing large is sorted
    group, first = group_rows(np.sort(np.concatenate([theirs.facets.T[near], wanted]), axis=1))
    place = first[group[len(near) :]]
    lost = place >= len(near)
    if lost.any():
        every = np.concatenate([mesh.markers[name] for name in named])
        raise MeshError(f"{every[int(np.argmax(lost))].tolist()} has a marker, but is not a facet of a cell")
    parts = np.split(near[place], np.cumsum([len(rows) for rows in named.values()])[:-1])
    return dict(zip(named, parts))
