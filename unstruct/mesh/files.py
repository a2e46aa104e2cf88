"""Meshes in files and in other libraries: Gmsh, Triangle, SU2, OpenFOAM, meshio's formats, scikit-fem.

Files keep points, cells, `origin`, `duplicates`, cell markers, and named faces (as cells of lower dimension
with the data "faces:<name>"), as far as the format can store them. See the book, chapter 1.
"""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from copy import copy
from functools import partial
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ..base.arguments import positive
from ..base.errors import InputError
from ..base.files import as_path, bytes_of, replacing, suffix_of
from ..base.optional import optional
from .accounts import drop, say_lost, say_renamed
from .complex import CellComplex
from .conversion import arguments_of, blocks_of, exchange_of, named_faces
from .exchange import Block, Exchange
from .fields import WITH_FIELDS, Fields, add_fields, as_fields, padded_fields
from .foam import write_foam
from .formats import (
    MAY_BE_DOMAINS,
    NEED_PACKAGE,
    NOT_MESHES,
    as_stored,
    fits,
    meshio_options,
    positional,
    refuse_options,
)
from .gmsh import brief, coded, decoded, face_blocks, to_groups
from .medit import with_names, write_medit
from .msh import msh_version, read_msh
from .msh_writing import write_msh
from .naming import WITH_NAMES, add_names
from .node_ele import read_node_ele, write_node_ele
from .scikit import to_skfem
from .su2 import read_su2, write_su2

__all__ = ["meant", "read", "to_meshio", "to_skfem", "write"]

LINES_BEYOND = 10  # after so many empty answers a reader has not noticed that a file has ended
OWN_SUFFIXES = (".msh", ".su2", ".mesh", ".node", ".ele")  # formats that are written without meshio
EXPONENTIAL = rb"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+"
XDMF = (".xdmf", ".xmf")
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
    say_lost(mesh, "meshio.Mesh")
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
    point_data: Mapping[str, Any] | None = None,
    cell_data: Mapping[str, Any] | None = None,
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
    fields = as_fields(mesh, point_data, cell_data)
    if path.name == "polyMesh" or suffix not in WITH_FIELDS:
        what = "polyMesh" if path.name == "polyMesh" else suffix
        refuse_options(what, point_data=fields.points or None, cell_data=fields.cells or None)
    say_lost(mesh, path.name if path.name == "polyMesh" else suffix)
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
        drop(mesh, ".node and .ele store points and cells only", mesh.markers, duplicates=True)
        with replacing(path) as beside:
            write_node_ele(mesh, beside)
        return
    fits([kind for kind, block in mesh.cells.items() if len(block)], path)
    if suffix == ".su2":
        with replacing(path) as beside:
            lost, names = write_su2(mesh, beside)
        say_renamed(names, suffix)
        why = ".su2 stores for each facet of the boundary its first marker other than facets"
        drop(mesh, why, lost, duplicates=True)
        return
    if suffix == ".mesh":
        refuse_options(suffix, binary=binary)
        with replacing(path) as beside:
            write_medit(_for_groups(mesh, ".mesh"), beside)
        drop(mesh, ".mesh has no place for them", (), duplicates=True)
        return
    if suffix == ".msh":
        if version not in (None, "2.2", "4.1"):
            raise InputError(f"version {version!r} of Gmsh's format is not written: '2.2' or '4.1' is")
        groups = _for_groups(*_with_brief_names(mesh, fields))
        if version is None:  # meshio does not open files of version 2.2 with data of several blocks of cells
            version = "4.1" if fields.cells and len(groups.cells) > 1 else "2.2"
        with replacing(path) as beside:
            write_msh(groups, beside, version, bool(binary))
        return
    _write_by_meshio(mesh, path, suffix, binary, fields)


def _write_foam(mesh: CellComplex, path: Path, thickness: float | None) -> None:
    if thickness is not None:
        thickness = positive(thickness, "thickness")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {path}: {error.strerror or error}") from None
    with replacing(path / "points") as beside:
        lost, names = write_foam(mesh, beside.parent, thickness)
    say_renamed(names, "polyMesh")
    why = "polyMesh stores for each face its first marker other than facets, and of cells their regions"
    drop(mesh, why, lost, duplicates=True)


def _widened(values: np.ndarray) -> np.ndarray:
    return values.astype(np.int32) if values.dtype.itemsize < 4 else values


def _padded(points: np.ndarray) -> np.ndarray:
    """Most formats have three coordinates; a zero third one is dropped on reading."""
    return np.pad(points, ((0, 0), (0, max(3 - points.shape[1], 0))))


def _write_by_meshio(mesh: CellComplex, path: Path, suffix: str, binary: bool | None, fields: Fields) -> None:
    meshio = _meshio_for(path)
    options = meshio_options(suffix, binary)
    if suffix in XDMF:
        mesh = _without_vertices(mesh, suffix)
    other = exchange_of(mesh)
    other.points = as_stored(_padded(other.points), suffix)
    if suffix not in WITH_FIELDS:
        drop(mesh, f"{suffix} stores points and cells only", mesh.markers, duplicates=True)
        other.point_data, other.cell_data = {}, {}
        del other.cells[len(other.cells) - len(face_blocks(named_faces(mesh))) :]
    else:
        add_fields(other, fields, blocks_of(mesh)[1])
        codes = partial(coded, spaces=suffix == ".vtk")
        other.point_data = {codes(name): v for name, v in other.point_data.items()}
        other.cell_data = {codes(name): v for name, v in other.cell_data.items()}
        _drop_whole(mesh)
        if suffix != ".vtk":  # VTK itself has these codes
            names = [*mesh.markers, *fields.points, *fields.cells]
            say_renamed({name: codes(name) for name in names}, suffix)
    if suffix in XDMF:  # it has no short integers
        other.point_data = {name: _widened(v) for name, v in other.point_data.items()}
        other.cell_data = {name: [_widened(v) for v in part] for name, part in other.cell_data.items()}
    if suffix in NEED_PACKAGE and options.get("data_format") != "XML":
        optional(NEED_PACKAGE[suffix], f"writing {suffix}")
    theirs = meshio.Mesh(
        other.points, list(other.cells), point_data=other.point_data, cell_data=other.cell_data
    )
    with replacing(path) as beside:
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                theirs.write(beside, **options)
            if mesh.regions and suffix in WITH_NAMES:
                add_names(beside, mesh.regions)
        except OSError:
            raise
        except (Exception, SystemExit) as error:  # meshio raises many kinds for suffixes and cells alike
            why = f"{type(error).__name__}: {error}".removesuffix(": ")
            raise InputError(
                f"meshio cannot write this mesh as {suffix!r} ({why}); .vtu stores all"
            ) from error


def _meshio_for(path: Path) -> Any:
    """meshio, if it has a format of this suffix."""
    suffix = suffix_of(path)
    meshio = optional("meshio", f"writing {suffix or path.name!r}")
    if suffix not in meshio.extension_to_filetypes:
        raise InputError(
            f"cannot write this mesh as {suffix!r}: no format has this suffix; there are polyMesh, .node, "
            f".msh, .su2, {', '.join(sorted(meshio.extension_to_filetypes))}"
        )
    return meshio


def meant(path: Path) -> None:
    """An error for a file that no mesh can be written to, before much time is spent on the mesh.

    Raises
    ------
    InputError
        For a suffix that no format has, and a folder that does not exist.
    """
    if path.name != "polyMesh" and suffix_of(path) not in OWN_SUFFIXES:
        _meshio_for(path)
    if not path.parent.is_dir():
        raise InputError(f"cannot write {path}: there is no folder {path.parent}; make it first")


def _drop_whole(mesh: CellComplex) -> None:
    named = named_faces(mesh)
    whole = [name for name, rows in mesh.markers.items() if rows.ndim == 2 and name not in named]
    drop(mesh, "markers of faces have 1 to 4 vertices, and lower dimension than the cells", whole)


def _without_vertices(mesh: CellComplex, suffix: str) -> CellComplex:
    """The mesh without its markers of vertices: meshio writes such blocks, and cannot read the file then."""
    vertices = [name for name, rows in named_faces(mesh).items() if rows.shape[1] == 1 and len(rows)]
    if vertices:
        drop(mesh, f"meshio cannot read single vertices in {suffix}; .vtu stores all", vertices)
        mesh = copy(mesh)
        mesh.markers = {name: rows for name, rows in mesh.markers.items() if name not in vertices}
    return mesh


def _with_brief_names(mesh: CellComplex, fields: Fields) -> tuple[CellComplex, str, Fields]:
    """The mesh and fields with names that Gmsh can read; most have such."""
    names = brief([*mesh.markers, *mesh.regions, *fields.points, *fields.cells])
    if any(name != word for name, word in names.items()):
        say_renamed(names, ".msh: long")
        mesh = copy(mesh)
        mesh.markers = {names[name]: values for name, values in mesh.markers.items()}
        mesh.regions = {names[name]: number for name, number in mesh.regions.items()}
        fields = fields.renamed(names.__getitem__)
    return mesh, ".msh", fields


def _for_groups(mesh: CellComplex, suffix: str, fields: Fields | None = None) -> Exchange:
    """Make regions and named faces physical groups; keep real data if there is only one block of cells."""
    other = exchange_of(mesh, flags=False)
    other.points = _padded(other.points)
    _drop_whole(mesh)
    faces = named_faces(mesh)
    values = dict(other.cell_data)
    held, lost = to_groups(mesh, other, faces)
    why = f"{suffix} stores each face in one group, that of its first marker other than facets and inner"
    drop(mesh, why, lost)
    rest = [name for name in values if name not in held and not name.startswith("gmsh:")]
    if fields is None:
        vertices = [name for name, rows in faces.items() if rows.shape[1] == 1]
        drop(mesh, f"{suffix} has one number for each cell and face, and names of regions", rest + vertices)
        rest = []
    elif len(other.cells) > 1:  # other programs take data of cells for data of all elements
        drop(mesh, ".msh keeps other cell data only where there is one kind of cell and no named face", rest)
        rest = []
    other.point_data = {name: column.astype(float) for name, column in other.point_data.items()}
    other.cell_data |= {coded(name): [v.astype(float) for v in values[name]] for name in rest}
    if fields is not None:
        add_fields(other, padded_fields(fields).renamed(coded), blocks_of(mesh)[1])
        more = {name: coded(name) for name in [*rest, *fields.points, *fields.cells]}
        groups = {decoded(name): name for name in other.field_data if name != decoded(name)}
        say_renamed(groups | more, suffix)
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
    if suffix in NEED_PACKAGE and not (suffix in XDMF and b'Format="HDF"' not in data):
        optional(NEED_PACKAGE[suffix], f"reading {path.name}")
    said = StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said), _as_expected(path, data) as plain:
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
def _as_expected(path: Path, data: bytes) -> Iterator[Path]:
    """The file itself, or a copy without what meshio does not expect: byte order marks, exponents in .wkt."""
    plain = data.removeprefix(BOM_UTF8)
    if suffix_of(path) == ".wkt":
        plain = re.sub(EXPONENTIAL, lambda found: positional(found[0]), plain)
    if plain is data or plain == data:
        yield path
        return
    with TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(plain)
        yield copy
