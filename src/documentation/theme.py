"""Corrects Debian's package of the theme furo 2022.12 for pages that are read from the disk.

Its script is an unbundled module, which browsers do not load from files; its style imports normalize.css from a web
server's root, and has no rule for systems that ask for dark colours. Where a later package has all that, nothing is
changed.
"""

import re
import shutil
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

_NORMALIZE = Path("/usr/share/javascript/normalize.css/normalize.css")


def _mend_script(scripts: Path) -> None:
    script = scripts / "furo.js"
    first, _, rest = script.read_text(encoding="utf-8").partition("\n")
    if first.startswith("import Gumshoe"):
        spy = (scripts / "gumshoe-patched.js").read_text(encoding="utf-8")  # defines window.Gumshoe
        script.write_text(spy + rest, encoding="utf-8")


def _mend_style(styles: Path) -> None:
    style = styles / "furo.css"
    text = style.read_text(encoding="utf-8")
    if "url(/javascript/normalize.css/normalize.css)" in text:
        shutil.copyfile(_NORMALIZE, styles / "normalize.css")
        text = text.replace("url(/javascript/normalize.css/normalize.css)", "url(normalize.css)")
    dark = re.search(r'body\[data-theme="dark"\] \{([^}]*)\}', text)
    if dark and "prefers-color-scheme" not in text:
        text += (
            '\n@media not print { @media (prefers-color-scheme: dark) {\nbody:not([data-theme="light"]) {'
            f"{dark[1]}}} }} }}\n"
        )
    style.write_text(text, encoding="utf-8")


def _mend(app: Sphinx, fault: Exception | None) -> None:
    static = Path(app.outdir) / "_static"
    if fault is None and app.builder.format == "html" and (static / "scripts/furo.js").is_file():
        _mend_script(static / "scripts")
        _mend_style(static / "styles")


def setup(app: Sphinx) -> dict[str, Any]:
    """Corrects the theme's files after each build."""
    app.connect("build-finished", _mend)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
