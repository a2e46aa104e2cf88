"""Which kinds of cells a file format can store.

meshio converts other kinds, or leaves them out, with at most a message on the screen; here it is an error.
"""

from __future__ import annotations

from collections.abc import Sequence

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
    ".f3grid": SOLID,
    **dict.fromkeys([".mesh", ".meshb", ".su2", ".tec", ".dat", ".bdf"], ("line", *FLAT, *SOLID)),
    **dict.fromkeys([".msh", ".avs"], ("line", *FLAT, *SOLID)),
    ".inp": ("line", *FLAT, "tetra", "wedge", "hexahedron"),
}
ALONE = (".xml", ".tec", ".dat")  # these formats store cells of one kind only


def fits(kinds: Sequence[str], suffix: str) -> None:
    """Check that a format can store cells of these kinds unchanged.

    Raises
    ------
    InputError
        If it cannot; the message names the kinds.
    """
    known = WRITABLE_KINDS.get(suffix, tuple(kinds))
    lost = [name for name in kinds if name not in known]
    why = ""
    if lost:
        why = f"it stores cells of kind {', '.join(known)}, not {', '.join(lost)}"
    elif suffix in ALONE and len(kinds) > 1:
        why = f"it stores cells of one kind only, not {', '.join(kinds)}"
    if why:
        raise InputError(f"meshio cannot write this mesh as {suffix!r}: {why}; .vtu stores all")
