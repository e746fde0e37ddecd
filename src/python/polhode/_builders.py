"""Functions that build the objects of a scene from keyword arguments, such as `body`, `revolute` and `gravity`.

The functions, their parameters and their docstrings are made from the table of the keys of scene files, which the
reader of scene files uses, too. A new key or type in that table is a new parameter or function here.
"""

from __future__ import annotations

import inspect
import keyword
from collections.abc import Callable
from typing import Any

from polhode import _polhode

#: A function that builds an object of a scene.
Builder = Callable[..., "Built"]


class Built(dict):  # type: ignore[type-arg]
    """An object of a scene, with the name of the function that built it, for messages."""

    __slots__ = ("builder", "arguments")

    def __init__(self, data: dict[str, Any], builder: str, arguments: dict[str, str]) -> None:
        super().__init__(data)
        self.builder = builder
        #: The argument from which the value at each path below this object comes: {"initial/angle": "angle"}.
        self.arguments = arguments


#: Objects of the table that a function is named after otherwise than by its last word, and their summaries.
_NAMED = {
    "initial": ("initial", "Builds the initial state of a body."),
    "plane": ("plane", "Builds a plane that the body collides with."),
    "one of bodies": ("named_body", "Builds one of several bodies."),
    "part": ("part", "Builds a part of a body: the arguments of `body`, and its place."),
}

#: Prefixes of the objects of the table that have a type: key of the type, name of the function, summary.
_TYPED = {
    "load ": ("", "Builds a load: {}."),
    "joint ": ("", "Builds a joint: {}."),
    "loop ": ("loop_", "Builds a constraint that closes a chain of joints: {}."),
    "shape ": ("", "Builds a shape: {}."),
}


class _Parameter:
    """A parameter of a function: its argument, the path of its value in the object, and its documentation."""

    def __init__(self, row: tuple[str, ...], below: str = "", optional: bool = False) -> None:
        _, self.key, self.type, self.unit, self.default, self.example, self.meaning = row
        self.name = self.key + "_" if keyword.iskeyword(self.key) else self.key
        self.path = below + self.key
        self.required = self.default == "required" and not optional
        #: Required, perhaps only under a condition, such as "required without a formula".
        self.is_positional = self.default.startswith("required") and not optional

    def lines(self) -> list[str]:
        kind = self.type + ("" if self.required else ", optional")
        unit = f" Unit: {self.unit}." if self.unit else ""
        default = "" if self.required or self.default in ("required", "none") else f" Default: {self.default}."
        meaning = self.meaning[:1].upper() + self.meaning[1:]
        return [f"{self.name} : {kind}", f"    {meaning}.{unit}{default} Example: ``{self.example}``."]


def _arguments(ordered: list[_Parameter]) -> list[inspect.Parameter]:
    """The arguments of a function. After one that is required only under a condition, all have a default."""
    arguments = []
    default: Any = inspect.Parameter.empty
    for p in ordered:
        if not p.required:
            default = None
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if p.is_positional else inspect.Parameter.KEYWORD_ONLY
        arguments.append(inspect.Parameter(p.name, kind, default=default))
    return arguments


def _make(name: str, summary: str, parameters: list[_Parameter], fixed: dict[str, str]) -> Builder:
    ordered = sorted(parameters, key=lambda p: not p.is_positional)

    def build(*values: Any, **named: Any) -> Built:
        bound = signature.bind(*values, **named).arguments
        data: dict[str, Any] = dict(fixed)
        arguments = {}
        for parameter in ordered:
            if parameter.name not in bound or (bound[parameter.name] is None and not parameter.required):
                continue
            *outer, last = parameter.path.split("/")
            place = data
            for key in outer:
                place = place.setdefault(key, {})
            place[last] = bound[parameter.name]
            arguments[parameter.path] = parameter.name
        return Built(data, name, arguments)

    signature = inspect.Signature(_arguments(ordered), return_annotation=dict)
    lines = [summary, "", "Parameters", "----------", *(line for p in ordered for line in p.lines()), "", "Returns",
             "-------", "dict", "    The object as in a scene file; arguments that are omitted or None are not set."]
    build.__name__ = build.__qualname__ = name
    build.__module__ = "polhode"
    build.__doc__ = "\n    ".join(lines) + "\n    "
    build.__signature__ = signature  # type: ignore[attr-defined]
    return build


def _builders() -> dict[str, Builder]:
    objects: dict[str, list[tuple[str, ...]]] = {}
    for key in _polhode.scene_keys():
        objects.setdefault(key[0], []).append(key)

    body: dict[str, _Parameter] = {}
    for name, rows in objects.items():
        if name == "body" or name.startswith("body "):
            for row in rows:
                body.setdefault(row[1], _Parameter(row, optional=True))
    made = {"body": _make("body", "Builds a body from its mass properties, a shape, parts, points, a mesh or a file.",
                          list(body.values()), {})}
    for name, (function, summary) in _NAMED.items():
        parameters = [_Parameter(row) for row in objects.get(name, [])]
        if name == "part":
            known = {p.name for p in parameters}
            parameters = [p for p in body.values() if p.name not in known] + parameters
        made[function] = _make(function, summary, parameters, {})
    for name, rows in objects.items():
        for prefix, (before, summary) in _TYPED.items():
            if not name.startswith(prefix):
                continue
            kind = name[len(prefix):]
            meaning = next((row[6] for row in rows if row[1] == "type"), "a " + kind.replace("_", " "))
            start = objects.get("start " + kind, []) if prefix == "joint " else []
            parameters = [_Parameter(row) for row in rows
                          if row[1] != "type" and not (start and row[1] == "initial")]
            parameters += [_Parameter(row, "initial/") for row in start]
            made[before + kind] = _make(before + kind, summary.format(meaning), parameters, {"type": kind})
    return made


#: All functions by name.
BUILDERS: dict[str, Builder] = _builders()
