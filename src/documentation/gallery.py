"""The gallery: a picture of every scene and notebook, drawn when the pages are built.

A scene's picture shows its bodies at several times (`Trajectory.strobe` of the Python module). It is drawn again only if
the scene or the drawing has changed. Scenes that cannot be solved in a few seconds show the part that was solved.
"""

import concurrent.futures
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

from pages import Pages
from program_pages import Program, escaped, slug
from python_pages import environment, notebook_paths, public_names

# seconds of CPU time for the motion of one scene
LONGEST = 10

_DRAW = """
import json, sys, warnings
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import polhode
warnings.simplefilter("ignore")
for line in sys.stdin:
    name, path = json.loads(line)
    fault = ""
    try:
        motion = polhode.solve(name, samples=240, max_seconds=float(sys.argv[1]))
        if len(motion.t) < 2:
            raise RuntimeError(motion.message or motion.status)
        figure = motion.strobe(size=(3.6, 3.6))
        figure.savefig(path, dpi=80, metadata={"Software": None})
        plt.close(figure)
    except Exception as error:
        fault = f"{type(error).__name__}: {error}"
    print(json.dumps([name, fault]), flush=True)
"""


def _key(program: Program, name: str) -> str:
    module = Path(__file__).resolve().parents[1] / "python/polhode/_animation.py"
    text = [program.output("show", name), _DRAW, module.read_text(encoding="utf-8")]
    return hashlib.sha256("\0".join(text).encode()).hexdigest()[:16]


def _draw(jobs: list[tuple[str, Path]]) -> dict[str, str]:
    """Draws pictures in one process. Returns the fault of each scene that has no picture."""
    request = "".join(json.dumps([name, str(path)]) + "\n" for name, path in jobs)
    done = subprocess.run([sys.executable, "-c", _DRAW, str(LONGEST)], input=request, capture_output=True, text=True,
                          check=False, env=environment())
    answers = {name: fault for name, fault in map(json.loads, done.stdout.splitlines())}
    return {name: answers.get(name, done.stderr.strip()[-300:]) for name, _ in jobs if answers.get(name, "lost")}


def scene_pictures(program: Program, work: Path) -> tuple[dict[str, Path], dict[str, str]]:
    """Returns the picture of each scene, and the faults of scenes without one."""
    work.mkdir(parents=True, exist_ok=True)
    names = [name for name, _ in program.entries("scenes")]
    pictures = {name: work / f"{slug(name)}-{_key(program, name)}.png" for name in names}
    missing = [(name, path) for name, path in pictures.items() if not path.is_file()]
    workers = os.cpu_count() or 1
    parts = [missing[i :: 4 * workers] for i in range(4 * workers)]
    faults: dict[str, str] = {}
    with concurrent.futures.ThreadPoolExecutor(workers) as threads:
        for found in threads.map(_draw, filter(None, parts)):
            faults |= found
    for old in set(work.glob("*.png")) - set(pictures.values()):
        old.unlink()
    return {name: path for name, path in pictures.items() if path.is_file()}, faults


def _table(cells: list[str]) -> str:
    """Returns a table of three columns."""
    rows = [cells[i : i + 3] for i in range(0, len(cells), 3)]
    lines = ["|   |   |   |", "| --- | --- | --- |"]
    lines += ["| " + " | ".join(row + [""] * (3 - len(row))) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def gallery_page(pages: Pages, program: Program, top: Path, work: Path, notebooks: Path) -> None:
    """Writes the gallery. `notebooks`: directory of the notebooks' pages with their figures."""
    title = "# Gallery\n\n"
    if public_names() is None:
        pages.write("gallery.md", title + "The pictures need the Python module, which was not available when these "
                    "pages were built.\n")
        return
    text = [title + "A picture of every notebook and of every scene, drawn when these pages were built. A scene's "
            "picture shows its bodies at several times, the earlier the paler, as `motion.strobe()` of the Python "
            "module draws them; a line is the path of the point furthest from the centre of mass, or of the centre of "
            "mass where there are several bodies.\n", "## Notebooks\n"]
    cells = []
    for path in notebook_paths(top):
        figures = sorted((notebooks / f"{path.stem}_files").glob("*.svg"), key=lambda one: int(one.stem.split("_")[1]))
        page = f"tree/{path.parent.relative_to(top)}/{path.stem}.md"
        heading = (notebooks / f"{path.stem}.md").read_text(encoding="utf-8").splitlines()[0].lstrip("# ")
        picture = ""
        if figures:
            name = f"gallery/notebook_{path.stem}.svg"
            pages.copy(figures[len(figures) // 2], name)
            picture = f"[![{escaped(heading)}]({name})]({page})<br>"
        cells.append(f"{picture}[{escaped(heading)}]({page})")
    text.append(_table(cells))
    pictures, faults = scene_pictures(program, work)
    parts: dict[str, list[str]] = {}
    for name, about in program.entries("scenes"):
        if name in pictures:
            file = f"gallery/{slug(name)}.png"
            pages.copy(pictures[name], file)
            image = f"![{escaped(about)}]({file})<br>"
        else:
            image = f"no picture: {escaped(faults.get(name, ''))}<br>"
        parts.setdefault(name.rpartition("/")[0], []).append(f"{image}[{escaped(name)}](scene-{slug(name)})")
    for part, scenes in parts.items():
        text += [f"## {escaped(part + '/') if part else 'Scenes of one body'}\n", _table(scenes)]
    pages.write("gallery.md", "\n".join(text))
