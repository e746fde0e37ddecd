"""Helpers of the scripts in this folder: options, required programs, temporary folders, records."""
from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

sys.dont_write_bytecode = True
here = pathlib.Path(__file__).resolve().parent
top = here.parents[1]

SHARED = {
    "program": {"type": lambda name: pathlib.Path(name).resolve(), "default": top / "build" / "polhode"},
    "seed": {"type": int, "default": 1},
    "jobs": {"type": int, "default": os.cpu_count() or 1},
    "seconds": {"type": float, "default": math.inf},
    "only": {"default": ""},
    "sample": {"type": int, "default": 1},
    "record": {"action": "store_true"},
    "keep": {"action": "store_true"},
}


def make_parser(text: str, *shared: str) -> argparse.ArgumentParser:
    """Makes a parser that prints `text` as its help and has the named options of SHARED."""
    parser = argparse.ArgumentParser(usage="see --help", add_help=False, allow_abbrev=False)
    parser.add_argument("-h", "--help", action=PrintHelp, text=text)
    for name in shared:
        parser.add_argument(f"--{name}", **SHARED[name])
    return parser


class PrintHelp(argparse.Action):
    """Prints the script's description and exits."""

    def __init__(self, option_strings: list[str], dest: str, text: str) -> None:
        super().__init__(option_strings, dest, nargs=0)
        self.text = text

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(self.text.strip())
        parser.exit()


def require_programs(packages: str, *programs: str) -> None:
    """Exits with 2 unless all programs are installed."""
    for program in programs:
        if not shutil.which(program):
            print(f"{pathlib.Path(sys.argv[0]).name}: {program} not found; install {packages}", file=sys.stderr)
            sys.exit(2)


def compile_shim(name: str, folder: pathlib.Path) -> pathlib.Path:
    """Compiles NAME.c of this folder to a library for LD_PRELOAD."""
    require_programs("gcc", "cc")
    shim = folder / f"{name}.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", shim, here / f"{name}.c", "-ldl"], check=True)
    return shim


def fresh_copy(source: pathlib.Path, target: pathlib.Path) -> pathlib.Path:
    """Copies a folder onto another, whose files may be read-only."""
    if target.exists():
        subprocess.run(["chmod", "-R", "u+w", target], check=True)
        shutil.rmtree(target)
    return shutil.copytree(source, target)


def fast_place() -> str | None:
    """A folder in memory, where sync is fast; None if there is none."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


@contextlib.contextmanager
def work_folder(name: str, keep: bool = False, place: str | os.PathLike | None = None) -> Iterator[pathlib.Path]:
    """Makes a temporary folder, by default in TMPDIR or memory. Removes it at the end, or prints it if `keep`."""
    parent = place or os.environ.get("TMPDIR") or fast_place()
    folder = pathlib.Path(tempfile.mkdtemp(prefix=f"polhode-{name}-", dir=parent)).resolve()
    try:
        yield folder
    finally:
        if keep:
            print(folder)
        else:
            subprocess.run(["chmod", "-R", "u+w", folder])
            shutil.rmtree(folder, ignore_errors=True)


def replace_file(path: str | os.PathLike, text: str) -> None:
    """Writes a file atomically."""
    temporary = pathlib.Path(f"{path}.new")
    temporary.write_text(text)
    temporary.replace(path)


def cpu_name() -> str:
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def commit_hash() -> str:
    run = subprocess.run(["git", "-C", str(top), "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return run.stdout.strip() or "unknown"


def record(name: str, count: int, unit: str, failures: int, seconds: float, command: str,
           details: dict[str, object] | None = None) -> None:
    """Adds a record with commit, date and processor to results/reliability.json, or to the file POLHODE_RECORDS."""
    path = pathlib.Path(os.environ.get("POLHODE_RECORDS", top / "results" / "reliability.json"))
    records = json.loads(path.read_text()) if path.exists() else {}
    records[name] = {"count": count, "unit": unit, "failures": failures, "seconds": round(seconds, 1),
                     "command": f"tests/reliability/{command}",
                     "details": {key: str(value) for key, value in (details or {}).items()},
                     "date": time.strftime("%Y-%m-%d", time.gmtime()), "commit": commit_hash(), "cpu": cpu_name(),
                     "cores": os.cpu_count()}
    path.parent.mkdir(parents=True, exist_ok=True)
    replace_file(path, json.dumps(dict(sorted(records.items())), indent=2, ensure_ascii=False) + "\n")
