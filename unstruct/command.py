"""The command ``unstruct``: mesh a region or a body, check, describe and convert files, from a shell.

Exit codes: 0, all is well; 1, the mesh is not all that was asked for, or the check found faults; 2, wrong
options, or a file that cannot be read or written.
"""

from __future__ import annotations

import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import click
import numpy as np

from .assess.check import check as check_mesh
from .base.errors import DomainError, IncompleteWarning, UnstructError
from .base.files import suffix_of
from .domain.domain import Domain
from .domain.plane.sources import REGION_SUFFIXES
from .domain.space.formats.writing import BODY_FORMATS
from .domain.space.sources import BODY_SUFFIXES
from .generate.bodies.tetrahedralize import tetrahedralize
from .generate.boundary.conforming import conforming_delaunay
from .generate.boundary.constrained import constrained_delaunay
from .generate.centers.circumcenters import circumcenter_insertion
from .generate.front.advancing_front import advancing_front
from .generate.front.delaunay_front import front_delaunay
from .generate.rebay.voronoi_segment import voronoi_segment
from .generate.refinement.refine import refine
from .mesh.files import meant
from .mesh.mesh import Mesh

__all__ = ["main"]

ONLY_REGIONS = tuple(suffix for suffix in REGION_SUFFIXES if suffix != ".node")
MESHERS: dict[str, Any] = {
    "refine": refine,
    "voronoi-segment": voronoi_segment,
    "advancing-front": advancing_front,
    "front-delaunay": lambda domain, size, **rest: front_delaunay(domain, size, finish=True, **rest),
    "circumcenter-insertion": circumcenter_insertion,
    "conforming-delaunay": conforming_delaunay,
    "constrained-delaunay": constrained_delaunay,
    "tetrahedralize": tetrahedralize,
}
TAKES = {  # which options a method has
    "refine": {
        "size",
        "min_angle",
        "max_area",
        "radius_edge",
        "max_volume",
        "min_dihedral",
        "split_boundary",
    },
    "voronoi-segment": {"size"},
    "advancing-front": {"size"},
    "front-delaunay": {"size"},
    "circumcenter-insertion": {"size"},
    "conforming-delaunay": {"size"},
    "constrained-delaunay": {"hull"},
    "tetrahedralize": {"size", "split_boundary"},
}
GIVEN = ("size", "min_angle", "max_area", "radius_edge", "max_volume", "min_dihedral", "split_boundary")
NEEDS_SIZE = ("voronoi-segment", "advancing-front", "front-delaunay", "circumcenter-insertion")
NOT_WELL, WRONG_USE = 1, 2


class _WrongInput(click.ClickException):
    """Told in one line, with exit code 2."""

    exit_code = WRONG_USE


class _Commands(click.Group):
    """Commands that tell errors of the library in one line."""

    def invoke(self, context: click.Context) -> Any:
        with warnings.catch_warnings():
            warnings.showwarning = _say_warning
            warnings.simplefilter("ignore", IncompleteWarning)  # `mesh` tells it at the end, with its reasons
            try:
                return super().invoke(context)
            except UnstructError as error:
                raise _WrongInput(_as_options(str(error))) from error


def _as_options(text: str) -> str:
    """A text that names arguments of functions, with the options of the command."""
    return text.replace("resolve=True", "--resolve").replace("split_boundary=True", "--split-boundary")


def _say_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    click.echo(f"Warning: {message}", err=True)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="unstruct", prog_name="unstruct")
def main() -> None:
    """Mesh planar regions and bodies in space; check, describe and convert meshes.

    Exit codes: 0, all is well; 1, the mesh is not all that was asked for, or the check found faults; 2, wrong
    options, or a file that cannot be read or written.
    """


_source = click.argument("source", type=click.Path(path_type=Path))
_region_options = [
    click.option("--resolve", is_flag=True, help="Repair the region instead of refusing it."),
    click.option(
        "--names", metavar="PROPERTY", help="The property that names features (GeoJSON, Shapefile)."
    ),
    click.option(
        "--shape",
        type=click.Choice(["spline", "polygon"]),
        default="spline",
        show_default=True,
        help="How an airfoil's points are joined.",
    ),
]
_file_options = [
    click.option("--gmsh-version", type=click.Choice(["2.2", "4.1"]), help="For .msh; 2.2 by default."),
    click.option("--binary/--text", default=None, help="For .msh, .vtu, .vtk, .stl, .ply, .xdmf."),
    click.option("--thickness", type=float, help="Of the layer over a planar mesh, for a folder polyMesh."),
]
_quiet = click.option("-q", "--quiet", is_flag=True, help="Print nothing but warnings and errors.")


def _with(options: list[Any]) -> Any:
    def add(function: Any) -> Any:
        for option in reversed(options):
            function = option(function)
        return function

    return add


@main.command()
@_source
@click.option("-o", "--output", required=True, type=click.Path(path_type=Path), help="The file to write.")
@click.option("--size", type=float, help="The wanted edge length.")
@click.option(
    "--method",
    type=click.Choice(list(MESHERS)),
    help="How to mesh: by default refine, and tetrahedralize for bodies.",
)
@click.option("--min-angle", type=float, help="The least angle of triangles in degrees; for refine.")
@click.option("--max-area", type=float, help="The largest area of a triangle; for refine.")
@click.option("--min-dihedral", type=float, help="The least angle between faces of a body; for refine.")
@click.option("--max-volume", type=float, help="The largest volume of a tetrahedron; for refine.")
@click.option("--radius-edge", type=float, help="The largest radius over shortest edge; for refine.")
@click.option(
    "--split-boundary/--keep-boundary",
    default=None,
    help="Divide given segments and facets, or keep them; for refine and tetrahedralize.",
)
@click.option("--hull", is_flag=True, help="Mesh the convex hull; for constrained-delaunay.")
@_with(_region_options)
@_with(_file_options)
@click.option("--progress/--no-progress", default=None, help="A progress bar; by default on a terminal.")
@_quiet
def mesh(
    source: Path, output: Path, method: str | None, quiet: bool, progress: bool | None, **options: Any
) -> None:
    """Mesh the region in SOURCE: .poly, .geojson, .wkt, .shp, or an airfoil's .dat.

    SOURCE may also be a planar mesh of triangles, which is refined, or the surface of a body (.stl, .off,
    .ply, .obj, .smesh, .poly), which is filled with tetrahedra.
    """
    meant(output)
    found = _read(source, options)
    solid = isinstance(found, Domain) and found.dimension == 3
    given = {name: options[name] for name in GIVEN if options[name] is not None}
    if method is None:  # limits of shape are those of refine
        method = "tetrahedralize" if solid and not given.keys() - TAKES["tetrahedralize"] else "refine"
    given |= {"hull": True} if options["hull"] else {}
    for name in given:
        if name not in TAKES[method]:
            takers = ", ".join(other for other, some in TAKES.items() if name in some)
            raise click.UsageError(f"{method} has no option --{name.replace('_', '-')}; it is for {takers}")
    if method in NEEDS_SIZE and "size" not in given:
        raise click.UsageError(f"{method} needs --size")
    if isinstance(found, Mesh) and method != "refine":
        raise click.UsageError(f"{source.name} is a mesh; only refine takes one, {method} takes a region")
    show = sys.stderr.isatty() and not quiet if progress is None else progress
    result = MESHERS[method](found, **given, progress=show)
    _write(result, output, options)
    if not quiet:
        solid = result.dimension == 3
        kind, what = ("min_dihedral", "minimum dihedral angle") if solid else ("min_angle", "minimum angle")
        angle = f", {what} {result.quality(kind).min():.4g} degrees" if result.size else ""
        cells = "tetrahedra" if solid else "triangles"
        click.echo(f"{output}: {len(result.points)} points, {result.size} {cells}{angle}")
    if not getattr(result, "complete", True):
        reasons = Counter(str(reason) or "not reached" for reason in result.reasons)
        click.echo(f"Not complete: {len(result.unrefined)} cells are not as asked for", err=True)
        for reason, count in reasons.most_common(5):
            click.echo(f"  {count}: {_as_options(reason)}", err=True)
        sys.exit(NOT_WELL)


@main.command()
@_source
@click.option("--domain", type=click.Path(path_type=Path), help="The region that the mesh should fill.")
@click.option("--delaunay", is_flag=True, help="Check empty circles, too.")
@_with(_region_options)
@_quiet
def check(source: Path, domain: Path | None, delaunay: bool, quiet: bool, **options: Any) -> None:
    """Check the mesh in SOURCE exactly: orientation, neighbors, overlaps, and what else a mesh must be.

    A surface (.stl, .off, .ply, .obj, .smesh) is checked as a body in space, and what else is no mesh as a
    region: is it closed, does it cross itself?
    """
    if suffix_of(source) in (*BODY_SUFFIXES, *ONLY_REGIONS) and domain is None and not delaunay:
        body, faults = _body(source, options)
        if not quiet or faults:
            click.echo(f"sound: {_closed(body)}" if not faults else _told(source, faults))
        if faults:
            sys.exit(NOT_WELL)
        return
    found = Mesh.read(source)
    region = None if domain is None else _domain(domain, options)
    report = check_mesh(found, domain=region, delaunay=delaunay)
    if not quiet or not report:
        click.echo(str(report))
    if not report:
        sys.exit(NOT_WELL)


@main.command()
@_source
@_with(_region_options)
def info(source: Path, **options: Any) -> None:
    """Describe the mesh, the region or the body in SOURCE: counts, size, quality, names.

    Of a body (.stl, .off, .ply, .obj, .smesh) the faults are listed, too; then the exit code is 1.
    """
    if suffix_of(source) in BODY_SUFFIXES:
        _describe_body(source, options)
        return
    found = _read(source, options)
    if isinstance(found, Domain) and found.dimension == 3:
        _describe_body(source, options)
        return
    if isinstance(found, Domain):
        low, high = found.bounds if len(found.points) else np.zeros((2, 2))
        click.echo(f"{source.name}: a region")
        click.echo(
            f"points {len(found.points)}, facets {len(found.facets)}, inner segments {len(found.inner)}"
        )
        click.echo(f"area {found.area:.6g}, from {low.tolist()} to {high.tolist()}")
        for name, pieces in found.markers.items():
            click.echo(f"marker {name!r}: {len(pieces)} pieces")
        for name, seeds in found.regions.items():
            click.echo(f"region {name!r}: {len(seeds)} seeds")
        for repair in found.repairs:
            click.echo(f"repaired: {repair.text}")
        return
    click.echo(f"{source.name}: a mesh")
    click.echo(str(found.summary()))
    for name, values in found.markers.items():
        what = f"{len(values)} faces" if values.ndim == 2 else "a value for each cell"
        click.echo(f"marker {name!r}: {what}")


@main.command()
@_source
@click.argument("target", type=click.Path(path_type=Path))
@_with(_region_options)
@_with(_file_options)
@_quiet
def convert(source: Path, target: Path, quiet: bool, **options: Any) -> None:
    """Write the mesh or the region in SOURCE to TARGET, in the format of its suffix.

    Regions are written as .poly, bodies as .stl, .off, .ply, .obj, .smesh or .poly. A surface that is no
    body (it is open, or crosses itself) is converted as a mesh, and so is each to another format.
    """
    try:
        found = _read(source, options, solid=suffix_of(target) in BODY_FORMATS)
    except DomainError:
        if suffix_of(source) not in BODY_SUFFIXES or suffix_of(target) in (".smesh", ".poly"):
            raise
        found = Mesh.read(source)
    if isinstance(found, Domain) and found.dimension == 2 and suffix_of(target) != ".poly":
        raise click.UsageError(
            f"{source.name} is a region, which is written as .poly; 'unstruct mesh' meshes it"
        )
    _write(found, target, options)
    if not quiet:
        click.echo(f"{target}: {found!r}".replace("<", "").replace(">", ""))


def _read(path: Path, options: dict[str, Any], *, region: bool | None = None, solid: bool = True) -> Any:
    """A domain or a mesh, by the suffix; .node is a mesh unless a region is wanted.

    A surface is a body if ``solid``; one that is flat, or that has faults where a mesh will do, is a mesh.
    """
    suffix = suffix_of(path)
    surface = suffix in BODY_SUFFIXES and suffix != ".smesh"
    if region or (suffix in ONLY_REGIONS or suffix == ".smesh") or (surface and solid):
        try:
            return _domain(path, options)
        except DomainError as error:
            points = np.asarray(error.outline.points)
            if region or not surface or not (points.shape[1] == 3 and np.ptp(points[:, 2]) == 0):
                raise
    return Mesh.read(path)


def _domain(path: Path, options: dict[str, Any]) -> Domain:
    return Domain.read(path, resolve=options["resolve"], name=options["names"], shape=options["shape"])


def _body(path: Path, options: dict[str, Any]) -> tuple[Any, list[Any]]:
    """A region or body and its faults; of one with faults only what bounds it."""
    try:
        return _domain(path, options), []
    except DomainError as error:
        return error.outline, list(error.faults)


def _closed(body: Any) -> str:
    if not len(body.facets):
        return "no facets"
    return f"closed, area {body.area:.6g}" if body.dimension == 2 else f"closed, volume {body.volume:.6g}"


def _told(path: Path, faults: list[Any]) -> str:
    """The faults by their kinds, with the first of each."""
    kinds = Counter(fault.kind for fault in faults)
    first = {fault.kind: fault.text for fault in reversed(faults)}
    lines = [f"{path.name} has {len(faults)} faults"]
    return "\n".join(lines + [f"  {kind}, {count} times: {first[kind]}" for kind, count in kinds.items()])


def _describe_body(path: Path, options: dict[str, Any]) -> None:
    body, faults = _body(path, options)
    points = body.points
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else np.zeros((2, 3))
    click.echo(f"{path.name}: a body in space")
    click.echo(f"points {len(points)}, facets {len(body.facets)}, inner pieces {len(body.inner)}")
    click.echo(f"from {low.tolist()} to {high.tolist()}")
    if not faults:
        click.echo(_closed(body))
    for name, pieces in body.markers.items():
        click.echo(f"marker {name!r}: {len(pieces)} pieces")
    for name, seeds in body.regions.items():
        click.echo(f"region {name!r}: {len(seeds)} seeds")
    for repair in getattr(body, "repairs", []):
        click.echo(f"repaired: {repair.text}")
    if faults:
        click.echo(_told(path, faults))
        sys.exit(NOT_WELL)


def _write(found: Any, path: Path, options: dict[str, Any]) -> None:
    if isinstance(found, Domain):
        found.write(path, binary=options.get("binary"))
        return
    found.write(
        path,
        version=options.get("gmsh_version"),
        binary=options.get("binary"),
        thickness=options.get("thickness"),
    )
