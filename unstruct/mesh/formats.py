"""Which kinds of cells a file can hold: some formats make something else of others, or leave them out.

meshio says so on the screen at most; here it is an error.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..base.errors import InputError

__all__ = ["fits"]

FLAT = ("triangle", "quad")
SOLID = ("tetra", "pyramid", "wedge", "hexahedron")
KINDS: dict[str, tuple[str, ...]] = {
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
ALONE = (".xml", ".tec", ".dat")  # they hold cells of one kind only


def fits(kinds: Sequence[str], suffix: str) -> None:
    """See whether a format holds cells of these kinds as they are.

    Raises
    ------
    InputError
        Where it does not; the message names the kinds.
    """
    known = KINDS.get(suffix, tuple(kinds))
    lost = [name for name in kinds if name not in known]
    why = ""
    if lost:
        why = f"it holds cells of kind {', '.join(known)}, not {', '.join(lost)}"
    elif suffix in ALONE and len(kinds) > 1:
        why = f"it holds cells of one kind only, not {', '.join(kinds)}"
    if why:
        raise InputError(f"meshio cannot write this mesh as {suffix!r}: {why}; .vtu holds all")
