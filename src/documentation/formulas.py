"""Renders formulas as HTML and MathML by KaTeX when the pages are built. Pages need no scripts and no network.

KaTeX is Debian's libjs-katex, run by one Node process that answers each formula with a line. A formula that KaTeX does
not understand is a warning that names its place.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

from docutils import nodes  # type: ignore[import]
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

KATEX = Path("/usr/share/javascript/katex")

_PROGRAM = """
const katex = require(process.argv[1] + '/katex.min.js');
require('readline').createInterface({input: process.stdin}).on('line', line => {
    const {latex, display} = JSON.parse(line);
    let answer;
    try {
        answer = {html: katex.renderToString(latex, {displayMode: display, strict: 'error', throwOnError: true})};
    } catch (fault) {
        answer = {fault: fault.message};
    }
    process.stdout.write(JSON.stringify(answer) + '\\n');
});
"""

_logger = logging.getLogger(__name__)


class Katex:
    """A KaTeX process, started by the first formula. Caches its results."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._owner = 0  # pages are written by forked processes, each with a separate KaTeX
        self._made: dict[tuple[str, bool], str] = {}

    def html(self, latex: str, display: bool, node: nodes.Node) -> str:
        """The HTML of a formula. `display`: on a separate line. `node` is the place for errors."""
        key = (latex, display)
        if key not in self._made:
            answer = self._ask({"latex": latex, "display": display})
            if "fault" in answer:
                _logger.warning("formula: %s", answer["fault"], location=node)
            self._made[key] = answer.get("html", f"<code>{nodes.make_id(latex)}</code>")
        return self._made[key]

    def _ask(self, question: dict[str, Any]) -> dict[str, str]:
        if self._process is None or self._owner != os.getpid():
            self._owner = os.getpid()
            self._process = subprocess.Popen(
                ["node", "-e", _PROGRAM, str(KATEX)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        answer: dict[str, str] = json.loads(self._process.stdout.readline())
        return answer


_katex = Katex()


def _inline(writer: HTML5Translator, node: nodes.math) -> None:
    writer.body.append(f'<span class="math">{_katex.html(node.astext(), False, node)}</span>')
    raise nodes.SkipNode


def _displayed(writer: HTML5Translator, node: nodes.math_block) -> None:
    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    if node["number"]:
        number = get_node_equation_number(writer, node)
        writer.body.append(f'<span class="eqno">({number})')
        writer.add_permalink_ref(node, "Link to this equation")
        writer.body.append("</span>")
    writer.body.append(_katex.html(node.astext(), True, node) + "</div>\n")
    raise nodes.SkipNode


def _depart(writer: HTML5Translator, node: nodes.Node) -> None:
    """Nothing to write: the formula has been rendered."""


def _copy_style(app: Sphinx, fault: Exception | None) -> None:
    if fault is not None or app.builder.format != "html":
        return
    target = Path(app.outdir) / "_static" / "katex"
    (target / "fonts").mkdir(parents=True, exist_ok=True)
    shutil.copyfile(KATEX / "katex.min.css", target / "katex.min.css")
    for font in (KATEX / "fonts").glob("*.woff2"):
        shutil.copyfile(font, target / "fonts" / font.name)


def setup(app: Sphinx) -> dict[str, Any]:
    """Registers this module as the renderer `katex` of `html_math_renderer`."""
    app.add_html_math_renderer("katex", (_inline, _depart), (_displayed, _depart))
    app.add_css_file("katex/katex.min.css")
    app.connect("build-finished", _copy_style)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
