"""Small runs of every command that writes files, for the scripts that make its system calls fail."""
from __future__ import annotations

import base64
import gzip
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import zlib

sweep = {"name": "sweep", "about": "two methods", "scenes": ["symmetric"], "methods": ["odeint_rk4", "cvode_adams"],
         "settings": {"steps": [0.1], "tolerances": [1e-6]}, "samples": 3, "repeats": 1}
study = {"name": "study", "about": "three floats", "kind": "inertia_shortcuts", "scenes": ["l_shape"]}
growth = {"name": "growth", "about": "with a curve over time", "kind": "conservation", "scenes": ["symmetric"],
          "methods": ["odeint_rk4"], "settings": {"evaluations_per_revolution": [100]}, "samples": 5, "repeats": 1}
short = ["--samples", "4", "--duration", "1"]
run = ["--output", "results", "--jobs", "1", "--quiet"]

# Name of each command: the folder of prepare() in which it starts, and its command line
commands: dict[str, tuple[str, list[str]]] = {
    "solve": ("plain", ["solve", "mechanisms/double_pendulum", *short, "--output", "out.csv", "--reactions", "more.csv"]),
    "truth": ("plain", ["truth", "symmetric", *short, "--output", "out.csv"]),
    "truth as JSON": ("plain", ["truth", "symmetric", *short, "--certified", "--format", "json", "--output", "out.json"]),
    "export": ("plain", ["export", "symmetric", *short, "--format", "cpp", "--output", "out.h"]),
    "describe": ("plain", ["describe", "symmetric", "--output", "out.txt"]),
    "describe --picture": ("plain", ["describe", "symmetric", "--picture", "out.svg"]),
    "plot": ("plain", ["plot", "in.csv", "--scene", "symmetric", "--output", "out.svg"]),
    "check --picture": ("plain", ["check", "symmetric", "in.csv", "--picture", "out.svg"]),
    "ensemble": ("plain", ["ensemble", "symmetric", "--initial", "bodies.csv", "--duration", "1", "--samples", "2",
                           "--threads", "1", "--output", "out.csv"]),
    "run sweep": ("plain", ["run", "sweep.json", *run]),
    "run study": ("plain", ["run", "study.json", *run]),
    "run growth": ("plain", ["run", "growth.json", *run]),
    "run resumed": ("half", ["run", "sweep.json", *run]),
    "merge": ("done", ["merge", "results", "--output", "merged"]),
    "report": ("done", ["report", "results", "--jobs", "1", "--quiet", "--output", "out.html"]),
}
old_text = "content before the run\n"
# output files that exist before the command runs
old_outputs = ["out.csv", "more.csv", "out.json", "out.h", "out.txt", "out.svg", "out.pdf", "out.html",
               "results/sweep.csv", "results/sweep.json", "merged/sweep.csv", "results/study.csv", "results/growth.csv"]
bodies = "wx,wy,wz\n1,2,3\n2,3,4\n0.1,5,1\n"


def environment(folder: pathlib.Path, **more: str) -> dict[str, str]:
    """A minimal environment that inherits only PATH. The cache and temporary files are in the folder."""
    return {"PATH": os.environ.get("PATH", "/usr/bin:/bin"), "HOME": str(folder), "POLHODE_CACHE": str(folder / "cache"),
            "TMPDIR": str(folder), "POLHODE_REPORT_PAGE": str(folder / "page.html"), "LC_ALL": "C.UTF-8", **more}


def call(program: pathlib.Path, arguments: list[str], folder: pathlib.Path, limit: float = 120,
         **more: str) -> subprocess.CompletedProcess:
    """Runs the program in the folder. Raises subprocess.TimeoutExpired."""
    return subprocess.run([str(program), *arguments], cwd=folder, env=environment(folder, **more),
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=limit)


def aborted_by_glibc(made: subprocess.CompletedProcess) -> bool:
    """Whether glibc aborted the run, as it does without memory to register the destructor of a thread's variable."""
    return made.returncode == -signal.SIGABRT and "Fatal glibc error" in made.stderr


def prepare(program: pathlib.Path, folder: pathlib.Path) -> None:
    """Makes folders to copy before each run: plain (inputs), done (with results), half (with some of the results)."""
    plain = folder / "plain"
    plain.mkdir(parents=True)
    for experiment in (sweep, study, growth):
        (plain / f"{experiment['name']}.json").write_text(json.dumps(experiment))
    (plain / "bodies.csv").write_text(bodies)
    # replaces the front-end of the report, which needs npm to build
    (plain / "page.html").write_text("<title><!--polhode:title--></title><!--polhode:data-->\n")
    made = call(program, ["solve", "symmetric", *short, "--output", "in.csv"], plain)
    if made.returncode != 0:
        raise SystemExit(f"{program} solve: {made.stderr.strip()}")
    done = folder / "done"
    shutil.copytree(plain, done)
    made = call(program, commands["run sweep"][1], done)
    if made.returncode != 0:
        raise SystemExit(f"{program} run: {made.stderr.strip()}")
    half = folder / "half"
    shutil.copytree(done, half)
    shutil.rmtree(half / "cache")
    for file in half.glob("results/*"):
        if file.is_file():
            file.unlink()
    cases = sorted(half.glob("results/.cases/*.csv"))
    for file in cases[: len(cases) // 2]:
        file.unlink()
    for of in (plain, half, done):
        for name in old_outputs:
            if (of / name).parent != of:
                (of / name).parent.mkdir(exist_ok=True)
            if not (of / name).exists():
                (of / name).write_text(old_text)


def contents(folder: pathlib.Path) -> dict[str, bytes]:
    """The contents of all files, except the cache, locks and times."""
    # the stored copy of an experiment contains the path of its file
    return {str(path.relative_to(folder)): re.sub(rb"/(at-[0-9]+|plain|half|done)/", b"/at/", path.read_bytes())
            if path.name.endswith(".experiment.json") else path.read_bytes() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.suffix not in (".lock", ".seconds") and path.name != "claims" and
            "cache" not in path.parts}


def temporaries(folder: pathlib.Path) -> list[str]:
    return [str(path.relative_to(folder)) for path in folder.rglob("*") if path.name.endswith((".new", ".tmp"))]


def document(page: bytes) -> object:
    """The data of a report page without its creation time; None if the page is not valid."""
    found = re.search(rb"H4sI[A-Za-z0-9+/=]+", page)
    try:
        data = json.loads(gzip.decompress(base64.b64decode(found.group()))) if found else {}
    except (ValueError, OSError, EOFError, zlib.error):
        return None
    return {key: value for key, value in data.items() if key != "made"} or None


class Reference:
    """The files that two undisturbed runs of a command leave. Files that differ between the two, as times do, are
    compared only by format and outline."""

    def __init__(self, first: dict[str, bytes], second: dict[str, bytes]) -> None:
        self.files, self.varies = first, {name for name in first if first[name] != second.get(name)}
        # times, which may agree when rounded, and the order of methods by time
        self.varies |= {name for name in first if name.endswith(("provenance.json", "out.json", ".html")) or
                        name.startswith(("results/sweep", "results/growth", "merged/sweep"))}
        if set(first) != set(second):
            raise SystemExit(f"two runs leave different files: {sorted(set(first) ^ set(second))}")

    @staticmethod
    def outline(text: bytes) -> list[tuple[int, bytes]]:
        """For each line, the number of cells, and the first cell unless it is a number."""
        return [(line.count(b","), re.sub(rb"[-+0-9.e]+.*", b"", line.split(b",")[0])) for line in text.splitlines()]

    def is_whole(self, name: str, text: bytes) -> bool:
        if name not in self.files:
            return False
        if name not in self.varies or text == self.files[name]:
            return text == self.files[name]
        if name.endswith(".csv"):
            return self.outline(text) == self.outline(self.files[name])
        if name.endswith(".json"):
            try:
                new, old = json.loads(text), json.loads(self.files[name])
            except ValueError:
                return False
            return type(new) is type(old) and len(new) == len(old)
        if name.endswith(".svg"):
            return text.rstrip().endswith(b"</svg>")
        if name.endswith(".pdf"):
            return text.startswith(b"%PDF") and text.rstrip().endswith(b"%%EOF")
        if name.endswith(".html"):
            return text.endswith(b"\n") and document(text) is not None and document(text) == document(self.files[name])
        # a page whose lines depend on measured times
        return text.splitlines()[:1] == self.files[name].splitlines()[:1] and text.endswith(b"\n")

    def differs(self, files: dict[str, bytes]) -> str:
        """Returns how these files differ from the reference, or an empty string."""
        if missing := sorted(set(self.files) - set(files)):
            return f"{missing[0]} is missing"
        if extra := sorted(set(files) - set(self.files)):
            return f"unexpected file {extra[0]}"
        wrong = [name for name in files if not self.is_whole(name, files[name])]
        return f"{wrong[0]} differs from an undisturbed run" if wrong else ""
