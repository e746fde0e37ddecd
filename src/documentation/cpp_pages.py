"""Reference pages of the C++ interface, from Doxygen's XML of the installed headers."""

import re
import subprocess
import xml.etree.ElementTree as xml
from dataclasses import dataclass, field
from pathlib import Path

from sphinx.domains.cpp import DefinitionParser
from sphinx.util.cfamily import DefinitionError

from pages import Pages

Element = xml.Element

# titles of the directories of headers; other directories are listed under their names
FOLDERS = {
    "scene": "Scenes",
    "motion": "Motion: problems, systems, trajectories",
    "integrators": "Methods, drivers and the truth",
    "measure": "Errors",
    "body": "Bodies, vectors and quaternions",
    "table": "Tables",
    "text": "Messages",
    "app": "The laboratory",
}


@dataclass
class Declaration:
    """A public declaration as a directive of the C++ domain of Sphinx, with its members."""

    file: str
    line: int
    directive: str
    signature: str
    text: list[str]
    inner: list["Declaration"] = field(default_factory=list)

    def lines(self, indent: str = "") -> list[str]:
        """Returns the directive and its content."""
        if _parses(self.directive, self.signature):
            out = [f"{indent}.. cpp:{self.directive}:: {self.signature}", ""]
        else:  # C++ that Sphinx does not support
            out = [f"{indent}.. code-block:: cpp", "", f"{indent}   {self.signature}", ""]
        below = indent + "   " if out[0].lstrip().startswith(".. cpp:") else indent
        for paragraph in self.text:
            out += [*(below + line if line else "" for line in paragraph.splitlines()), ""]
        for one in self.inner:
            out += one.lines(below)
        return out


class _Config:
    cpp_id_attributes: list[str] = []
    cpp_paren_attributes: list[str] = []


def _parses(directive: str, signature: str) -> bool:
    try:
        parser = DefinitionParser(signature, location=None, config=_Config())  # type: ignore[arg-type]
        kind = {"struct": "class", "var": "member", "enum-class": "enum"}.get(directive, directive)
        parser.parse_declaration(kind, directive)
        parser.assert_end()
    except DefinitionError:
        return False
    return True


def read_headers(top: Path, folder: Path) -> Path:
    """Writes Doxygen's XML of the public headers. Returns its directory."""
    subprocess.run(
        ["cmake", f"-DSOURCE={top}", f"-DOUTPUT={folder}/include", "-P", str(top / "src/public_headers.cmake")],
        check=True, capture_output=True,
    )  # fmt: skip
    settings = (top / "tests/Doxyfile").read_text(encoding="utf-8") + (
        f"\nINPUT = {folder}/include/polhode\nOUTPUT_DIRECTORY = {folder}\n"
        f"STRIP_FROM_PATH = {folder}/include\nSTRIP_FROM_INC_PATH = {folder}/include\n"
        "GENERATE_HTML = NO\nGENERATE_XML = YES\n"
    )
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True, capture_output=True)
    return folder / "xml"


def cpp_pages(pages: Pages, source: Path) -> None:
    """Writes an overview of the headers and a page for each directory, from Doxygen's XML in `source`."""
    headers = {file: text for file, text in map(_header, sorted(source.glob("*_8h.xml")))}
    declarations = list(_namespace(source))
    found = {_folder(file) for file in headers} - {""}
    folders = sorted(found, key=lambda folder: [*FOLDERS, folder].index(folder))
    for folder in folders:
        title = FOLDERS.get(folder, folder)
        out = [title, "=" * len(title), "", ".. cpp:namespace:: polhode", ""]
        for file in sorted(file for file in headers if _folder(file) == folder):
            inside = sorted((one for one in declarations if one.file == file), key=lambda one: one.line)
            if not inside and not headers[file]:
                continue
            out += [file, "-" * len(file), ""]
            for paragraph in headers[file]:
                out += [paragraph, ""]
            for one in inside:
                out += one.lines()
        pages.write(f"reference/cpp_{folder}.rst", "\n".join(out) + "\n")
    overview = "\n\n".join(headers.get("polhode/polhode.h", []))
    toc = "\n".join(f"   cpp_{folder}" for folder in folders)
    pages.write(
        "reference/cpp.rst",
        "C++\n===\n\nAll public declarations of the installed headers. "
        f"``polhode/polhode.h`` includes everything that a program needs.\n\n{overview}\n\n.. toctree::\n\n{toc}\n",
    )


def _folder(file: str) -> str:
    return file.split("/")[1] if file.count("/") > 1 else ""


def _header(path: Path) -> tuple[str, list[str]]:
    compound = xml.parse(path).getroot().find("compounddef")
    assert compound is not None
    location = compound.find("location")
    assert location is not None
    return location.attrib["file"], _described(compound)


def _namespace(source: Path) -> list[Declaration]:
    compound = xml.parse(source / "namespacepolhode.xml").getroot().find("compounddef")
    assert compound is not None
    found = [one for member in compound.iter("memberdef") for one in _member(member)]
    for inner in [*compound.iter("innerclass"), *compound.iter("innerconcept")]:
        if inner.text and inner.text.count("::") == 1:
            found.append(_compound(source, inner.attrib["refid"]))
    for path in source.glob("concept*.xml"):
        if not any(one.directive == "concept" and one.signature.endswith(path.stem.split("_1_1")[-1]) for one in found):
            found.append(_compound(source, path.stem))
    return found


def _compound(source: Path, reference: str) -> Declaration:
    compound = xml.parse(source / f"{reference}.xml").getroot().find("compounddef")
    assert compound is not None
    name = re.split(r"::(?![^<]*>)", _plain(compound.find("compoundname")))[-1]
    kind = compound.attrib["kind"]
    location = compound.find("location")
    assert location is not None
    template = _template(compound) or ("template<> " if "<" in name else "")
    one = Declaration(
        location.attrib["file"], int(location.attrib["line"]), kind, template + _tidy(name), _described(compound)
    )
    if kind == "concept":
        initializer = _plain(compound.find("initializer")).partition("concept")[2].partition("=")[2]
        if initializer:
            one.text.append(".. code-block:: cpp\n\n   requires " + " ".join(initializer.split()))
        return one
    bases = [_tidy(_plain(base)) for base in compound.findall("basecompoundref")]
    if bases:
        one.signature += " : " + ", ".join(f"public {base}" for base in bases)
    for section in compound.findall("sectiondef"):
        if section.attrib["kind"].startswith("public"):
            one.inner += [found for member in section.findall("memberdef") for found in _member(member)]
    for inner in compound.findall("innerclass"):
        if inner.attrib.get("prot", "public") == "public":
            one.inner.append(_compound(source, inner.attrib["refid"]))
    one.inner.sort(key=lambda inside: inside.line)
    return one


def _member(member: Element) -> list[Declaration]:
    name, kind = _plain(member.find("name")), member.attrib["kind"]
    location = member.find("location")
    if location is None or not name or name.startswith("@") or kind not in ("function", "variable", "typedef", "enum"):
        return []
    type_, template = _tidy(_plain(member.find("type"))), _template(member)
    signature, directive, inner = f"{template}{type_} {name}".strip(), kind, []
    if kind == "function":
        requires = _plain(member.find("requiresclause"))
        signature += _tidy(_plain(member.find("argsstring")))
        signature = re.sub(r"\s*=\s*(default|delete)$", r" = \1", signature)
        if requires:
            signature = f"{template}requires {requires} {signature[len(template) :]}"
    elif kind == "variable":
        directive = "var"
        initializer = _plain(member.find("initializer"))
        signature += _plain(member.find("argsstring"))
        if initializer and "requires" not in initializer and "\n" not in initializer and len(initializer) < 50:
            signature += " = " + initializer.removeprefix("=").strip().replace("'", "")
    elif kind == "typedef":
        directive, signature = "type", f"{template}{name} = {type_}"
    else:
        directive = "enum-class" if member.attrib.get("strong") == "yes" else "enum"
        signature = name
        inner = [
            Declaration("", i, "enumerator", _plain(value.find("name")), _described(value))
            for i, value in enumerate(member.findall("enumvalue"))
        ]
    return [
        Declaration(
            location.attrib["file"], int(location.attrib["line"]), directive, signature, _described(member), inner
        )
    ]


def _template(element: Element) -> str:
    parameters = element.find("templateparamlist")
    if parameters is None:
        return ""
    out = []
    for parameter in parameters.findall("param"):
        type_, name, default = (_tidy(_plain(parameter.find(tag))) for tag in ("type", "declname", "defval"))
        out.append(f"{type_} {name}".strip() + (f" = {default}" if default else ""))
    return f"template<{', '.join(out)}> "


def _plain(element: Element | None) -> str:
    return "" if element is None else "".join(element.itertext()).strip()


def _tidy(text: str) -> str:
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"<\s+", "<", text)
    return re.sub(r"\s+>", ">", text)


def _described(element: Element) -> list[str]:
    paragraphs: list[str] = []
    for tag in ("briefdescription", "detaileddescription"):
        for paragraph in element.findall(f"{tag}/para"):
            paragraphs += _paragraph(paragraph)
    return paragraphs


def _paragraph(paragraph: Element) -> list[str]:
    """Returns the text and the blocks that Doxygen puts inside a paragraph, in order."""
    blocks, text = [], _escaped(paragraph.text)
    for child in paragraph:
        if child.tag in ("verbatim", "preformatted", "programlisting"):
            code = _listing(child) if child.tag == "programlisting" else "".join(child.itertext())
            blocks += [text, "::\n\n" + "\n".join("   " + line for line in code.strip("\n").splitlines())]
            text = ""
        elif child.tag in ("itemizedlist", "orderedlist"):
            items = [" ".join(" ".join(_paragraph(para)) for para in item) for item in child]
            blocks += [text, "\n".join(f"- {' '.join(item.split())}" for item in items)]
            text = ""
        elif child.tag == "computeroutput":
            text += f"``{''.join(child.itertext())}``"
        elif child.tag == "sp":
            text += " "
        elif child.tag == "ref":
            text += f"``{''.join(child.itertext())}``"
        else:
            text += _escaped("".join(child.itertext()))
        text += _escaped(child.tail)
    # inline literals must be separated from letters
    text = re.sub(r"(``[^`]+``)(?=\w)", r"\1\\ ", " ".join(text.split()))
    text = re.sub(r"(?<=\w)(``[^`]+``)", r"\\ \1", text)
    return [block for block in [*blocks, text] if block.strip()]


def _listing(element: Element) -> str:
    def text(node: Element) -> str:
        own = " " if node.tag == "sp" else node.text or ""
        return own + "".join(text(child) + (child.tail or "") for child in node)

    return "\n".join(text(line) for line in element.findall("codeline"))


def _escaped(text: str | None) -> str:
    return re.sub(r"([\\*`|_])", r"\\\1", text or "")
