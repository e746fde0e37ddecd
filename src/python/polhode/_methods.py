"""Methods, and the registration of user-defined methods."""

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
    """Description of a method.

    Attributes
    ----------
    name : str
        Name of the method.
    documentation : str
        One paragraph of Markdown.
    source : str
        Author, year, publication.
    conserves : str
        Quantities that the method conserves by construction.
    order : int or None
        Claimed order of the fixed-step method; None if it varies.
    control : str
        Accepted settings: "step", "tolerance", "step or tolerance" or "none".
    library : str
        The library that implements the steps.
    planes : bool
        Whether the method supports impacts on planes.
    dense : bool
        Whether the method computes values between its steps, which `Trajectory.at` requires.
    color : str
        Color of the method's family in figures, "#rrggbb".
    mark : str
        Marker of the method within its family: "circle", "square-open", ..
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
    """A list of methods; displayed as a table in a notebook."""

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
    """Lists all methods. User-defined methods are last.

    Returns
    -------
    list of Method
        Can also be indexed by name: ``methods()["taylor"]``.

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
    # the key of stored results: a new definition invalidates the results of the old one
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
    """Registers a step function as a method, which `solve`, `run` and their tables then take by name.

    Parameters
    ----------
    function : callable
        ``step(f, t, y, h)`` returns the state at t + h from the state y at t, with the right-hand side ``f(t, y)``. y
        is an ndarray with the variables of the scene's reduced formulation. One body: angular velocity in the axes
        that `describe` prints, attitude (w, x, y, z), then p and v if the centre of mass is integrated. Rotation about
        a fixed axis: rate, then cosine and sine of half the angle. Several bodies: joint coordinates, then rates.
    name : str, optional
        Name of the method. Default: the function's name. An existing user-defined method of that name is replaced.
    order : int, optional
        Claimed order; 0: not defined.
    source, conserves : str, optional
        Source and conserved quantities, for tables.

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
    """Registers a function that computes whole trajectories as a method, such as an engine or another library.

    Parameters
    ----------
    function : callable
        ``solve(scene, times, step, tolerance)`` returns a mapping with the motion at the times: ``q`` (n, 4) or
        (n, bodies, 4), ``w`` (world axes) and, if the bodies move, ``p`` and ``v``. Optional entries are ``steps`` and
        ``rhs_evaluations``. Either step or tolerance is None.
    name : str, optional
        Name of the method. Default: the function's name.
    control : str, optional
        Accepted settings: "step", "tolerance", "step or tolerance" or "none".
    order : int, optional
        Claimed order of a fixed-step method.
    source, conserves : str, optional
        Source and conserved quantities, for tables.

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
