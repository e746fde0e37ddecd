"""Fixtures of the tests of the Python module: an empty cache of truths, and the program for comparison."""

from __future__ import annotations

import csv
import io
import os
import subprocess
import tempfile
from pathlib import Path

_cache = tempfile.TemporaryDirectory(prefix="polhode-cache-")
os.environ["POLHODE_CACHE"] = _cache.name
os.environ.setdefault("MPLBACKEND", "Agg")

import numpy as np  # noqa: E402
import pytest  # noqa: E402

PROGRAM = os.environ.get("POLHODE_PROGRAM", str(Path(__file__).parents[2] / "build" / "polhode"))


class Program:
    """The built program, whose numbers are compared with those of the module."""

    def __call__(self, *arguments: str) -> str:
        return subprocess.run([PROGRAM, *arguments], check=False, capture_output=True, text=True).stdout

    def table(self, *arguments: str) -> dict[str, np.ndarray]:
        lines = [line for line in self(*arguments).splitlines() if not line.startswith("#")]
        rows = list(csv.DictReader(io.StringIO("\n".join(lines))))
        return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "body"}


@pytest.fixture(scope="session")
def program() -> Program:
    return Program()
