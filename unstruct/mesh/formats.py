"""Which kinds of cells a file format can store.

meshio converts other kinds, or leaves them out, with at most a message on the screen, or writes what it
cannot read; here it is an error. A test writes and reads each kind in every format that meshio knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.errors import InputError

__all__ = ["fits"]

FLAT = ("triangle", "quad")
SOLID = ("tetra", "pyramid", "wedge", "hexahedron")
WRITABLE_KINDS: dict[str, tuple[str, ...]] = {
    ".stl": ("triangle",),
    ".off": ("triangle",),
    ".obj": (*FLAT, "polygon"),
    ".ply": (*FLAT, "polygon"),
    ".xml": ("triangle", "tetra"),
    ".wkt": ("triangle",),
    ".h5m": ("line", "triangle", "tetra"),
    ".cgns": ("tetra",),
    ".f3grid": ("tetra", "pyramid", "hexahedron"),  # meshio turns wedges inside out
    ".su2": SOLID,
    ".ugrid": (*FLAT, *SOLID),
    **dict.fromkeys([".tec", ".dat"], ("line", *FLAT, "tetra", "hexahedron")),
    **dict.fromkeys([".inp", ".mdpa"], ("line", *FLAT, "tetra", "wedge", "hexahedron")),
    **dict.fromkeys([".msh", ".avs", ".mesh", ".meshb", ".bdf", ".fem", ".nas"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".post", ".dato", ".vol", ".exo", ".e", ".ex2"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".med", ".xdmf", ".xmf", ".hmf"], ("line", *FLAT, *SOLID)),
}
ALONE = (".xml", ".tec", ".dat")  # these formats store cells of one kind only


def fits(kinds: Sequence[str], path: Path) -> None:
    """Check that a format can store cells of these kinds (those that have cells) unchanged.

    Raises
    ------
    InputError
        If it cannot; the message names the kinds.
    """
    suffix = path.suffix
    if not kinds:
        raise InputError(
            f"a mesh without cells cannot be written as {suffix!r}; .node and .ele store one of simplices"
        )
    if suffix == ".ugrid" and len(path.suffixes) < 2:
        raise InputError(f"meshio cannot read .ugrid as text: call the file {path.stem}.lb8.ugrid")
    known = WRITABLE_KINDS.get(suffix, tuple(kinds))
    lost = [name for name in kinds if name not in known]
    why = ""
    if lost:
        why = f"it stores cells of kind {', '.join(known)}, not {', '.join(lost)}"
    elif suffix in ALONE and len(kinds) > 1:
        why = f"it stores cells of one kind only, not {', '.join(kinds)}"
    if why:
        raise InputError(f"meshio cannot write this mesh as {suffix!r}: {why}; .vtu stores all")
