"""What a file or another library does not keep of a mesh, or not under its name: warnings that list it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..base.telling import tell, tell_renamed
from .complex import CellComplex

__all__ = ["drop", "say_lost", "say_renamed"]

CODED = "have codes for quotes, brackets and percent signs, which Mesh.read turns back"
PLAIN = "have letters, digits and _ - . + only, and are all different"
WORDS = PLAIN + "; they begin with a letter or _, and end after 200 characters"
BRIEF = "have at most 127 bytes"
WHY_RENAMED = {".su2": PLAIN, "polyMesh": WORDS, ".msh: long": BRIEF}


def say_lost(mesh: CellComplex, what: str, names: Iterable[str] = ()) -> None:
    """Warn of what no format stores, or all but .msh do not, and of these markers."""
    lost = [*names] if mesh.weights is None else [*names, "weights"]
    lost += ["periodic"] if mesh.periodic and what != ".msh" else []
    if lost:
        tell(f"not written: {', '.join(map(repr, lost))}; {what} does not store them")


def drop(mesh: CellComplex, why: str, names: Iterable[str], *, duplicates: bool = False) -> None:
    """Warn that these markers are not written, and where ``duplicates`` is set those are not, either."""
    lost = [repr(name) for name in names]
    if len(mesh.duplicates) and duplicates:
        lost.append("duplicates")
    if lost:
        tell(f"not written: {', '.join(lost)}; {why}")


def say_renamed(names: Mapping[str, str], what: str) -> None:
    """Warn of names that stand in a file as others."""
    tell_renamed(names, f"names in {what.partition(':')[0]} {WHY_RENAMED.get(what, CODED)}")
