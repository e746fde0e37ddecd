"""The methods, and methods of one's own."""

from __future__ import annotations

import inspect
import json
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from polhode import _polhode
from polhode._html import table_html
from polhode._scenes import Scene
from polhode._solving import rows_of

_F = TypeVar("_F", bound=Callable[..., Any])


@dataclass(frozen=True)
class Method:
    """A method and what is known of it.

    Attributes
    ----------
    name : str
    documentation : str
        Markdown, a paragraph.
    source : str
        Author, year, where.
    conserves : str
        What it keeps by construction.
    order : int or None
        Claimed, of a fixed step; none where it varies.
    control : str
        "step", "tolerance", "step or tolerance" or "none".
    library : str
        Whose steps they are.
    planes : bool
        Whether it follows impacts on planes.
    dense : bool
        Whether it gives values between its steps, as `Trajectory.at` asks for.
    color : str
        That of its family in pictures, "#rrggbb".
    mark : str
        Its own within the family: "circle", "square-open", ..
    """

    name: str
    documentation: str
    source: str
    conserves: str
    order: int | None
    control: str
    library: str
    planes: bool
    dense: bool
    color: str
    mark: str


class Methods(list[Method]):
    """Methods; a table in a notebook."""

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            for one in self:
                if one.name == key:
                    return one
            raise KeyError(key)
        return super().__getitem__(key)

    def _repr_html_(self) -> str:
        rows = [[m.name, m.control, m.order or "", m.library, m.documentation.split(". ")[0]] for m in self]
        return table_html(["method", "setting", "order", "library", "about"], rows)


def methods() -> Methods:
    """All methods, those of one's own last.

    Returns
    -------
    list of Method
        Also by name: ``methods()["taylor"]``.

    Examples
    --------
    >>> import polhode
    >>> polhode.methods()["arkode_erk8"].order
    8
    """
    return Methods(Method(**entry) for entry in _polhode.methods())


def _add(function: Callable[..., Any], name: str | None, order: int, control: str, source: str, conserves: str,
         **how: Any) -> None:
    called = name or function.__name__
    about = inspect.getdoc(function) or "A user-defined method."
    # a name for what is kept of its runs: another definition has other results
    identity = uuid.uuid4().hex
    _polhode.add_method(called, " ".join(about.split()), source or "own", order, conserves or "nothing", control,
                        identity, **how)
    function.__polhode_method__ = called  # type: ignore[attr-defined]


def method(
    function: _F | None = None,
    *,
    name: str | None = None,
    order: int = 0,
    source: str = "",
    conserves: str = "",
) -> Any:
    """Makes a step function a method, by name like any other in `solve`, `run` and their tables.

    Parameters
    ----------
    function : callable
        ``step(f, t, y, h)`` gives the state at t + h from the state y at t, with the right-hand side ``f(t, y)``. y is
        an ndarray, whose length is the scene's: what a scene does not need is not in it. Of one body it holds the
        angular velocity in the axes that `describe` names, then the attitude (w, x, y, z), then, where the centre of
        mass is solved for, p and v; of a turn about one axis the rate, then cosine and sine of half the angle; of
        several bodies the joints' coordinates, then their rates.
    name : str, optional
        The function's own if not given. Defined again, it replaces what was so called.
    order : int, optional
        Claimed; 0: none.
    source, conserves : str, optional
        What tables say of it.

    Returns
    -------
    callable
        The function itself.

    Examples
    --------
    >>> import polhode
    >>> @polhode.method(order=2)
    ... def heun(f, t, y, h):
    ...     "Heun's method: the mean of the rates at both ends."
    ...     k = f(t, y)
    ...     return y + h / 2 * (k + f(t + h, y + h * k))
    >>> coarse, fine = (polhode.solve("lagrange_top", heun, step=h, duration=1).errors().max["attitude"]
    ...                 for h in (1e-3, 5e-4))
    >>> round(coarse / fine, 1)
    4.0
    """

    def made(step: _F) -> _F:
        _add(step, name, order, "step", source, conserves, step=step, solve=None)
        return step

    return made if function is None else made(function)


def solver(
    function: _F | None = None,
    *,
    name: str | None = None,
    control: str = "tolerance",
    order: int = 0,
    source: str = "",
    conserves: str = "",
) -> Any:
    """Makes a function that gives whole trajectories a method: an engine, another library.

    Parameters
    ----------
    function : callable
        ``solve(scene, times, step, tolerance)`` gives a mapping with ``q`` (n, 4) or (n, bodies, 4), ``w`` (world
        axes) and, where the bodies move, ``p`` and ``v``, at the times; also ``steps`` and ``rhs_evaluations``, where
        they are known. Of step and tolerance one is None.
    name : str, optional
        The function's own if not given.
    control : str, optional
        "step", "tolerance", "step or tolerance" or "none": what it is told.
    order : int, optional
        Claimed, of a fixed step.
    source, conserves : str, optional
        What tables say of it.

    Returns
    -------
    callable
        The function itself.

    Examples
    --------
    >>> import numpy as np, polhode
    >>> from scipy.integrate import solve_ivp
    >>> @polhode.solver
    ... def scipy_dop853(scene, times, step, tolerance):
    ...     I, w = np.array(scene.body.inertia), np.array(scene.initial.angular_velocity)
    ...     def rates(t, y):
    ...         q, w = y[:4], y[4:]
    ...         turn = [-q[1:] @ w, *(q[0] * w + np.cross(q[1:], w))]
    ...         return [*(np.array(turn) / 2), *(np.cross(I * w, w) / I)]
    ...     found = solve_ivp(rates, (0, times[-1]), [1, 0, 0, 0, *w], "DOP853", times, rtol=tolerance, atol=tolerance)
    ...     q, w_B = found.y[:4].T, found.y[4:].T
    ...     turned = np.cross(q[:, 1:], w_B) + q[:, :1] * w_B
    ...     return {"q": q, "w": w_B + 2 * np.cross(q[:, 1:], turned), "rhs_evaluations": found.nfev}
    >>> polhode.solve("free_asymmetric", scipy_dop853, tolerance=1e-10).errors().max["attitude"] < 1e-6
    True
    """

    def made(solve: _F) -> _F:
        def rows(text: str, directory: str, times: Sequence[float], step: float | None, tolerance: float | None,
                 seconds: float) -> tuple[Any, int, int]:
            posed = Scene(json.loads(text), "the scene", directory)
            found: Mapping[str, Any] = solve(posed, np.array(times), step, tolerance)
            numbers = rows_of(found["q"], *(found.get(block) for block in ("w", "p", "v")))
            return numbers, int(found.get("steps", 0)), int(found.get("rhs_evaluations", 0))

        _add(solve, name, order, control, source, conserves, step=None, solve=rows)
        return solve

    return made if function is None else made(function)
