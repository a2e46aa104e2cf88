"""Files damaged at random: read as what they then say, or refused by an `UnstructError`."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from unstruct import Domain, UnstructError

WORDS = [
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e400",
    b"9" * 20,
    b"",
    b"x",
    b"\0",
    b"\xff",
    b"3 3",
    b"\n",
    b"#",
    b"2",
]
FRAME = Domain.polygon(
    [(0, 0), (4, 0), (4, 4), (0, 4)],
    [[(1, 1), (2, 1), (2, 2), (1, 2)]],
    markers={"a": [0]},
    regions={"r": (0.5, 0.5)},
)


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Cut off, with other bytes or another word, or with a line that is lost or comes twice."""
    kind = int(rng.integers(5))
    if kind == 0:
        return data[: rng.integers(len(data))]
    if kind == 1:
        changed = bytearray(data)
        for _ in range(int(rng.integers(1, 4))):
            changed[rng.integers(len(data))] = rng.integers(256)
        return bytes(changed)
    mark = b" " if kind == 2 else b"\n"
    parts = data.split(mark)
    i = int(rng.integers(len(parts)))
    if kind == 2:
        parts[i] = WORDS[rng.integers(len(WORDS))]
    elif kind == 3:
        del parts[i]
    else:
        parts.insert(i, parts[rng.integers(len(parts))])
    return mark.join(parts)


@pytest.mark.parametrize(
    ("suffix", "binary"),
    [
        *[(".stl", None), (".stl", True), (".off", None), (".ply", None), (".ply", True), (".obj", None)],
        *[(".smesh", None), (".poly", None)],
    ],
)
def test_damaged_files(tmp_path: Path, suffix: str, binary: bool | None) -> None:
    """(A longer run, of 70,000 files, found PLY headers with a property twice.)"""
    rng = np.random.default_rng(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        Domain.extruded(FRAME, 1).write(tmp_path / f"a{suffix}", binary=binary)
    data = (tmp_path / f"a{suffix}").read_bytes()
    told = 0
    for _ in range(60):
        (tmp_path / f"b{suffix}").write_bytes(damaged(data, rng))
        try:
            Domain.read(tmp_path / f"b{suffix}")
        except UnstructError as error:
            told += len(str(error)) > 10
    assert told > 20


def test_a_property_twice(tmp_path: Path) -> None:
    Domain(Domain.box().points, Domain.box().facets).write(tmp_path / "a.ply", binary=True)
    data = (tmp_path / "a.ply").read_bytes().replace(b"property double z\n", b"property double z\n" * 2)
    (tmp_path / "a.ply").write_bytes(data)
    with pytest.raises(UnstructError, match="line 7: 'property double z' is no line of the header"):
        Domain.read(tmp_path / "a.ply")
