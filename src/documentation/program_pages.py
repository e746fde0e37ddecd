"""Reference pages of what the built program tells of itself: scenes, methods, experiments, commands, keys, columns."""

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
    """The program, and what it said before: a description of a scene may take half a second."""

    def __init__(self, path: Path, cache: Path) -> None:
        self._path = path
        self._cache = cache / hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        self._cache.mkdir(parents=True, exist_ok=True)
        for old in cache.iterdir():
            if old != self._cache:
                shutil.rmtree(old)

    def says(self, *arguments: str) -> str:
        """The standard output of one call."""
        kept = self._cache / (re.sub(r"[^\w.-]", "_", " ".join(arguments)) + ".txt")
        if not kept.is_file():
            done = subprocess.run([self._path, *arguments], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise RuntimeError(f"polhode {' '.join(arguments)}: {done.stderr.strip() or done.returncode}")
            kept.write_text(done.stdout, encoding="utf-8")
        return kept.read_text(encoding="utf-8")

    def lists(self, what: str) -> list[tuple[str, str]]:
        """Name and meaning of each of the scenes, methods and so on."""
        return [(one["name"], one["about"]) for one in json.loads(self.says("list", what, "--format", "json"))]

    def describes(self, names: list[str]) -> list[str]:
        """`describe` of each, several at a time."""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
            return list(threads.map(lambda name: self.says("describe", name), names))


def literal(text: str, language: str = "text") -> str:
    """A literal block."""
    return f"````{language}\n{text.rstrip()}\n````\n"


def wrapped(text: str, width: int = 98) -> str:
    """What the program prints, its long lines broken and continued below where their last column begins."""
    out = []
    for line in text.splitlines():
        column = max((gap.end() for gap in re.finditer(r"(?:^|\S)\s{2,}(?=\S)", line[:45])), default=0)
        out += textwrap.wrap(
            line, width, subsequent_indent=" " * column, drop_whitespace=True, break_on_hyphens=False,
            break_long_words=False, expand_tabs=False, replace_whitespace=False,
        ) or [""]  # fmt: skip
    return "\n".join(out)


def folded(title: str, block: str) -> str:
    """A block that is opened by a click."""
    return f"```{{raw}} html\n<details><summary>{title}</summary>\n```\n\n{block}\n```{{raw}} html\n</details>\n```\n"


def escaped(text: str) -> str:
    """Text in which nothing is Markdown's but what stands between backticks."""
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(part if i % 2 else re.sub(r"([\\*_\[\]<>|$#{}~])", r"\\\1", part) for i, part in enumerate(parts))


def scene_pages(pages: Pages, program: Program) -> None:
    """All scenes, a page for each part of the catalogue."""
    parts = {
        "": ("scenes", "Scenes of one body", "The catalogue of `experiments/scenes`."),
        "extreme": ("scenes_extreme", "Extreme scenes", "Where methods break; each family has one parameter."),
        "mechanisms": ("scenes_mechanisms", "Scenes of several bodies", "Bodies with joints and loops."),
    }
    grouped: dict[str, list[tuple[str, str]]] = {part: [] for part in parts}
    for name, about in program.lists("scenes"):
        grouped.setdefault(name.rpartition("/")[0], []).append((name, about))
    for part, scenes in grouped.items():
        file, title, about_part = parts.get(part, (f"scenes_{part}", f"Scenes of {part}/", ""))
        text = [f"# {title}\n\n{about_part} Each scene is shown as `polhode describe` tells it and as it is written.\n"]
        for (name, about), description in zip(scenes, program.describes([name for name, _ in scenes])):
            text += [f"(scene-{slug(name)})=\n## {escaped(name)}\n", f"{escaped(about)}.\n"]
            text.append(literal(wrapped(description)))
            text.append(folded(f"{name}.json", literal(program.says("show", name), "jsonc")))
        pages.write(f"reference/{file}.md", "\n".join(text))


def slug(name: str) -> str:
    """A name as a part of a label."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower())


def method_page(pages: Pages, program: Program) -> None:
    """All methods, each with what its descriptor says."""
    names = [name for name, _ in program.lists("methods")]
    text = [
        "# Methods\n\nEach method as `polhode describe` tells it. *Stable* is how far a step may reach by "
        "[linear theory](../theory.md#linear-stability-and-stiffness). The methods of a family stand side by side in "
        "[the table of all methods](../tree/integrators/README.md#all-methods), which also says what was left out.\n"
    ]
    for name, description in zip(names, program.describes(names)):
        blocks = description.split("\n\n")
        text.append(f"(method-{slug(name)})=\n## {escaped(name)}\n")
        text += [escaped(" ".join(block.split())) + "\n" for block in blocks[1:2]]
        facts = [line.strip().partition("  ") for block in blocks[2:] for line in block.splitlines() if line.strip()]
        text += [f"- *{key}*: {escaped(value.strip())}" for key, _, value in facts]
        text.append("")
    pages.write("reference/methods.md", "\n".join(text))


def experiment_page(pages: Pages, program: Program) -> None:
    """All experiments: what each will run."""
    experiments = program.lists("experiments")
    text = [
        "# Experiments\n\nEach experiment as `polhode describe` tells it. "
        "[Scenes and experiments](../tree/experiments/README.md#writing-an-experiment) says how to write one.\n"
    ]
    for (name, about), description in zip(experiments, program.describes([name for name, _ in experiments])):
        text += [f"## {escaped(name)}\n", f"{escaped(about)}\n"]
        text.append(folded("What it runs", literal(wrapped(description))))
    pages.write("reference/experiments.md", "\n".join(text))


def command_page(pages: Pages, program: Program) -> None:
    """Each command's help, as it prints it."""
    top = program.says("--help")
    commands = re.findall(r"^  ([a-z]+) +\S", top.partition("Subcommands:")[2], re.MULTILINE)
    text = [
        "# Commands\n\nWhat `--help` prints. [The page of the commands](../tree/src/app/README.md) has them in a "
        "table, with exit codes.\n",
        literal(wrapped(top)),
    ]
    for command in commands:
        text += [f"## polhode {command}\n", literal(wrapped(program.says(command, "--help")))]
    pages.write("reference/commands.md", "\n".join(text))


def key_page(pages: Pages, program: Program) -> None:
    """Every key of scene and experiment files, a table for each object that has keys."""
    head = "| key | type | default | meaning | example |\n| --- | --- | --- | --- | --- |"
    text = ["# Keys of scene and experiment files\n\nEvery key that a file may have, by the object that has it.\n"]
    for line in program.says("list", "keys", "--format", "markdown").splitlines()[2:]:
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        object_, key, type_, unit, default, example, meaning = cells
        if object_:
            text.append(f"\n## {object_}\n\n{head}")
        if example:  # as code, where nothing but | is escaped
            example = "`" + re.sub(r"\\(?!\|)(.)", r"\1", example) + "`"
        text.append(f"| `{key}` | {', '.join(filter(None, (type_, unit)))} | {default} | {meaning} | {example} |")
    pages.write("reference/keys.md", "\n".join(text) + "\n")


def column_pages(pages: Pages, program: Program) -> None:
    """Columns of trajectories and of results."""
    titles = {
        "columns": ("Columns of trajectories", "The columns of trajectory files, found by name."),
        "metrics": ("Columns of results", "The columns of result tables that measure something."),
    }
    for what, (title, about) in titles.items():
        table = program.says("list", what, "--format", "markdown")
        pages.write(f"reference/{what}.md", f"# {title}\n\n{about}\n\n{table}")
