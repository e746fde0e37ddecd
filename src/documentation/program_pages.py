"""Reference pages from the output of the program: scenes, methods, experiments, commands, keys, columns."""

import concurrent.futures
import hashlib
import json
import os
import re
import shutil
import subprocess
import textwrap
from pathlib import Path

from pages import Pages


class Program:
    """The program, with a cache of its output: describing a scene may take half a second."""

    def __init__(self, path: Path, cache: Path) -> None:
        self._path = path
        self._cache = cache / hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        self._cache.mkdir(parents=True, exist_ok=True)
        for old in cache.iterdir():
            if old != self._cache:
                shutil.rmtree(old)

    def output(self, *arguments: str) -> str:
        """Returns the standard output of one call."""
        cached = self._cache / (re.sub(r"[^\w.-]", "_", " ".join(arguments)) + ".txt")
        if not cached.is_file():
            done = subprocess.run([self._path, *arguments], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise RuntimeError(f"polhode {' '.join(arguments)}: {done.stderr.strip() or done.returncode}")
            cached.write_text(done.stdout, encoding="utf-8")
        return cached.read_text(encoding="utf-8")

    def entries(self, what: str) -> list[tuple[str, str]]:
        """Returns the name and description of each scene, method or experiment."""
        return [(one["name"], one["about"]) for one in json.loads(self.output("list", what, "--format", "json"))]

    def descriptions(self, names: list[str]) -> list[str]:
        """Returns the output of `describe` for each name, computed in parallel."""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
            return list(threads.map(lambda name: self.output("describe", name), names))


def literal(text: str, language: str = "text") -> str:
    """Returns a literal block."""
    return f"````{language}\n{text.rstrip()}\n````\n"


def wrapped(text: str, width: int = 98) -> str:
    """Returns the program's output with long lines wrapped and indented to their last column."""
    out = []
    for line in text.splitlines():
        column = max((gap.end() for gap in re.finditer(r"(?:^|\S)\s{2,}(?=\S)", line[:45])), default=0)
        out += textwrap.wrap(
            line, width, subsequent_indent=" " * column, drop_whitespace=True, break_on_hyphens=False,
            break_long_words=False, expand_tabs=False, replace_whitespace=False,
        ) or [""]  # fmt: skip
    return "\n".join(out)


def folded(title: str, block: str) -> str:
    """Returns a block that opens on a click."""
    return f"```{{raw}} html\n<details><summary>{title}</summary>\n```\n\n{block}\n```{{raw}} html\n</details>\n```\n"


def escaped(text: str) -> str:
    """Returns text with Markdown characters escaped, except between backticks."""
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(part if i % 2 else re.sub(r"([\\*_\[\]<>|$#{}~])", r"\\\1", part) for i, part in enumerate(parts))


def scene_pages(pages: Pages, program: Program) -> None:
    """Writes one page of scenes for each part of the catalogue."""
    parts = {
        "": ("scenes", "Scenes of one body", "The catalogue of `experiments/scenes`."),
        "extreme": ("scenes_extreme", "Extreme scenes", "Scenes at which methods fail; each family has one parameter."),
        "mechanisms": ("scenes_mechanisms", "Scenes of several bodies", "Bodies with joints and loops."),
        "contact": ("scenes_contact", "Scenes of contact with friction", "One body that slides, rolls or bounces."),
        "formulas": ("scenes_formulas", "Scenes with formulas", "Loads given by formulas of time and state."),
    }
    grouped: dict[str, list[tuple[str, str]]] = {part: [] for part in parts}
    for name, about in program.entries("scenes"):
        grouped.setdefault(name.rpartition("/")[0], []).append((name, about))
    for part, scenes in grouped.items():
        file, title, about_part = parts.get(part, (f"scenes_{part}", f"Scenes of {part}/", ""))
        text = [f"# {title}\n\n{about_part} Each scene is shown as `polhode describe` prints it, and as JSON.\n"]
        for (name, about), description in zip(scenes, program.descriptions([name for name, _ in scenes])):
            text += [f"(scene-{slug(name)})=\n## {escaped(name)}\n", f"{escaped(about)}.\n"]
            text.append(literal(wrapped(description)))
            text.append(folded(f"{name}.json", literal(program.output("show", name), "jsonc")))
        pages.write(f"reference/{file}.md", "\n".join(text))


def slug(name: str) -> str:
    """Returns a name as a part of a label."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower())


def method_page(pages: Pages, program: Program) -> None:
    """Writes the page of methods with the contents of their descriptors."""
    names = [name for name, _ in program.entries("methods")]
    text = [
        "# Methods\n\nEach method as `polhode describe` prints it. *Stable* is the largest stable step according to "
        "[linear theory](../theory.md#linear-stability-and-stiffness). "
        "[The table of all methods](../tree/integrators/README.md#all-methods) lists them by family, and the methods "
        "that were considered and omitted.\n"
    ]
    for name, description in zip(names, program.descriptions(names)):
        blocks = description.split("\n\n")
        text.append(f"(method-{slug(name)})=\n## {escaped(name)}\n")
        text += [escaped(" ".join(block.split())) + "\n" for block in blocks[1:2]]
        facts = [line.strip().partition("  ") for block in blocks[2:] for line in block.splitlines() if line.strip()]
        text += [f"- *{key}*: {escaped(value.strip())}" for key, _, value in facts]
        text.append("")
    pages.write("reference/methods.md", "\n".join(text))


def experiment_page(pages: Pages, program: Program) -> None:
    """Writes the page of experiments with the runs of each."""
    experiments = program.entries("experiments")
    text = [
        "# Experiments\n\nEach experiment as `polhode describe` prints it. "
        "[Experiments](../tree/experiments/running.md#writing-an-experiment) explains how to write one.\n"
    ]
    for (name, about), description in zip(experiments, program.descriptions([name for name, _ in experiments])):
        text += [f"## {escaped(name)}\n", f"{escaped(about)}\n"]
        text.append(folded("Runs", literal(wrapped(description))))
    pages.write("reference/experiments.md", "\n".join(text))


def command_page(pages: Pages, program: Program) -> None:
    """Writes the page with the output of `--help` of each command."""
    top = program.output("--help")
    commands = re.findall(r"^  ([a-z]+) +\S", top.partition("Subcommands:")[2], re.MULTILINE)
    text = [
        "# Commands\n\nThe output of `--help`. [The page of the commands](../tree/src/app/README.md) lists them in a "
        "table, with exit codes.\n",
        literal(wrapped(top)),
    ]
    for command in commands:
        text += [f"## polhode {command}\n", literal(wrapped(program.output(command, "--help")))]
    pages.write("reference/commands.md", "\n".join(text))


def key_page(pages: Pages, program: Program) -> None:
    """Writes the page of all keys of scene and experiment files, with one table per object."""
    head = "| key | type | default | meaning | example |\n| --- | --- | --- | --- | --- |"
    text = ["# Keys of scene and experiment files\n\nAll keys, by the object to which they belong.\n"]
    for line in program.output("list", "keys", "--format", "markdown").splitlines()[2:]:
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        object_, key, type_, unit, default, example, meaning = cells
        if object_:
            text.append(f"\n## {object_}\n\n{head}")
        if example:  # as code, in which only | is escaped
            example = "`" + re.sub(r"\\(?!\|)(.)", r"\1", example) + "`"
        text.append(f"| `{key}` | {', '.join(filter(None, (type_, unit)))} | {default} | {meaning} | {example} |")
    pages.write("reference/keys.md", "\n".join(text) + "\n")


def column_pages(pages: Pages, program: Program) -> None:
    """Writes the pages of the columns of trajectories and results."""
    titles = {
        "columns": ("Columns of trajectories", "The columns of trajectory files, found by name."),
        "metrics": ("Columns of results", "The measures in result tables."),
    }
    for what, (title, about) in titles.items():
        table = program.output("list", what, "--format", "markdown")
        pages.write(f"reference/{what}.md", f"# {title}\n\n{about}\n\n{table}")
