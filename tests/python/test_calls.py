"""Threads, Ctrl-C, docstrings and types."""

import ast
import doctest
import importlib
import inspect
import pkgutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import polhode
import pytest


def test_other_threads_run_meanwhile():
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    polhode.solve("lagrange_top", "odeint_euler", step=2e-6, samples=1)
    spent = time.perf_counter() - begin
    done.set()
    thread.join()
    # 5 ms apart on an idle machine; no ticks while the lock is held
    assert len(ticks) > min(10, spent / 0.02)


def test_threads_have_the_same_bits():
    scene = polhode.scene("heavy_asymmetric_top").add_torque(lambda now: -0.01 * now.w_B)
    wanted = polhode.solve(scene, "dop853", samples=5).q.copy()
    found = [None] * 4

    def work(k):
        found[k] = polhode.solve(scene.copy(), "dop853", samples=5).q

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(q, wanted) for q in found)


LONG = {
    "solve": "polhode.solve('lagrange_top', 'odeint_euler', step=1e-7)",
    "taylor": "polhode.solve('free_asymmetric', 'taylor', duration=1e9, tolerance=1e-10)",
    "truth": "polhode.truth(polhode.scene('heavy_asymmetric_top', duration=1000), samples=1000, digits=70)",
    "certified": "polhode.truth('heavy_asymmetric_top', samples=10, digits=200, certified=True)",
    "torque": "polhode.solve(polhode.scene('free_asymmetric').add_torque(lambda now: -1e-3 * now.w_B), step=1e-7,"
              "method='odeint_rk4')",
    "ensemble": "polhode.ensemble('heavy_asymmetric_top', w=np.ones((200000, 3)), duration=1000)",
    "describe": "[polhode.describe('mechanisms/chain_10') for _ in range(20)]",
    "check": "[polhode.check(polhode.solve('heavy_asymmetric_top', samples=100_000)) for _ in range(20)]",
    "run": "polhode.run({'scenes': ['lagrange_top'], 'methods': ['odeint_rk4'], 'settings': {'steps': [1e-7]},"
           "'seconds_per_run': 1000})",
}


@pytest.mark.parametrize("what", LONG)
def test_ctrl_c_ends_a_long_call_soon(what):
    code = textwrap.dedent(f"""
        import os, signal, threading, time
        import numpy as np, polhode
        def interrupt():
            global sent
            time.sleep(0.6)
            sent = time.perf_counter()
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            {LONG[what]}
        except KeyboardInterrupt:
            print(time.perf_counter() - sent)
        polhode.solve("lagrange_top")
    """)
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert said.stdout, said.stderr
    # 0.03 s on an idle machine
    assert float(said.stdout) < 2


def test_docstrings_run_and_say_what_they_should():
    import polhode as module

    failed = attempted = 0
    for found in pkgutil.iter_modules(module.__path__):
        if found.name == "_polhode":
            continue
        result = doctest.testmod(importlib.import_module(f"polhode.{found.name}"),
                                 optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
        failed += result.failed
        attempted += result.attempted
    assert failed == 0 and attempted > 30
    for name in module.__all__:
        thing = getattr(module, name)
        if name != "__version__":
            assert inspect.getdoc(thing), name
        if inspect.isfunction(thing):
            text = inspect.getdoc(thing)
            assert "Returns\n-------" in text, name
            for parameter in inspect.signature(thing).parameters:
                assert parameter in text, f"{name}: {parameter}"


def test_types_are_strict(tmp_path):
    mypy = subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True)
    if mypy.returncode:
        pytest.skip("mypy is not installed")
    example = tmp_path / "example.py"
    example.write_text(textwrap.dedent("""
        import numpy as np
        import polhode


        def drag(now: polhode.LoadState) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
            return -0.1 * now.w_B


        top = polhode.scene("lagrange_top").add_torque(drag)
        motion = polhode.solve(top, tolerance=1e-9, samples=10)
        length: float = float(np.linalg.norm(motion.q[-1]))
        largest: float | None = polhode.solve("t_handle").errors().max["attitude"]
        digits: list[str] = polhode.truth("t_handle", [1.0], digits=20).decimals["qw"]
        ends = polhode.ensemble("t_handle", w=np.ones((10, 3)))
        print(length, largest, digits, ends.q.shape, polhode.methods()["taylor"].order)
    """))
    package = Path(polhode.__file__).resolve().parent
    said = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", str(tmp_path / "cache"), str(example), str(package)],
        capture_output=True, text=True, cwd=tmp_path, env={"MYPYPATH": str(package.parent), "PATH": ""})
    assert said.returncode == 0, said.stdout


def test_modules_import_one_another_in_one_direction() -> None:
    """No module of the package imports itself through others, not even for types."""
    imports: dict[str, set[str]] = {}
    for path in Path(polhode.__file__).parent.glob("*.py"):
        found = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module is not None and node.module.startswith("polhode."):
                found.add(node.module.removeprefix("polhode."))
        imports[path.stem] = found
    assert len(imports) > 8
    left = dict(imports)
    while left:
        lowest = [name for name, others in left.items() if not others & left.keys()]
        assert lowest, f"these need one another: {sorted(left)}"
        for name in lowest:
            del left[name]
