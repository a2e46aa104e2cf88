"""What the chapters print that solve something is the same on the oldest processor.

A process runs this file by itself, beside `test_processors.py`.
"""

from __future__ import annotations

from on_processors import print_the_same


def test_what_chapters_print_that_solve_something() -> None:
    print_the_same("oldest")
