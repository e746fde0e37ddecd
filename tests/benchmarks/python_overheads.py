#!/usr/bin/python3
"""Measures the overhead of the Python module, and writes a table with its provenance.

    PYTHONPATH=build/python tests/benchmarks/python_overheads.py DIRECTORY

Writes DIRECTORY/python.md and an entry in provenance.json. Each time is the shortest of several runs in one
process.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import polhode
import recorded_table
from polhode import _polhode


def shortest(work: Callable[[], object], repeats: int) -> float:
    """The shortest time of one call, s."""
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return best


def call_overhead() -> list[list[str]]:
    """A call on small scenes, compared with solve() in C++ in the same process."""
    rows = []
    for name, method in (("free_asymmetric", "exact"), ("lagrange_top", "taylor"), ("every_load", "dop853")):
        scene = polhode.scene(name)
        polhode.solve(scene, method, samples=10)
        settings = _polhode.Settings(samples=10)
        within, outside = float("inf"), float("inf")
        for _ in range(20):
            within = min(within, _polhode.seconds_of_solve(scene._compiled(), method, settings, 20))
            outside = min(outside, shortest(lambda: polhode.solve(scene, method, samples=10).q, 20))
        rows.append([f"solve, {name}, {method}, 11 samples", f"{1e6 * within:.1f} us", f"{1e6 * outside:.1f} us",
                     f"{1e6 * (outside - within):.1f} us more", "20 us more"])
    return rows


def survey() -> list[list[str]]:
    """The same overhead on all scenes that C++ solves within 0.5 ms; lists those slower by more than 20 us."""
    found = []
    for name, *_ in polhode.scenes():
        scene = polhode.scene(name)
        motion = polhode.solve(scene, samples=10, max_seconds=0.1)
        if not motion.ok or motion.seconds > 5e-4:
            continue
        settings = _polhode.Settings(samples=10)
        within, outside = float("inf"), float("inf")
        for _ in range(40):
            within = min(within, _polhode.seconds_of_solve(scene._compiled(), motion.method, settings, 5))
            outside = min(outside, shortest(lambda: polhode.solve(scene, motion.method, samples=10).q, 5))
        found.append((1e6 * (outside - within), name))
    slow = [f"{name} {more:.0f} us" for more, name in sorted(found, reverse=True) if more > 20]
    more, name = max(found)
    return [[f"solve, all {len(found)} scenes below 0.5 ms, 11 samples: the largest overhead, {name}", "", "",
             f"{more:.1f} us more", "20 us more"],
            ["scenes with an overhead above 20 us", "", str(len(slow)), ", ".join(slow[:5]), "0"]]


def accesses() -> list[list[str]]:
    """What Python computes after a run of 101 samples, without a counterpart in C++."""
    rows = []
    arm = polhode.scene("mechanisms/arm6")
    for title, scene, work in (
        ("motion.w, first access", "free_asymmetric", lambda motion: motion.w),
        ("motion.frames()", "free_asymmetric", lambda motion: motion.frames()),
        ("motion.joints, 6 joints: repeats the run to count revolutions", arm, lambda motion: motion.joints),
        ("motion.at(10 times): repeats the run", "free_asymmetric", lambda motion: motion.at(np.linspace(0, 1, 10))),
        ("motion.csv()", "free_asymmetric", lambda motion: motion.csv()),
    ):
        posed = polhode.scene(scene) if isinstance(scene, str) else scene
        best = float("inf")
        for _ in range(20):
            motion = polhode.solve(posed)
            best = min(best, shortest(lambda: work(motion), 1))
        rows.append([title, "", f"{1e6 * best:.0f} us", "", ""])
    return rows


def ensembles() -> list[list[str]]:
    """10^6 free bodies from arrays to arrays, compared with solve_ensemble() in C++."""
    scene = polhode.scene("free_asymmetric")
    rates = np.random.default_rng(1).normal(size=(1_000_000, 3))
    threads = os.cpu_count() or 1
    within, outside = float("inf"), float("inf")
    for _ in range(5):
        within = min(within, _polhode.seconds_of_ensemble(scene._compiled(), rates, threads, 1))
        begin = time.perf_counter()
        ends = polhode.ensemble(scene, w=rates, threads=threads)
        outside = min(outside, time.perf_counter() - begin)
        del ends  # as in C++, freeing the rows is not timed
    return [["ensemble of 10^6 free bodies", f"{within:.3f} s", f"{outside:.3f} s", f"{outside / within:.2f} times",
             "1.05 times"]]


def memory() -> list[list[str]]:
    """The additional memory of 10^6 samples after all arrays have been accessed."""
    code = """if True:
        import resource, polhode
        motion = polhode.solve("free_asymmetric", "exact", samples=1_000_000)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        sizes = [len(a) for a in (motion.t, motion.q, motion.w_B, motion.p, motion.v)]
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)"""
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    return [["arrays of 10^6 samples", "112 MB of samples", f"{int(said) / 1024:.1f} MB more", "", "0 MB more"]]


def callables() -> list[list[str]]:
    """A user-defined torque and a user-defined step, compared with polhode's."""

    @polhode.method(name="rk4_in_python", order=4)
    def rk4(f, t, y, h):  # type: ignore[no-untyped-def]
        a = f(t, y)
        b = f(t + h / 2, y + h / 2 * a)
        c = f(t + h / 2, y + h / 2 * b)
        return y + h / 6 * (a + 2 * b + 2 * c + f(t + h, y + h * c))

    drag = polhode.scene("free_asymmetric", duration=10)
    drag["loads"] = [{"type": "drag", "rotational": [0.1, 0.2, 0.3]}]
    plain = polhode.scene("free_asymmetric", duration=10)
    arrays = plain.copy().add_torque(lambda now: np.array([-0.1, -0.2, -0.3]) * now.w_B)

    def by_components(now: polhode.LoadState) -> tuple[float, float, float]:
        a, b, c = now.w_B.tolist()
        return (-0.1 * a, -0.2 * b, -0.3 * c)

    words = plain.copy().add_torque(by_components)
    rows = []
    for title, scene, base, method, by in (
        ("user-defined torque, numpy, dop853", arrays, drag, "dop853", "dop853"),
        ("user-defined torque, three numbers, dop853", words, drag, "dop853", "dop853"),
        ("user-defined step (Runge-Kutta 4)", drag, drag, rk4, "odeint_rk4"),
    ):
        how: dict[str, Any] = {"step": 0.001} if by == "odeint_rk4" else {"tolerance": 1e-10}
        own, native = float("inf"), float("inf")
        for _ in range(5):
            one, other = polhode.solve(scene, method, samples=1, **how), polhode.solve(base, by, samples=1, **how)
            own = min(own, one.seconds / one.rhs_evaluations)
            native = min(native, other.seconds / other.rhs_evaluations)
        rows.append([title + ", per right-hand side", f"{1e6 * native:.3f} us", f"{1e6 * own:.2f} us",
                     f"{own / native:.0f} times", ""])
    return rows


def starting() -> list[list[str]]:
    """The time of the import, without the start of the interpreter."""

    def run(code: str) -> float:
        return shortest(lambda: subprocess.run([sys.executable, "-c", code], check=True), 7)

    bare, numpy, module = run("pass"), run("import numpy"), run("import polhode")
    return [["import polhode (includes numpy)", f"{numpy - bare:.3f} s for numpy", f"{module - bare:.3f} s", "",
             "0.2 s"]]


def main() -> None:
    """Measures, and writes the tables."""
    directory = Path(sys.argv[1])
    head = ["what", "C++", "Python", "difference", "target, at most"]
    rows = [*starting(), *call_overhead(), *survey(), *accesses(), *ensembles(), *memory(), *callables()]
    recorded_table.write(directory, "python", head, rows, {"numpy": np.__version__})


if __name__ == "__main__":
    main()
