"""What files hold of a mesh: points, blocks of cells and data, under the names that meshio has for them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..base.arrays import distinct
from ..base.errors import InputError
from .complex import CellComplex
from .grouping import group_rows
from .periodic import Periodic

__all__ = ["Block", "Exchange", "border_groups", "plain_names", "rows_in_runs"]


class Block(NamedTuple):
    """Cells of one kind.

    Attributes
    ----------
    type : str
        By meshio's names; "vertex" is a point.
    data : ndarray of int, shape (m, k)
    """

    type: str
    data: np.ndarray


@dataclass
class Exchange:
    """A mesh as files have it; `meshio.Mesh` has attributes of the same names.

    Attributes
    ----------
    points : ndarray, shape (n, d)
    cells : list of Block
    point_data : dict of str to ndarray
    cell_data : dict of str to list of ndarray
        One array for each block.
    field_data : dict of str to ndarray
        Name of a physical group -> (number, dimension).
    sets : dict of str to list of ndarray of bool
        Further groups of cells, which may overlap, an array for each block.
    middles : ndarray of int or None
        Nodes of cells of higher order that are no corners.
    periodic : tuple of Periodic
        Sides that match, as the mesh has them, to be written.
    links : list
        Sides that match, as a file has them: `msh_periodic.Link`.
    """

    points: np.ndarray
    cells: list[Any]
    point_data: dict[str, np.ndarray] = field(default_factory=dict)
    cell_data: dict[str, list[np.ndarray]] = field(default_factory=dict)
    field_data: dict[str, np.ndarray] = field(default_factory=dict)
    sets: dict[str, list[np.ndarray]] = field(default_factory=dict)
    middles: np.ndarray | None = None
    periodic: tuple[Periodic, ...] = ()
    links: list[Any] = field(default_factory=list)


def rows_in_runs(
    flat: np.ndarray, count: int, key: slice, width: Callable[[np.ndarray], int], what: str
) -> Iterator[np.ndarray]:
    """Cut a list of numbers into rows whose lengths follow from some of their entries.

    Parameters
    ----------
    flat : ndarray, shape (k,)
    count : int
        The number of rows.
    key : slice
        The entries of a row on which its length depends.
    width : function (ndarray) -> int
        The length of a row by these entries.
    what : str
        What a row is, for errors.

    Yields
    ------
    ndarray, shape (r, w)
        As many successive rows of equal key as there are. O(k) and a few microseconds for each change.
    """
    at, row, window = 0, 0, 16
    while row < count:
        head = flat[at + key.start : at + key.stop]
        if len(head) < key.stop - key.start:
            raise InputError(f"{count} {what} are announced, but there are {row}")
        size = width(head)
        many = min(window, count - row, (len(flat) - at) // size)
        if many == 0:
            raise InputError(f"{what} number {row + 1} of {count} is incomplete")
        rows = flat[at : at + many * size].reshape(many, size)
        same = (rows[:, key] == head).all(axis=1)
        good = many if same.all() else int(np.argmin(same))
        yield rows[:good]
        at, row = at + good * size, row + good
        window = 2 * window if good == many else 16
    if at != len(flat):
        raise InputError(f"{count} {what} are announced, but more numbers follow")


def plain_names(
    names: Iterable[str], *, taken: Iterable[str] = (), words: bool = False, most: int | None = None
) -> dict[str, str]:
    """Names as configuration files of solvers can use them: letters, digits, _ - . + only; all different.

    Those that are of this kind stay, so that others which become like one of them get a number.

    Parameters
    ----------
    names : iterable of str
    taken : iterable of str
        Names that are used already.
    words : bool
        Whether they must begin with a letter or _; otherwise "_" is put before them.
    most : int, optional
        The largest number of characters.
    """
    plain = {name: re.sub(r"[^\w.+-]+", "_", name)[:most] or "_" for name in names}
    if words:
        plain = {
            name: word if re.match(r"[^\W\d]", word) else f"_{word}"[:most] for name, word in plain.items()
        }
    used = set(taken)
    kept = {name for name, word in plain.items() if name == word and name not in used}
    used |= kept
    found: dict[str, str] = {}
    for name, first in plain.items():
        word, count = first, 2
        while name not in kept and word in used:
            end = f"_{count}"
            word, count = (first if most is None else first[: most - len(end)]) + end, count + 1
        found[name] = word
        used.add(word)
    return found


def border_groups(mesh: CellComplex, border: np.ndarray) -> tuple[dict[str, np.ndarray], list[str]]:
    """Give each of some facets to one marker: the first other than "facets" that names it, "inner" last.

    Parameters
    ----------
    mesh : Mesh
    border : ndarray of int, shape (f, k)
        Facets, such as those where the mesh ends, padded by -1.

    Returns
    -------
    groups : dict of str to ndarray of int
        Name -> rows of ``border``, none empty; "facets" has those that no other marker names.
    lost : list of str
        Markers that name other faces too, or faces that are in an earlier group, or nothing; and markers of
        cells.
    """
    width = border.shape[1]
    owner = np.full(len(border), -1)
    names: list[str] = []
    lost = []
    wide: list[np.ndarray] = []
    for name, faces in sorted(mesh.markers.items(), key=lambda item: item[0] == "inner"):
        if faces.ndim == 1:
            lost.append(name)
        elif name != "facets" and (name != "inner" or len(faces)):
            if faces.shape[1] > width or len(faces) == 0:
                lost.append(name)
                continue
            padded = np.full((len(faces), width), -1)
            padded[:, : faces.shape[1]] = faces
            wide.append(padded)
            names.append(name)
    group, first = group_rows(np.sort(np.concatenate([border, *wide]), axis=1))  # of all names at once
    of = np.repeat(np.arange(len(names)), [len(rows) for rows in wide])
    place = first[group[len(border) :]]
    inside = place < len(border)
    owner[place[inside][::-1]] = of[inside][::-1]  # the first name is assigned last
    other = ~inside
    other[inside] = owner[place[inside]] != of[inside]
    lost += [names[i] for i in distinct(of[other])]
    order = np.argsort(owner, kind="stable")
    parts = np.split(order, np.searchsorted(owner[order], np.arange(len(names) + 1)))
    groups = dict(zip(names, parts[1:])) | {"facets": parts[0]}
    gone = set(lost)
    return {name: rows for name, rows in groups.items() if len(rows)}, [n for n in mesh.markers if n in gone]
