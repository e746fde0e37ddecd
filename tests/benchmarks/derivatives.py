#!/usr/bin/python3
"""Measures the digits of `polhode.sensitivity`, and the time of a fit, and writes tables.

    PYTHONPATH=build/python tests/benchmarks/derivatives.py DIRECTORY

Writes DIRECTORY/derivatives.md and derivatives.csv: for each scene and number of the test, the largest difference from
central differences of the reference in 35 digits, relative to the largest value of its block, and the correct digits.
Writes DIRECTORY/fits.md and fits.csv: times of fits to 10,000 samples.
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path

import numpy as np
import polhode

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))
import test_sensitivity as cases

SAMPLES = 10_000


def digits() -> list[list[str]]:
    """One row per scene and number."""
    rows = []
    for make, pointers in cases.CASES:
        scene = make()
        times = [scene.duration / 2, scene.duration]
        found = polhode.sensitivity(scene, pointers, times=times)
        for pointer in pointers:
            exact = cases.differences(scene, pointer, times)
            worst = 0.0
            for name, block in exact.items():
                own = np.asarray(getattr(found[pointer], name)).reshape(block.shape)
                scale = np.abs(block).max()
                worst = max(worst, float(np.abs(own - block).max() / scale) if scale > 0 else 0.0)
            rows.append([make.__name__ if scene.get("name", "own") == "own" else scene.name, pointer, f"{worst:.1e}", f"{-math.log10(worst):.1f}"])
    return rows


def satellite(numbers: list[float]) -> polhode.Scene:
    """A tumbling satellite under a known torque: three moments and three initial rates are determined."""
    return polhode.scene(
        name="satellite", duration=40,
        body=polhode.body(mass=50, inertia=numbers[:3]),
        initial=polhode.initial(angular_velocity=numbers[3:]),
        loads=[polhode.torque([0.02, -0.01, 0.015], "body", from_=5, until=25)])


def fits() -> list[list[str]]:
    """The time of a fit of six numbers to gyroscope data, and the largest error in standard deviations."""
    true = [4.2, 5.1, 6.3, 0.11, 0.31, -0.07]
    pointers = [f"/{place}/{i}" for place in ("body/inertia", "initial/angular_velocity") for i in range(3)]
    times = np.linspace(0, 40, SAMPLES)
    noise = np.random.default_rng(7).normal(scale=1e-4, size=(SAMPLES, 3))
    measured = polhode.solve(satellite(true), times=times).w_B + noise
    start = satellite([x * (1 + 0.03 * (-1) ** k) for k, x in enumerate(true)])
    begin, begin_cpu = time.perf_counter(), time.process_time()
    found = polhode.fit(start, measured, pointers, ["wx_B", "wy_B", "wz_B"], times=times, weights=1e4)
    seconds, cpu = time.perf_counter() - begin, time.process_time() - begin_cpu
    worst = float(np.abs((found.values - true) / np.sqrt(np.diag(found.covariance))).max())
    return [["three moments and three rates of a satellite, gyroscope", str(SAMPLES), "6", f"{seconds:.1f} s", f"{cpu:.1f} s", f"{worst:.1f}"]]


def write(directory: Path, name: str, head: list[str], rows: list[list[str]]) -> None:
    """Writes a table as Markdown and CSV."""
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in [head, *rows]]
    lines.insert(1, "| " + " | ".join("-" * width for width in widths) + " |")
    (directory / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (directory / f"{name}.csv").write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n", encoding="utf-8")
    print("\n".join(lines))


def main() -> None:
    """Measures, and writes the tables."""
    directory = Path(sys.argv[1])
    directory.mkdir(parents=True, exist_ok=True)
    write(directory, "fits", ["fit", "samples", "numbers", "time", "CPU time", "largest error, standard deviations"], fits())
    write(directory, "derivatives", ["scene", "number", "largest relative error", "digits"], digits())


if __name__ == "__main__":
    main()
