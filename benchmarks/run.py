"""Run a suite: each case runs in a process of its own, and the results are rows."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Collection
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
RESULTS = Path(__file__).resolve().parent / "results"
SLOW = 12.0  # a run expected to take more seconds is done only once, and not at all above three times as many


def work_of(row: dict[str, Any]) -> str:
    """The name by which a case or a row is chosen: its work; without one, its dimension, or "start"."""
    return str(row.get("work", row.get("dimension", "start")))


class Workers:
    """Run one job at a time; a job that fails or takes too long is reported and gives None.

    ``timeout`` is how many seconds a job may take, including the compilation of kernels; None means no limit.
    Of a job whose work is not in ``only`` the result is None; ``only`` empty means all work.
    """

    def __init__(self, timeout: float | None = None, only: Collection[str] = ()):
        self.timeout = timeout
        self.only = only
        self.failures: list[str] = []
        self.works: dict[str, None] = {}  # that were asked for, chosen or not

    def ask(self, job: str, case: dict[str, Any]) -> Any:
        """The result of the worker, or None."""
        name = work_of(case)
        self.works[name] = None
        return self.answer(job, case) if not self.only or name in self.only else None

    def answer(self, job: str, case: dict[str, Any]) -> Any:
        """As `ask`, whatever work has been chosen."""
        text = json.dumps({"job": job, **case})
        command = [sys.executable, "-m", "benchmarks.worker", text]
        try:
            result = subprocess.run(
                command, cwd=ROOT, capture_output=True, text=True, timeout=self.timeout, env=dict(os.environ)
            )
        except subprocess.TimeoutExpired:
            self._failed(f"{text}: no answer after {self.timeout:.0f} s")
            return None
        if result.returncode != 0:
            last = result.stderr.strip().splitlines()[-1:] or [f"exit code {result.returncode}"]
            self._failed(f"{text}: {last[0]}")
            return None
        print(f"{job}: {json.dumps(case)}", file=sys.stderr)
        return json.loads(result.stdout.splitlines()[-1])

    def _failed(self, message: str) -> None:
        self.failures.append(message)
        print(f"FAILED {message}", file=sys.stderr)


def measured(
    workers: Workers, job: str, case: dict[str, Any], expected: dict[str, float], repeats: int
) -> list[dict[str, Any]]:
    """The rows of one kind and size: fast contestants run interleaved, slow ones run alone and only once.

    ``expected`` has the expected seconds of each contestant, or 0 if they are not known yet. After the run it
    has those for the next size, which is ten times as large.
    """
    groups = [[name for name in expected if expected[name] <= SLOW]]
    groups += [[name] for name in expected if SLOW < expected[name] <= 3 * SLOW]
    found = []
    for group in filter(None, groups):
        times = repeats if expected[group[0]] <= SLOW else 1
        for row in workers.ask(job, {**case, "contestants": group, "repeats": times}) or []:
            seconds = median(row["cpu"])
            expected[row["contestant"]] = 12 * seconds
            found.append({"measure": "time", **case, **row, "seconds": seconds})
    return found
