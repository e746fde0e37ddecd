"""Pages that need Python: the module's reference, the notebooks, and the output of the comparison's scripts."""

import json
import os
import subprocess
import sys
from pathlib import Path

from pages import Pages

_NOT_BUILT = (
    "The module `polhode` was not available when these pages were built: `import polhode` failed. "
    "Build the module, then build the pages again.\n"
)


def environment() -> dict[str, str]:
    """Returns the environment in which Python finds the module in POLHODE_PYTHON."""
    paths = [os.environ.get("POLHODE_PYTHON", ""), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}


def _python(*arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=False, env=environment(), cwd=folder
    )


def public_names() -> dict[str, str] | None:
    """Returns the kind (class, function or data) of each public name, or None if the module cannot be imported."""
    run = _python(
        "-c",
        "import inspect, json, polhode\n"
        "names = getattr(polhode, '__all__', [n for n in vars(polhode) if not n.startswith('_')])\n"
        "kinds = {n: getattr(polhode, n) for n in names}\n"
        "print(json.dumps({n: 'class' if inspect.isclass(v) else 'function' if callable(v) else 'module'\n"
        "                  if inspect.ismodule(v) else 'data' for n, v in kinds.items()}))\n",
    )
    if run.returncode != 0:
        return None
    names: dict[str, str] = json.loads(run.stdout)
    return {name: kind for name, kind in names.items() if kind != "module" and name[0] != "_"}


def python_page(pages: Pages) -> None:
    """Writes the module's reference from its docstrings."""
    names = public_names()
    title = "# Python\n\n"
    if names is None:
        pages.write("reference/python.md", title + _NOT_BUILT)
        return
    text = [title + "```{eval-rst}", ".. automodule:: polhode", "", ".. currentmodule:: polhode", ""]
    text += [".. autosummary::", "", *(f"   {name}" for name in names), "", "```", ""]
    for kind, heading in (("function", "Functions"), ("class", "Classes"), ("data", "Data")):
        some = [name for name, is_ in names.items() if is_ == kind]
        if some:
            text += [f"## {heading}", "", "```{eval-rst}", ".. currentmodule:: polhode", ""]
            for name in some:
                text += [f".. auto{kind}:: {name}", *(["   :members:"] if kind == "class" else []), ""]
            text += ["```", ""]
    pages.write("reference/python.md", "\n".join(text))


def comparison_outputs(pages: Pages, folder: Path, work: Path, program: Path) -> None:
    """Writes the output of the comparison's scripts; runs a script only if it or the program has changed."""
    work.mkdir(parents=True, exist_ok=True)
    for name in ("scipy", "polhode", "sympy", "polhode_load"):
        script, cached = folder / f"comparison_{name}.py", work / f"{name}.txt"
        module = name.split("_")[0]
        if _python("-c", f"import {module}").returncode != 0:
            pages.write(f"comparison_{name}.txt", f"not run: `import {module}` failed when these pages were built\n")
            continue
        if not cached.is_file() or cached.stat().st_mtime < max(one.stat().st_mtime for one in (script, program)):
            done = _python(str(script), folder=folder)
            if done.returncode != 0:
                raise RuntimeError(f"{script.name}: {done.stderr.strip()}")
            cached.write_text(done.stdout, encoding="utf-8")
        pages.write(f"comparison_{name}.txt", cached.read_text(encoding="utf-8"))


def notebook_paths(top: Path) -> list[Path]:
    """Returns the notebooks by number."""
    return sorted((top / "experiments/notebooks").glob("*.ipynb"), key=lambda path: int(path.stem.split("_")[0]))


def notebook_pages(pages: Pages, top: Path, work: Path, program: Path) -> None:
    """Writes the pages of the notebooks; runs a notebook only if it or the module has changed."""
    notebooks = notebook_paths(top)
    text = ["# Notebooks\n\nThe notebooks of `experiments/notebooks`, run when these pages were built.\n"]
    if not notebooks:
        pages.write("notebooks.md", "# Notebooks\n\nNo notebooks are available.\n")
        return
    if public_names() is None:
        names = "\n".join(f"- `{path.name}`" for path in notebooks)
        pages.write("notebooks.md", f"# Notebooks\n\n{_NOT_BUILT}\nThe notebooks are:\n\n{names}\n")
        return
    runner = Path(__file__).with_name("notebook.py")
    text.append("```{toctree}\n:maxdepth: 1\n")
    for path in notebooks:
        page = work / f"{path.stem}.md"
        newest = max(one.stat().st_mtime for one in (path, runner, program))
        if not page.is_file() or page.stat().st_mtime < newest:
            done = _python(str(runner), "run", str(path), "--markdown", str(work))
            if done.returncode != 0:
                raise RuntimeError(done.stderr.strip())
        origin = path.parent.relative_to(top)
        name = f"tree/{origin}/{path.stem}.md"
        for figure in sorted((work / f"{path.stem}_files").glob("*")):
            pages.copy(figure, f"tree/{origin}/{path.stem}_files/{figure.name}")
        pages.write_page(name, page.read_text(encoding="utf-8"), origin)
        text.append(name[:-3])
    pages.write("notebooks.md", "\n".join([*text, "```", ""]))


