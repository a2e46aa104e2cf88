"""Rows of some works, measured again, put in the place of those that were measured before."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from .run import work_of

__all__ = ["merged"]


def merged(old: dict[str, Any], new: dict[str, Any], works: Collection[str]) -> dict[str, Any]:
    """The old result with the rows, failures and versions of the new one for these works.

    Works keep their places; those that were not there before come last.

    Raises
    ------
    ValueError
        If the two were measured on different machines.
    """
    if old["machine"] != new["machine"]:
        raise ValueError(
            f"the other rows are of {old['machine']}, not of {new['machine']}: run the whole suite"
        )
    rows: list[dict[str, Any]] = []
    left = dict.fromkeys(map(work_of, new["rows"]))
    for row in old["rows"]:
        work = work_of(row)
        if work not in works:
            rows.append(row)
        elif work in left:
            rows += [other for other in new["rows"] if work_of(other) == work]
            del left[work]
    rows += [row for row in new["rows"] if work_of(row) in left]
    again = old.get("again", {}) | {work: new["load"] for work in dict.fromkeys(map(work_of, new["rows"]))}
    failures = [text for text in old["failures"] if not any(_is_of(text, work) for work in works)]
    return {
        **old,
        "versions": old["versions"] | new["versions"],
        "again": again,
        "failures": failures + new["failures"],
        "rows": rows,
    }


def _is_of(failure: str, work: str) -> bool:
    return f'"work": "{work}"' in failure or f'"dimension": {work},' in failure
