"""Writes a measured table as Markdown, with its provenance."""

from __future__ import annotations

import datetime
import json
import os
import platform
import sys
from pathlib import Path

import polhode


def write(directory: Path, name: str, head: list[str], rows: list[list[str]], versions: dict[str, str]) -> None:
    """Writes DIRECTORY/NAME.md and the entry NAME of provenance.json, and prints the table."""
    directory.mkdir(parents=True, exist_ok=True)
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in [head, *rows]]
    lines.insert(1, "| " + " | ".join("-" * width for width in widths) + " |")
    (directory / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    record = directory / "provenance.json"
    entries = json.loads(record.read_text(encoding="utf-8")) if record.exists() else {}
    cpu = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                if line.startswith("model name")), platform.machine())
    entries[name] = {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "command_line": f"tests/benchmarks/{Path(sys.argv[0]).name}",
        "versions": {"polhode": polhode.__version__, "Python": platform.python_version(), **versions},
        "cpu": cpu,
        "cores": os.cpu_count(),
    }
    record.write_text(json.dumps(entries, indent=2) + "\n", encoding="utf-8")
    print("\n".join(lines))
