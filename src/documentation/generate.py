"""Collects the pages that Sphinx reads: pages of this directory, READMEs of the source tree, reference pages."""

import argparse
import subprocess
import sys
from pathlib import Path

from cpp_pages import cpp_pages, read_headers
from gallery import gallery_page
from pages import Pages
from program_pages import Program, column_pages, command_page, experiment_page, key_page, method_page, scene_pages
from python_pages import comparison_outputs, notebook_pages, python_page

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]

# pages of the source tree, in the order of the index
INCLUDED = [
    "README.md", "experiments/README.md", "experiments/scenes.md", "experiments/formulas.md", "experiments/robots.md", "experiments/running.md",
    "experiments/debug_your_engine/README.md", "experiments/reference.md", "experiments/scenes/README.md",
    "integrators/README.md", "results/README.md", "src/README.md", "tests/README.md", "SECURITY.md", "CHANGELOG.md",
    "CONTRIBUTING.md",
]  # fmt: skip


def own_pages(pages: Pages) -> None:
    """Copies the pages of this directory and the files that they show."""
    for path in HERE.iterdir():
        if path.suffix == ".md" and path.name != "README.md":
            pages.write(path.name, path.read_text(encoding="utf-8"))
        elif path.name.startswith("comparison_"):
            pages.copy(path, path.name)


def included_pages(pages: Pages) -> None:
    """Includes the READMEs of the tree. Writes the pages that list directories and published tables."""
    for path in INCLUDED:
        pages.include(path)
    folders = sorted(
        str(path.relative_to(TOP))
        for part in ("src", "integrators", "tests", "experiments")
        for path in (TOP / part).rglob("README.md")
        if str(path.relative_to(TOP)) not in INCLUDED
    )
    directories = "\n".join(f"{Path(path).parent} <{pages.include(path)[:-3]}>" for path in folders)
    others = sorted(
        str(path.relative_to(pages.folder).with_suffix(""))
        for path in pages.written()
        if path.suffix == ".md" and path.is_relative_to(pages.folder / "tree/results") and path.name != "README.md"
    )
    results = "\n".join(f"{Path(path).name} <{path}>" for path in others)
    pages.write(
        "directories.md",
        "# Directories of the source tree\n\nThe README of each directory.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{directories}\n```\n",
    )
    pages.write(
        "results.md",
        "# Published tables\n\nThe tables that [Results](tree/results/README.md) quotes.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{results}\n```\n",
    )


def main() -> int:
    """Parses the command line, which `build` passes, and writes all pages. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--output", type=Path, required=True, help="directory of the generated pages")
    parser.add_argument("--work", type=Path, required=True, help="directory of files kept between builds")
    parser.add_argument("--site", type=Path, required=True, help="directory of the site that Sphinx writes")
    options = parser.parse_args()
    pages = Pages(options.output, TOP)
    program = Program(options.program, options.work / "program")
    own_pages(pages)
    included_pages(pages)
    try:
        scene_pages(pages, program)
        method_page(pages, program)
        experiment_page(pages, program)
        command_page(pages, program)
        key_page(pages, program)
        column_pages(pages, program)
        cpp_pages(pages, read_headers(TOP, options.work / "doxygen"))
        python_page(pages)
        comparison_outputs(pages, HERE, options.work / "comparison", options.program)
        notebook_pages(pages, TOP, options.work / "notebooks", options.program)
        gallery_page(pages, program, TOP, options.work / "gallery", options.work / "notebooks")
    except (RuntimeError, subprocess.CalledProcessError) as fault:
        print(f"documentation: {fault}", file=sys.stderr)
        if isinstance(fault, subprocess.CalledProcessError) and fault.stderr:
            print(fault.stderr if isinstance(fault.stderr, str) else fault.stderr.decode(), file=sys.stderr)
        return 1
    for page in pages.finish():
        (options.site / page.relative_to(pages.folder)).with_suffix(".html").unlink(missing_ok=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
