"""The answer of `check`: a report that is true if the mesh is valid and that lists all problems if not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

__all__ = ["Problem", "Report", "problem"]


@dataclass(frozen=True)
class Problem:
    """One kind of defect, and the cells and vertices that have it."""

    kind: str
    text: str
    cells: tuple[int, ...] = ()
    vertices: tuple[int, ...] = ()

    def __str__(self) -> str:
        parts = [f"{self.kind}: {self.text}"]
        parts += [f"cells {_few(self.cells)}"] if self.cells else []
        parts += [f"vertices {_few(self.vertices)}"] if self.vertices else []
        return "; ".join(parts)


@dataclass
class Report:
    """What `check` found: true if there is no problem; otherwise ``problems`` names cells and vertices."""

    title: str
    problems: list[Problem] = field(default_factory=list)
    passed: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return not self.problems

    def __str__(self) -> str:
        lines = [f"{'valid' if self else 'not valid'}: {self.title}"]
        lines += [f"  problem  {each}" for each in self.problems]
        lines += [f"  checked  {name}" for name in self.passed]
        lines += [f"  skipped  {name}" for name in self.skipped]
        return "\n".join(lines)

    __repr__ = __str__

    def note(self, name: str, *problems: Problem | None) -> bool:
        """Record a test by its name, or the problems that it found; return whether there were none."""
        found = [each for each in problems if each is not None]
        self.problems += found
        if not found:
            self.passed.append(name)
        return not found


def _few(numbers: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, numbers[:8]))
    return shown if len(numbers) <= 8 else f"{shown}, ... ({len(numbers)} in all)"


def problem(kind: str, text: str, cells: Iterable = (), vertices: Iterable = ()) -> Problem | None:
    """A problem with these cells and vertices; None if there are none."""
    cells, vertices = (
        tuple(np.unique(np.asarray(list(v), dtype=np.int64)).tolist()) for v in (cells, vertices)
    )
    return Problem(kind, text, cells, vertices) if cells or vertices else None
