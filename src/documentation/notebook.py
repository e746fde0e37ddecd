#!/usr/bin/python3
"""Runs a Jupyter notebook without Jupyter, and writes it with its results as a page.

    notebook.py run FILE.ipynb [--markdown DIRECTORY]

Code cells run in order in one namespace, in the notebook's own directory. A cell shows what it prints, the figures it
draws (SVG) and the value of its last expression. Lines that begin with % are Jupyter's and are omitted. The first
exception ends the run: its traceback, the notebook's name and the cell's number go to stderr, and the exit code is 1.

With --markdown the page is DIRECTORY/FILE.md, in MyST, and its figures are in DIRECTORY/FILE_files.
"""

import argparse
import ast
import contextlib
import io
import json
import linecache
import os
import re
import sys
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class Cell:
    """A cell of the file, without lines that begin with %. `number` counts cells of all kinds from 1."""

    number: int
    kind: str
    source: str


@dataclass
class Output:
    """The output of one cell: Markdown blocks and the figures that they refer to."""

    blocks: list[str] = field(default_factory=list)
    figures: dict[str, bytes] = field(default_factory=dict)


def read(path: Path) -> list[Cell]:
    """The cells of a notebook of format 4."""
    content = json.loads(path.read_text(encoding="utf-8"))
    if content.get("nbformat") != 4:
        raise ValueError("not a notebook of format 4")
    cells = [Cell(i, cell["cell_type"], "".join(cell["source"])) for i, cell in enumerate(content["cells"], 1)]
    for cell in cells:
        if cell.kind == "code":  # without Jupyter's own commands
            cell.source = re.sub(r"^%.*\n?", "", cell.source, flags=re.MULTILINE)
    return cells


def fenced(text: str, language: str) -> str:
    """A literal block, with a fence that does not occur in the text."""
    fence = "```"
    while fence in text:
        fence += "`"
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"


class Notebook:
    """A running notebook: one namespace for all cells."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._names: dict[str, Any] = {"__name__": "__main__", "display": self._display}
        self._output = Output()

    def run(self, cell: Cell) -> Output:
        """Runs a code cell and returns its output. Does not catch its exceptions."""
        self._output = Output()
        source, place = cell.source, f"{self.path.name}, cell {cell.number}"
        linecache.cache[place] = (len(source), None, source.splitlines(keepends=True), place)
        tree = ast.parse(source, place)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        printed = io.StringIO()
        value = None
        with contextlib.redirect_stdout(printed):
            exec(compile(tree, place, "exec"), self._names)
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), place, "eval"), self._names)
        if printed.getvalue():
            self._output.blocks.insert(0, fenced(printed.getvalue(), "text"))
        if value is not None and not source.rstrip().endswith(";"):
            self._display(value)
        for name, picture in self._figures(cell.number):
            self._output.figures[name] = picture
            self._output.blocks.append(f"![Figure of cell {cell.number}]({self.path.stem}_files/{name})")
        return self._output

    def _display(self, *values: Any) -> None:
        """Jupyter's `display`: shows values in the best form available."""
        for value in values:
            if type(value).__module__ == "matplotlib.figure":
                continue  # shown with the cell's figures
            if hasattr(value, "_repr_markdown_"):
                self._output.blocks.append(str(value._repr_markdown_()))
            elif hasattr(value, "_repr_html_"):
                self._output.blocks.append("```{raw} html\n" + str(value._repr_html_()) + "\n```")
            else:
                self._output.blocks.append(fenced(repr(value), "text"))

    @staticmethod
    def _figures(cell: int) -> Iterator[tuple[str, bytes]]:
        pyplot: Any = sys.modules.get("matplotlib.pyplot")
        if pyplot is None:
            return
        pyplot.rcParams["svg.hashsalt"] = "polhode"
        for i, number in enumerate(pyplot.get_fignums(), 1):
            picture = io.BytesIO()
            pyplot.figure(number).savefig(picture, format="svg", bbox_inches="tight", metadata={"Date": None})
            yield f"cell_{cell}_{i}.svg", picture.getvalue()
        pyplot.close("all")


def run(path: Path, markdown: Path | None) -> int:
    """Runs a notebook, and writes its page to the directory `markdown` if given. Returns the exit code."""
    os.environ["MPLBACKEND"] = "Agg"
    warnings.filterwarnings("ignore", message=".*non-GUI backend.*")
    path, markdown = path.resolve(), markdown.resolve() if markdown else None
    try:
        cells = read(path)
    except (OSError, ValueError, KeyError, TypeError) as fault:
        print(f"{path.name}: {fault}", file=sys.stderr)
        return 1
    os.chdir(path.parent)
    sys.path.insert(0, str(path.parent))
    notebook = Notebook(path)
    parts: list[str] = []
    figures: dict[str, bytes] = {}
    for cell in cells:
        if cell.kind != "code":
            parts.append(cell.source if cell.kind == "markdown" else fenced(cell.source, "text"))
        elif cell.source.strip():
            try:
                output = notebook.run(cell)
            except (Exception, SystemExit) as fault:
                traceback.print_exc()
                print(f"{path.name}: cell {cell.number}: {type(fault).__name__}: {fault}", file=sys.stderr)
                return 1
            parts += [fenced(cell.source, "python"), *output.blocks]
            figures |= output.figures
    if markdown:
        markdown.mkdir(parents=True, exist_ok=True)
        (markdown / f"{path.stem}.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
        for name, picture in figures.items():
            target = markdown / f"{path.stem}_files" / name
            target.parent.mkdir(exist_ok=True)
            target.write_bytes(picture)
    return 0


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description="Runs a Jupyter notebook without Jupyter.")
    command = parser.add_subparsers(dest="command", required=True).add_parser("run", help="run one notebook")
    command.add_argument("file", type=Path, metavar="FILE.ipynb")
    command.add_argument("--markdown", type=Path, metavar="DIRECTORY", help="also write the page and its figures here")
    options = parser.parse_args()
    return run(options.file, options.markdown)


if __name__ == "__main__":
    sys.exit(main())
