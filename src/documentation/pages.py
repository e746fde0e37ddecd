"""The directory that Sphinx reads: generated pages, and pages of the source tree with the files that they show."""

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

# Larger pages take minutes in Sphinx and load slowly in browsers. Pages link to the file itself instead.
LARGEST_PAGE = 120_000

_CODE = re.compile(r"^(```+|~~~+).*?^\1[ \t]*$|`[^`\n]+`", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)")


class Pages:
    """A directory of pages. `finish` removes the files that were not written since it was opened."""

    def __init__(self, folder: Path, top: Path) -> None:
        self.folder = folder
        self.top = top
        self._written: set[Path] = set()

    def write(self, name: str, text: str) -> None:
        """Writes a page. An unchanged page is not touched, so that Sphinx does not read it again."""
        path = self.folder / name
        self._written.add(path)
        if path.is_file() and path.read_text(encoding="utf-8") == text:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def copy(self, source: Path, name: str) -> None:
        """Copies a file that is not a page."""
        path = self.folder / name
        if path in self._written:
            return
        self._written.add(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.stat().st_mtime_ns != source.stat().st_mtime_ns:
            shutil.copy2(source, path)

    def include(self, path: str) -> str:
        """Copies a page of the source tree and the files that it links to. Returns the copy's name."""
        name = f"tree/{path}"
        if self.folder / name not in self._written:
            self._written.add(self.folder / name)
            text = (self.top / path).read_text(encoding="utf-8")
            if not text.startswith("# "):  # a file with only a table
                text = f"# {Path(path).stem}\n\n{text}"
            self.write_page(name, text, Path(path).parent)
        return name

    def write_page(self, name: str, text: str, origin: Path) -> None:
        """Writes Markdown under tree/ whose links are relative to `origin`, a directory of the source tree."""
        self.write(name, _outside_code(text, lambda part: _LINK.sub(lambda link: self._link(link, origin), part)))

    def _link(self, link: re.Match[str], origin: Path) -> str:
        image, words, target = link.groups()
        if re.match(r"[a-z]+:|#", target):
            return link[0]
        target, _, anchor = target.partition("#")
        inside = Path(os.path.normpath(origin / target))
        if self.folder / "tree" / inside in self._written and image:  # a figure that a notebook drew
            return link[0]
        path = self.top / inside
        if (path / "README.md").is_file():
            inside, path = inside / "README.md", path / "README.md"
        if inside.parts[0] == ".." or not path.is_file():
            return words
        if inside.parent == Path("src/documentation") and inside.name != "README.md" and path.suffix == ".md":
            # pages of this directory are copied to the top level
            anchor = f"#{anchor}" if anchor else ""
            return f"{image}[{words}]({os.path.relpath(inside.name, Path('tree') / origin)}{anchor})"
        if image or path.suffix != ".md":
            self.copy(path, f"tree/{inside}")
            suffix = ""
        elif path.stat().st_size > LARGEST_PAGE and path.name != "README.md":
            self.copy(path, f"tree/{inside}.txt")
            suffix, anchor = ".txt", ""
        else:
            self.include(str(inside))
            suffix = f"#{anchor}" if anchor else ""
        return f"{image}[{words}]({os.path.relpath(inside, origin)}{suffix})"

    def written(self) -> set[Path]:
        """Returns the files written so far."""
        return set(self._written)

    def finish(self) -> list[Path]:
        """Removes the files of earlier builds and returns their paths."""
        left = [path for path in self.folder.rglob("*") if path.is_file() and path not in self._written]
        for path in left:
            path.unlink()
        return left


def _outside_code(text: str, change: Callable[[str], str]) -> str:
    parts, end = [], 0
    for code in _CODE.finditer(text):
        parts += [change(text[end : code.start()]), code[0]]
        end = code.end()
    return "".join([*parts, change(text[end:])])
