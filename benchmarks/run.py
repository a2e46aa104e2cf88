"""Run a suite: workers in processes of their own, rows to files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
RESULTS = Path(__file__).resolve().parent / "results"
SLOW = 12.0  # seconds: what would take longer is run once; what would take three times as long, not at all


class Workers:
    """Ask for one job at a time; a job that fails or takes too long is told and gives None.

    ``timeout``: the seconds a job may take, the compilation of kernels counted in; None for no limit.
    """

    def __init__(self, timeout: float | None = None):
        self.timeout = timeout
        self.failures: list[str] = []

    def ask(self, job: str, case: dict[str, Any]) -> Any:
        """The worker's answer, or None."""
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
    """One kind and size: contestants interleaved, those that would be slow by themselves and once.

    ``expected`` has the seconds of each contestant, 0 where they are not known yet; after the run it has
    those for the next, tenfold size.
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
