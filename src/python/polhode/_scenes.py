"""Scenes: bodies, initial state, loads."""

from __future__ import annotations

import functools
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, SupportsIndex, Union

import numpy as np

from polhode import _polhode
from polhode._builders import Built
from polhode._html import table_html
from polhode.symbols import Formula

#: Types that `scene` makes a scene from.
SceneLike = Union["Scene", str, "os.PathLike[str]", Mapping[str, Any]]


def _plain(value: Any) -> Any:
    """Converts values that JSON does not support: formulas, numpy arrays and numbers, and paths."""
    if isinstance(value, Formula):
        return str(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene contains a {type(value).__name__}; give numbers, strings, formulas, lists, arrays "
                    "or dicts")


class Changes:
    """Number of changes of a scene, shared by all its blocks."""

    count = 0


def _comfortable(value: Any, changes: Changes) -> Any:
    """Returns a copy with all objects and lists as blocks, recursively, whose changes are counted."""
    if isinstance(value, Mapping):
        return Block(value, changes)
    if isinstance(value, (list, tuple)):
        return Blocks(value, changes)
    if isinstance(value, np.ndarray):
        return Blocks(value.tolist(), changes) if value.ndim else value.item()
    return value


def _counted(base: type, name: str) -> Callable[..., Any]:
    plain = getattr(base, name)

    @functools.wraps(plain)
    def method(self: Any, *arguments: Any, **named: Any) -> Any:
        self._changes.count += 1
        return plain(self, *arguments, **named)

    return method


class Blocks(list):  # type: ignore[type-arg]
    """A JSON array. The keys of its objects are attributes."""

    __slots__ = ("_changes",)

    def __init__(self, values: Iterable[Any], changes: Changes) -> None:
        self._changes = changes
        super().__init__(_comfortable(value, changes) for value in values)

    def __reduce__(self) -> tuple[Any, ...]:
        return (list, (list(self),))

    def append(self, value: Any) -> None:
        self._changes.count += 1
        super().append(_comfortable(value, self._changes))

    def extend(self, values: Iterable[Any]) -> None:
        self._changes.count += 1
        super().extend([_comfortable(value, self._changes) for value in values])

    def insert(self, place: SupportsIndex, value: Any) -> None:
        self._changes.count += 1
        super().insert(place, _comfortable(value, self._changes))

    def __setitem__(self, place: Any, value: Any) -> None:
        self._changes.count += 1
        super().__setitem__(place, _comfortable(value, self._changes))

    def __iadd__(self, values: Iterable[Any]) -> Blocks:  # type: ignore[misc]
        self.extend(values)
        return self

    def copy(self) -> Blocks:
        return Blocks(self, Changes())


class Block(dict):  # type: ignore[type-arg]
    """A JSON object: a dict whose keys are also attributes."""

    __slots__ = ("_changes", "_built")
    _changes: Changes
    _built: tuple[str, dict[str, str]] | None  #: the function that built it, and its arguments by path

    def __init__(self, data: Mapping[str, Any], changes: Changes) -> None:
        built = (data.builder, data.arguments) if isinstance(data, Built) else getattr(data, "_built", None)
        object.__setattr__(self, "_changes", changes)
        object.__setattr__(self, "_built", built if isinstance(built, tuple) else None)
        super().__init__({key: _comfortable(value, changes) for key, value in data.items()})

    def __reduce__(self) -> tuple[Any, ...]:
        return (dict, (dict(self),))

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no {name}; the keys are {', '.join(self)}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value

    def __delattr__(self, name: str) -> None:
        try:
            del self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __setitem__(self, name: str, value: Any) -> None:
        self._changes.count += 1
        super().__setitem__(name, _comfortable(value, self._changes))

    def update(self, *arguments: Any, **named: Any) -> None:
        for name, value in dict(*arguments, **named).items():
            self[name] = value

    def __ior__(self, other: Any) -> Block:  # type: ignore[misc]
        self.update(other)
        return self

    def setdefault(self, name: str, default: Any = None) -> Any:
        if name not in self:
            self[name] = default
        return self[name]

    def copy(self) -> Block:
        return Block(self, Changes())

    def __dir__(self) -> Iterator[str]:
        yield from super().__dir__()
        yield from self


def _expression_at(scene: Block, path: str) -> str:
    """Returns the Python expression of the value at a JSON pointer, and the argument that it was built from."""
    expression, built = "scene", ""
    place: Any = scene
    names = [name.replace("~1", "/").replace("~0", "~") for name in path.split("/")[1:]]
    for k, name in enumerate(names):
        if isinstance(place, Block) and place._built is not None:
            builder, arguments = place._built
            below = "/".join(names[k:])
            argument = next((a for p, a in arguments.items() if below == p or below.startswith(p + "/")), name)
            built = f", {builder}(.., {argument}=..)"
        expression += f"[{name}]" if name.isdigit() else f".{name}" if name.isidentifier() else f"[{name!r}]"
        try:
            place = place[int(name)] if isinstance(place, list) else place[name]
        except (KeyError, IndexError, TypeError, ValueError):
            place = None
    return expression + built


def _with_expression(scene: Block, message: str) -> str:
    """Returns the message of an error in a scene, followed by the Python expression of its place."""
    found = re.match(r"[^/]*: (/[^\s:]+): ", message)
    if found is None:
        return message
    return f"{message} (in Python: {_expression_at(scene, found.group(1))})"


for _name in ("__delitem__", "pop", "popitem", "clear"):
    setattr(Block, _name, _counted(dict, _name))
for _name in ("__delitem__", "pop", "remove", "clear", "sort", "reverse", "__imul__"):
    setattr(Blocks, _name, _counted(list, _name))


class Scene(Block):
    """A scene: the JSON of a scene file as a dict whose keys are also attributes.

    The contents are checked when the scene is used. Unknown keys and invalid values raise `InputError` with place,
    fault and remedy in one line.

    Examples
    --------
    >>> import polhode
    >>> top = polhode.scene("lagrange_top")
    >>> top.duration = 5
    >>> top["body"]["mass"] = 1.5
    >>> top.loads.append({"type": "torque", "vector": [0, 0, 0.1], "frame": "body"})
    >>> polhode.solve(top, samples=10).t[-1]
    5.0
    """

    __slots__ = ("_torques", "_file", "_directory", "_read")
    _torques: list[tuple[Callable[[_polhode.LoadState], Any], str, float | None, float | None]]
    _file: str
    _directory: str
    _read: tuple[int, _polhode.ReadScene] | None

    def __init__(self, data: Mapping[str, Any], file: str = "the scene", directory: str = "") -> None:
        super().__init__(data, Changes())
        for name, value in {"_torques": [], "_file": file, "_directory": directory, "_read": None}.items():
            object.__setattr__(self, name, value)

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self.copy()

    __copy__ = lambda self: self.copy()  # noqa: E731

    def __reduce__(self) -> tuple[Any, ...]:
        if self._torques:
            raise TypeError("a scene with a user-defined torque cannot be pickled; add the torque after unpickling")
        return (Scene, (json.loads(self.json()), self._file, self._directory))

    def copy(self, **changes: Any) -> Scene:
        """Returns a copy of the scene with some keys changed.

        Parameters
        ----------
        **changes
            Keys of the scene and their new values.

        Returns
        -------
        Scene
            A deep copy that shares only the functions of user-defined torques.
        """
        other = Scene(self, self._file, self._directory)
        other._torques.extend(self._torques)
        for name, value in changes.items():
            other[name] = value
        return other

    def add_torque(
        self,
        function: Callable[[_polhode.LoadState], Any],
        *,
        name: str = "",
        start: float | None = None,
        until: float | None = None,
    ) -> Scene:
        """Adds a user-defined torque, smooth in its arguments, to a scene of one body.

        The truth is not available for such a scene, and methods that need derivatives report ``unsupported``. The same
        law as a formula (a load with the key ``formula``, or `polhode.symbols`) has both and is faster.

        Parameters
        ----------
        function : callable
            Called with the current state (`LoadState`: ``t``, ``q``, ``w_B``, ``p``, ``v``), possibly from several
            threads. Returns three numbers, the torque in body axes, N m.
        name : str, optional
            Name for messages. Default: the function's name.
        start, until : float, optional
            Times at which the torque starts and ends, s. Default: it acts all the time.

        Returns
        -------
        Scene
            This scene.

        Raises
        ------
        InputError
            If the scene has several bodies. Use a load of type ``torque`` or ``force`` with ``body``, or a motor on a
            joint, instead.

        Examples
        --------
        >>> import polhode
        >>> body = polhode.scene("free_asymmetric").copy(duration=2)
        >>> motion = polhode.solve(body.add_torque(lambda now: -0.1 * now.w_B), tolerance=1e-9)
        >>> motion.method, motion.status
        ('dop853', 'ok')
        """
        key = "bodies" if "bodies" in self else "import" if "import" in self else None
        if key is not None:
            raise _polhode.InputError(
                f"{self._file}: /{key}: defines several bodies, and user-defined torques support one body; append a "
                "load of type \"torque\" or \"force\" with \"body\", or a \"motor\" with \"joint\", to \"loads\"")
        self._changes.count += 1
        self._torques.append((function, name or getattr(function, "__name__", "torque"), start, until))
        return self

    def json(self, *, indent: int | None = None) -> str:
        """Returns the scene as the text of a scene file, without user-defined torques."""
        return json.dumps(self, default=_plain, indent=indent)

    def expanded(self) -> Scene:
        """Returns the scene with the bodies and joints of an imported robot in place of ``import``.

        Returns
        -------
        Scene
            A scene with the same motion that names no files.

        Examples
        --------
        >>> import polhode
        >>> arm = polhode.scene("mechanisms/arm6").expanded()
        >>> [joint.name for joint in arm.joints][:3]
        ['waist', 'shoulder', 'elbow']
        """
        other = Scene(json.loads(self._compiled().canonical()), self._file, self._directory)
        other._torques.extend(self._torques)
        return other

    def describe(self) -> str:
        """Describes mass properties, the system posed, omitted terms, invariants and conditioning.

        Returns
        -------
        str
            The output of ``polhode describe``.
        """
        return self._compiled().describe()

    @property
    def body_names(self) -> list[str]:
        """The names of the bodies of a scene of several bodies; empty for one body."""
        return self._compiled().bodies

    @property
    def omitted(self) -> list[str]:
        """Constructs of an imported robot file that change its motion and are not modelled; otherwise empty.

        Examples
        --------
        >>> import polhode
        >>> polhode.scene("t_handle").omitted
        []
        """
        return self._compiled().omitted

    @property
    def assumed(self) -> list[str]:
        """Values of an imported robot that its file does not state, or that were repaired; otherwise empty."""
        return self._compiled().assumed

    def _compiled(self) -> _polhode.ReadScene:
        # count before reading, so that changes made by another thread meanwhile are read the next time
        count = self._changes.count
        if self._read is not None and self._read[0] == count:
            return self._read[1]
        try:
            read = _polhode.ReadScene(self.json(), self._file, self._directory, self._torques)
        except _polhode.InputError as error:
            raise _polhode.InputError(_with_expression(self, str(error))) from None
        object.__setattr__(self, "_read", (count, read))
        return read

    def __repr__(self) -> str:
        return f"<polhode.Scene {self.get('name', '(unnamed)')}: {self.get('about', '')}>"

    def _repr_html_(self) -> str:
        rows = [[key, json.dumps(value, default=_plain)] for key, value in self.items()]
        rows += [["user-defined torque", name] for _, name, _, _ in self._torques]
        return table_html(["key", "value"], rows, caption=str(self.get("name", "")))


def scene(source: SceneLike | None = None, **changes: Any) -> Scene:
    """Makes a scene from a name, a file, a dict, or keyword arguments.

    Parameters
    ----------
    source : str, path, mapping or Scene, optional
        A built-in scene (see `scenes`), a scene file, or the contents of one. A mapping without a ``name`` gets the
        name "own".
    **changes
        Keys of the scene and their new values. Functions such as `body`, `revolute` and `gravity` build them.

    Returns
    -------
    Scene
        A new scene.

    Raises
    ------
    InputError
        If there is no scene of that name, or the file is invalid.

    Examples
    --------
    >>> import polhode
    >>> polhode.scene("t_handle").name
    't_handle'
    >>> box = polhode.scene({"duration": 10, "body": {"shape": {"type": "box", "half_extents": [1, 2, 3]}, "mass": 1},
    ...                      "initial": {"angular_velocity": [0.01, 2, 0]}})
    >>> polhode.solve(box).status
    'ok'
    >>> pendulum = polhode.scene(
    ...     duration=2,
    ...     bodies=[polhode.named_body("bar", polhode.body(shape=polhode.rod(1), mass=2))],
    ...     joints=[polhode.revolute("hinge", "world", "bar", [0, 1, 0], child_point=[0, 0, 0.5], angle=0.5)],
    ...     loads=[polhode.gravity([0, 0, -9.81])])
    >>> polhode.solve(pendulum, samples=10).joints["hinge"].angle.shape
    (11,)
    """
    if source is None:
        source = {}
    if isinstance(source, Scene):
        return source.copy(**changes)
    if isinstance(source, Mapping):
        made = Scene({"name": "own", **source})
    else:
        name = os.fspath(source)
        text, directory = _polhode.scene_text(name)
        made = Scene(json.loads(text), name, directory)
    for key, value in changes.items():
        made[key] = value
    return made


def describe(what: SceneLike) -> str:
    """Describes a scene, or a method given by its name.

    Parameters
    ----------
    what : scene, or str
        A scene or what `scene` makes one from, or the name of a method.

    Returns
    -------
    str
        The output of ``polhode describe``.

    Examples
    --------
    >>> import polhode
    >>> print(polhode.describe("taylor").splitlines()[0])
    taylor
    """
    if isinstance(what, str) and (text := _polhode.method_description(what)) is not None:
        return str(text)
    return scene(what).describe()


class Catalogue(list[tuple[str, str]]):
    """Names and descriptions; displayed as a table in a notebook."""

    def _repr_html_(self) -> str:
        return table_html(["name", "about"], [list(entry) for entry in self])


def scenes() -> Catalogue:
    """Lists the built-in scenes.

    Returns
    -------
    list of (str, str)
        Names and descriptions.

    Examples
    --------
    >>> import polhode
    >>> "free_asymmetric" in dict(polhode.scenes())
    True
    """
    return Catalogue((name, str(json.loads(_polhode.scene_text(name)[0]).get("about", ""))) for name in
                     _polhode.scene_names())
