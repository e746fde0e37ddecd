#!/usr/bin/python3
"""Measures loads written as formulas against the same built-in loads, and writes a table with its provenance.

    PYTHONPATH=build/python tests/benchmarks/formula_speed.py DIRECTORY

Writes DIRECTORY/formula_speed.md and an entry in provenance.json. Runs alternate; the shortest of each kind count. The
cost of a step is the difference between runs of two durations, which excludes reading and compiling formulas; the
column "preparation" is what a formula adds to a run besides.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import polhode
import recorded_table

Loads = list[dict[str, Any]]

TORQUE: tuple[Loads, Loads] = (
    [{"type": "torque", "frame": "body", "vector": [0.1, 0.2, -0.1]}],
    [{"type": "torque", "frame": "body", "formula": [0.1, 0.2, -0.1]}])
DRAG: tuple[Loads, Loads] = (
    [{"type": "drag", "rotational": [1e-3, 2e-3, 3e-3], "translational": 5e-3}],
    [{"type": "torque", "frame": "body", "formula": ["-1e-3*w.x", "-2e-3*w.y", "-3e-3*w.z"]},
     {"type": "force", "frame": "world", "formula": "-5e-3*v"}])
SPRING: tuple[Loads, Loads] = (
    [{"type": "spring", "stiffness": 2}],
    [{"type": "potential", "formula": "3 - to_world([1,0,0]).x - to_world([0,1,0]).y - to_world([0,0,1]).z"}])
CASES = {"constant torque": TORQUE, "drag": DRAG, "spring": SPRING,
         "all three": (TORQUE[0] + DRAG[0] + SPRING[0], TORQUE[1] + DRAG[1] + SPRING[1])}


def scene(loads: Loads, duration: float) -> polhode.Scene:
    """A free asymmetric body under these loads."""
    return polhode.scene({"name": "loads", "duration": duration, "body": {"mass": 2, "inertia": [1, 2, 3]},
                          "initial": {"angular_velocity": [0.1, 2, 0.3], "velocity": [1, 2, 3]}, "loads": loads})


def solver_times(pair: tuple[Loads, Loads], method: str) -> list[list[float]]:
    """The shortest times of runs of 40 s and 200 s, with built-in loads and with formulas."""
    best = [[float("inf")] * 2 for _ in pair]
    scenes = [[scene(loads, duration) for duration in (40, 200)] for loads in pair]
    for _ in range(200):
        for kind in range(2):
            for k in range(2):
                best[kind][k] = min(best[kind][k], polhode.solve(scenes[kind][k], method, tolerance=1e-10, samples=1).seconds)
    return best


def ensemble_times(pair: tuple[Loads, Loads]) -> list[float]:
    """The shortest times of 20 000 bodies over 20 s, one thread."""
    rates = np.random.default_rng(1).normal(size=(20_000, 3))
    best = [float("inf")] * 2
    scenes = [scene(loads, 20) for loads in pair]
    for _ in range(5):
        for kind in range(2):
            begin = time.perf_counter()
            polhode.ensemble(scenes[kind], w=rates, threads=1)
            best[kind] = min(best[kind], time.perf_counter() - begin)
    return best


def main() -> None:
    """Measures, and writes the table."""
    directory = Path(sys.argv[1])
    head = ["loads", "taylor, per step", "preparation", "extrapolation, per step", "preparation", "ensemble"]
    rows = []
    for name, pair in CASES.items():
        row = [name]
        for method in ("taylor", "extrapolation"):
            built_in, formula = solver_times(pair, method)
            row.append(f"{(formula[1] - formula[0]) / (built_in[1] - built_in[0]):.2f} times")
            row.append(f"{1e6 * (formula[0] - built_in[0]):.0f} us more")
        plain, written = ensemble_times(pair)
        rows.append([*row, f"{written / plain:.2f} times"])
    recorded_table.write(directory, "formula_speed", head, rows, {})


if __name__ == "__main__":
    main()
