"""Configuration of Sphinx, which reads the pages collected by generate.py, not this folder."""

import hashlib
import os
import re
import sys
from pathlib import Path
from typing import Any

from pygments.lexers.javascript import JavascriptLexer
from sphinx.application import Sphinx

_here = Path(os.environ["POLHODE_DOCUMENTATION"])
_top = _here.parents[1]
sys.path[:0] = [str(_here), *filter(None, os.environ.get("POLHODE_PYTHON", "").split(os.pathsep))]

_version = re.search(r"project\(polhode\s+VERSION\s+([0-9.]+)", (_top / "CMakeLists.txt").read_text())

project = "polhode"
author = "the polhode authors"
copyright = "the polhode authors, BSD-3-Clause"  # the name is Sphinx'
release = version = _version[1] if _version else ""
language = "en"
smartquotes = False  # keeps --option unchanged

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "numpydoc", "formulas", "theme"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
root_doc = "index"

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
suppress_warnings = ["myst.header"]  # a README may begin below its title

html_math_renderer = "katex"
math_eqref_format = "({number})"
math_number_all = False

nitpicky = True
# types of other libraries, and C++ names that no page declares
nitpick_ignore_regex = [("cpp:.*", ".*"), ("c:.*", ".*"), ("py:.*", r"(?!polhode\.).*")]
autosummary_generate = True
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

html_theme = "furo"
html_title = f"polhode {release}"
html_static_path = ["static"]
# a changed style changes this setting, so that Sphinx writes all pages again
html_css_files = ["polhode.css?" + hashlib.sha256((_here / "static/polhode.css").read_bytes()).hexdigest()[:8]]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f5f8b", "color-brand-content": "#1f5f8b"},
    "dark_css_variables": {"color-brand-primary": "#7db7e8", "color-brand-content": "#7db7e8"},
}
pygments_style = "friendly"
pygments_dark_style = "native"


def setup(app: Sphinx) -> dict[str, Any]:
    """Highlights JSON with comments, which Pygments does not support, as JavaScript."""
    app.add_lexer("jsonc", JavascriptLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
