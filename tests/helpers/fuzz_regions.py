"""Mesh very many small random regions and judge every mesh.

``python tests/helpers/fuzz_regions.py COUNT --seed S`` runs it.
Region i of seed S is made from the pair (S, i), so that ``--first i --count 1`` repeats it, by one of the
generators of `regions.KINDS` and `extreme_regions.EXTREME`.
Its kind is number i modulo their number, unless ``--kind`` names one.
Each mesh is judged by a compiled check (adjacency, orientation and empty circles by exact signs, area, every
limit that the mesh claims to keep), and now and then, and wherever that finds a fault, by `unstruct.check`.
"""

from __future__ import annotations

import argparse
import re
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import regions
from extreme_regions import EXTREME
from fuzz_work import WORK

from unstruct import IncompleteWarning, InputError, UnstructError, check

KINDS = regions.KINDS | EXTREME
SECONDS = 20  # of the processor, for one mesh
SAMPLE = 50  # one mesh in so many gets the full check
LARGEST = 3000  # cells, for the full check where nothing is suspicious


class TooLong(Exception):
    """A mesh took longer than `SECONDS`."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TooLong` when so much processor time is used up."""

    def stop(*_: Any) -> None:
        raise TooLong(f"more than {seconds} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def one(seed: int, i: int, names: list[str], kind: str | None = None) -> tuple[str, list[str], list[str]]:
    """Region i: its kind, what came of it, and the faults."""
    rng = np.random.default_rng([seed, i])
    kind = list(KINDS)[i % len(KINDS)] if kind is None else kind
    outcomes, faults = [], []
    try:
        with limited(SECONDS):
            domain = KINDS[kind](rng)
    except (UnstructError, TooLong) as error:
        return kind, [f"domain: {type(error).__name__}"], [f"domain: {error}"]
    for name in names:
        try:
            with limited(SECONDS):
                outcome, mesh, fault, judged = WORK[name](
                    domain, np.random.default_rng([seed, i, *name.encode()])
                )
            if fault or (i % SAMPLE == 0 and mesh.size < LARGEST):
                report = check(mesh, domain=judged, delaunay="constrained")
                fault = fault or ("" if report else str(report))
            outcomes.append(outcome)
            if fault:
                faults.append(f"{outcome}: {fault}")
        except TooLong as error:
            faults.append(f"{name}: {error}")
        except InputError as error:
            told = kind in EXTREME and re.search(
                "too few digits|no digits left|not 0.0$|= 0.0 must", str(error)
            )
            (outcomes if told else faults).append(f"{name}: {'too few digits' if told else error}")
        except Exception as error:
            faults.append(f"{name}: {type(error).__name__}: {error}\n{traceback.format_exc(limit=-3)}")
    return kind, outcomes, faults


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, mesh, print the totals; 1 where anything was at fault."""
    parser = argparse.ArgumentParser(prog="python tests/helpers/fuzz_regions.py", description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first region")
    parser.add_argument("--kind", choices=list(KINDS), help="regions of this kind only")
    parser.add_argument("--work", nargs="*", choices=sorted(WORK), default=sorted(WORK))
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore", IncompleteWarning)
    kinds: Counter[str] = Counter()
    outcomes: Counter[str] = Counter()
    faults = slowest = 0
    for name in options.work:  # to have all compiled: an alarm within the compiler leaves half a function
        for kind in regions.KINDS.values():
            check(WORK[name](kind(np.random.default_rng(1)), np.random.default_rng(1))[1])
    begin = time.perf_counter()
    for i in range(options.first, options.first + options.count):
        start = time.process_time()
        kind, came, wrong = one(options.seed, i, options.work, options.kind)
        took = time.process_time() - start
        slowest = max(slowest, took)
        if took > 5:
            print(f"region {i} ({kind}) took {took:.1f} s: {came}", flush=True)
        kinds[kind] += 1
        outcomes.update(came)
        faults += len(wrong)
        for text in wrong:
            print(f"region {i} ({kind}): {text}", flush=True)
    seconds = time.perf_counter() - begin
    print(f"seed {options.seed}, regions {options.first} to {i}: {dict(kinds)}")
    for outcome, number in sorted(outcomes.items()):
        print(f"{number:8d}  {outcome}")
    print(f"{faults} faults in {seconds:.0f} s, the slowest region {slowest:.2f} s")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
