"""The notebooks run, store no results, and have at most fifteen lines of code."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "experiments" / "notebooks"
NOTEBOOKS = sorted(path.stem for path in FOLDER.glob("*.ipynb"))


def cells(name):
    return json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]


def test_the_table_lists_all():
    table = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) >= 7
    assert all(f"| [{name}]({name}.ipynb) |" in table for name in NOTEBOOKS)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebook_runs(name):
    before = sorted(FOLDER.iterdir())
    said = subprocess.run([sys.executable, str(ROOT / "src" / "documentation" / "notebook.py"), "run",
                           str(FOLDER / f"{name}.ipynb")],
                          capture_output=True, text=True, timeout=600, env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
    assert said.returncode == 0, said.stderr
    assert "Warning" not in said.stderr, said.stderr
    assert sorted(FOLDER.iterdir()) == before


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebook_stores_no_results(name):
    for number, cell in enumerate(cells(name), 1):
        assert cell["id"], f"cell {number}"
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None, f"cell {number}"


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebook_is_valid(name):
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)


def test_a_picture_of_ones_own_method_takes_fifteen_lines():
    lines = []
    for cell in cells("4_your_own_integrator"):
        if cell["cell_type"] != "code":
            continue
        lines += [line for line in "".join(cell["source"]).splitlines() if line.strip() and not line.startswith("#")]
        if "plot(" in lines[-1]:
            break
    assert "found.plot();" in lines and "@polhode.method(order=2)" in lines and len(lines) <= 15
