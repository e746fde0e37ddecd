"""Derivatives of motions with respect to numbers of a scene, and least-squares fits of these numbers to data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._attitudes import matrices_of
from polhode._html import table_html
from polhode._scenes import Scene, SceneLike, scene as make_scene
from polhode._solving import Motion
from polhode._types import Array

if TYPE_CHECKING:
    import pandas as pd

#: Half the difference of a number on both sides, relative to its scale.
_STEP = 2.0**-42


class Derivative(NamedTuple):
    """The derivative of a motion with respect to one number."""

    rotation: Array  #: (.., 3): rotation vector of the change of the attitude, world axes, rad
    q: Array  #: (.., 4): derivative of the quaternion
    w: Array  #: (.., 3): derivative of the angular velocity, world axes
    w_B: Array  #: (.., 3): derivative of the angular velocity, body axes
    p: Array  #: (.., 3): derivative of the position of the centre of mass
    v: Array  #: (.., 3): derivative of the velocity of the centre of mass


class Sensitivity:
    """A motion and its derivatives with respect to numbers of the scene.

    ``sensitivity["/body/mass"]`` is the `Derivative` by the number at that JSON pointer, per unit of the number.

    Attributes
    ----------
    parameters : list of str
        JSON pointers of the numbers.
    motion : Motion
        The motion: t, q, w, p, v.
    rotation, w, p, v : ndarray, shape (n, 3, parameters) or (n, bodies, 3, parameters)
        Derivatives: of the attitude as a rotation vector in world axes (rad), of the angular velocity (world axes,
        rad/s), position (m) and velocity (m/s) of the centre of mass.
    steps : int
        Number of steps of the integration.
    """

    def __init__(self, scene: Scene, parameters: list[str], times: Array, found: tuple[Any, ...]) -> None:
        _, _, steps, rows, derivatives = found
        if rows.shape[1] == 1:
            rows, derivatives = rows[:, 0], derivatives[:, 0]
        self.scene = scene
        self.parameters = parameters
        self.steps: int = steps
        self.motion = Motion(times, rows[..., :4], rows[..., 4:7], rows[..., 7:10], rows[..., 10:])
        self.rotation: Array = derivatives[..., :3, :]
        self.w: Array = derivatives[..., 3:6, :]
        self.p: Array = derivatives[..., 6:9, :]
        self.v: Array = derivatives[..., 9:, :]

    def __getitem__(self, parameter: str) -> Derivative:
        if parameter not in self.parameters:
            raise _polhode.InputError(f"there is no derivative by {parameter!r}; the parameters are "
                                      f"{', '.join(self.parameters)}")
        c = self.parameters.index(parameter)
        turn, w = self.rotation[..., c], self.w[..., c]
        # w_B = R^T w, and dR = turn x R
        R = matrices_of(self.motion.q)
        w_B = np.einsum("...ji,...j->...i", R, w - np.cross(turn, self.motion.w))
        # dq = (0, turn) q / 2
        scalar, vector = self.motion.q[..., :1], self.motion.q[..., 1:]
        q = np.concatenate([-(turn * vector).sum(axis=-1, keepdims=True),
                            scalar * turn + np.cross(turn, vector)], axis=-1) / 2
        return Derivative(turn, q, w, w_B, self.p[..., c], self.v[..., c])

    def __repr__(self) -> str:
        return f"<polhode.Sensitivity {self.scene.get('name', '')}: {', '.join(self.parameters)}>"


def _place(scene: Scene, pointer: str) -> tuple[Any, Any]:
    """Returns the list or object that holds the number at a JSON pointer, and its key there. Raises InputError."""
    place: Any = scene
    names = [name.replace("~1", "/").replace("~0", "~") for name in pointer.split("/")[1:]]
    if not pointer.startswith("/"):
        raise _polhode.InputError(f"{pointer!r} is no JSON pointer; write it as \"/body/mass\"")
    for k, name in enumerate(names):
        key: Any = int(name) if isinstance(place, list) and name.isdigit() else name
        try:
            value = place[key]
        except (KeyError, IndexError, TypeError):
            raise _polhode.InputError(f"{pointer}: the scene has no {'/' + '/'.join(names[:k + 1])}; write the number "
                                      "into the scene, even if it is the default") from None
        if k == len(names) - 1:
            if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
                raise _polhode.InputError(f"{pointer}: is not a number; give the pointer of a number")
            return place, key
        place = value
    raise _polhode.InputError(f"{pointer}: is not a number; give the pointer of a number")


def _scale(place: Any) -> float:
    """Returns the largest number among those beside it in a list, or 1."""
    def largest(values: Any) -> float:
        if isinstance(values, list):
            return max((largest(value) for value in values), default=0.0)
        return abs(float(values)) if isinstance(values, (int, float)) else 0.0

    return largest(place) if isinstance(place, list) else 0.0


def _with_number(scene: Scene, pointer: str, value: float) -> Scene:
    """Returns a copy of a scene with another number at a pointer; of a symmetric matrix both entries."""
    changed = scene.copy()
    place, key = _place(changed, pointer)
    place[key] = value
    names = pointer.split("/")
    if len(names) > 3 and names[-3] == "inertia" and names[-1] != names[-2]:
        outer, _ = _place(changed, "/".join([*names[:-2], names[-1], names[-2]]))
        outer[int(names[-2])] = value
    return changed


def _sides(scene: Scene, pointer: str) -> tuple[_polhode.ReadScene, _polhode.ReadScene, float]:
    """Returns the scene with a slightly larger and a smaller number, and the difference of the numbers."""
    place, key = _place(scene, pointer)
    value = float(place[key])
    scale = max(abs(value), _scale(place)) or 1.0
    by = math.ldexp(_STEP, math.frexp(scale)[1])
    ahead, behind = value + by, value - by
    return (_with_number(scene, pointer, ahead)._compiled(), _with_number(scene, pointer, behind)._compiled(),
            ahead - behind)


def sensitivity(
    scene: SceneLike,
    with_respect_to: Sequence[str],
    times: npt.ArrayLike | None = None,
    *,
    samples: int = 100,
    tolerance: float = 1e-13,
    max_seconds: float = 3600,
) -> Sensitivity:
    """Computes the derivatives of a motion with respect to numbers of the scene.

    The variational equation is integrated on dual numbers together with the motion, so that derivatives have the
    accuracy of the motion: no step size of differences limits it. At impulses, the ends of windows, sampling times and
    switches of formulas, the derivatives jump as the time of the event changes with the number. With planes, or with
    limits, friction or prescribed motions of joints, the derivatives are central differences of the reference in 34
    digits, with errors of about 1e-20; this takes two references for each number. A number of a
    normalised quantity (a quaternion, an axis) acts through the normalisation. For an off-diagonal number of an
    inertia matrix, both entries change.

    Parameters
    ----------
    scene : scene, str, path or mapping
        A scene of one or several bodies, without user-defined torques.
    with_respect_to : sequence of str
        JSON pointers of numbers that the scene contains, such as "/body/inertia/0" or "/loads/1/stiffness".
    times : array_like, optional
        Times, s, increasing from 0 or later, at most the scene's duration.
    samples : int, optional
        Number of sample intervals N over the duration, if `times` is not given: k T / N, k = 0..N.
    tolerance : float, optional
        Relative tolerance of the motion and of each derivative.
    max_seconds : float, optional
        Limit of the CPU time, s.

    Returns
    -------
    Sensitivity

    Raises
    ------
    InputError
        If the scene is invalid or not supported, there is no number at a pointer, or the run fails.

    Examples
    --------
    >>> import polhode
    >>> body = polhode.scene(duration=1, body=polhode.body(mass=1, inertia=[1, 2, 3]),
    ...                      initial=polhode.initial(velocity=[2, 0, 0]))
    >>> found = polhode.sensitivity(body, ["/initial/velocity/0"], [0.5, 1.0])
    >>> found["/initial/velocity/0"].p[:, 0].round(12).tolist()
    [0.5, 1.0]
    """
    posed = scene if isinstance(scene, Scene) else make_scene(scene)
    if posed._torques:
        raise _polhode.InputError("sensitivity() does not support user-defined torques; use loads of the scene")
    compiled = posed._compiled()
    parameters = [str(pointer) for pointer in with_respect_to]
    at = np.linspace(0, compiled.duration, samples + 1) if times is None else np.asarray(times, dtype=np.float64)
    if at.ndim != 1 or not at.size or not np.all(np.diff(at) > 0) or at[0] < 0 or at[-1] > compiled.duration:
        raise _polhode.InputError("times must increase, from 0 or later to at most the scene's duration "
                                  f"({compiled.duration} s)")
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise _polhode.InputError(f"tolerance is {tolerance}; give a finite number > 0")
    found = _polhode.sensitivities(compiled, [_sides(posed, pointer) for pointer in parameters],
                                   np.ascontiguousarray(at), tolerance, max_seconds)
    if found[0] != "ok":
        raise _polhode.InputError(f"the derivatives could not be computed ({found[0]}): {found[1]}")
    return Sensitivity(posed, parameters, at, found)


#: Columns of data: the quantity and its component.
_COLUMNS = {name + axis + suffix: (name + suffix, k)
            for name, suffix in (("w", ""), ("w", "_B"), ("p", ""), ("v", ""))
            for k, axis in enumerate("xyz")} | {"q" + axis: ("q", k) for k, axis in enumerate("wxyz")}


def _column(name: str, bodies: list[str]) -> tuple[str, int, int | None]:
    """Returns quantity, component and body of a column. Raises InputError."""
    body, _, quantity = name.rpartition(".")
    if quantity not in _COLUMNS or (body != "") != (len(bodies) > 1) or (body and body not in bodies):
        known = ", ".join(_COLUMNS)
        raise _polhode.InputError(f"there is no column {name!r}; the columns are {known}" +
                                  (f", each after the name of a body and a point: \"{bodies[0]}.px\"" if
                                   len(bodies) > 1 else ""))
    block, component = _COLUMNS[quantity]
    return block, component, bodies.index(body) if body else None


class Fit:
    """Numbers of a scene fitted to data.

    Attributes
    ----------
    scene : Scene
        The scene with the fitted numbers.
    parameters : list of str
        JSON pointers of the numbers.
    values, errors : ndarray, shape (k,)
        Fitted numbers and their standard errors.
    covariance, correlation : ndarray, shape (k, k)
        Covariance and correlation of the fitted numbers. Without weights, the variance of the data is that of the
        residuals. Not a number if the data do not determine all parameters.
    residuals : ndarray, shape (n, columns)
        Motion minus data, in the units of the columns.
    cost : float
        Half the sum of the squared weighted residuals.
    determined : bool
        Whether the data determine all parameters.
    message : str
        How the iteration ended, or which combination of parameters the data do not determine.
    evaluations : int
        Number of evaluations of the motion with its derivatives.
    """

    def __init__(self, scene: Scene, parameters: list[str], values: Array, covariance: Array, residuals: Array,
                 cost: float, message: str, determined: bool, evaluations: int) -> None:
        self.scene = scene
        self.parameters = parameters
        self.values = values
        self.covariance = covariance
        self.errors: Array = np.sqrt(np.diag(covariance))
        self.correlation: Array = covariance / np.outer(self.errors, self.errors)
        self.residuals = residuals
        self.cost = cost
        self.message = message
        self.determined = determined
        self.evaluations = evaluations

    def to_pandas(self) -> pd.DataFrame:
        """Returns a table of the parameters, their values and standard errors.

        Returns
        -------
        pandas.DataFrame
        """
        import pandas as pd

        return pd.DataFrame({"parameter": self.parameters, "value": self.values, "error": self.errors})

    def save(self, path: str) -> None:
        """Writes the scene with the fitted numbers."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.scene.json(indent=2) + "\n")

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {value:.9g} +- {error:.2g}" for name, value, error in
                            zip(self.parameters, self.values, self.errors))
        return f"<polhode.Fit {numbers}; {self.message}>"

    def _repr_html_(self) -> str:
        return table_html(["parameter", "value", "standard error"],
                          [[name, f"{value:.9g}", f"{error:.2g}"] for name, value, error in
                           zip(self.parameters, self.values, self.errors)], caption=self.message)


def _undetermined(jacobian: Array, parameters: list[str], values: Array) -> str:
    """Returns the relative change of the parameters that the data do not determine; empty if there is none."""
    sizes = np.array([max(abs(value), 1e-300) if value else 1.0 for value in values])
    relative = jacobian * sizes
    lengths = np.linalg.norm(relative, axis=0)
    for name, length in zip(parameters, lengths):
        if not length > 0:
            return f"the data do not depend on {name}"
    _, singular, directions = np.linalg.svd(relative / lengths, full_matrices=False)
    if singular[-1] > 1e-7 * singular[0]:
        return ""
    # direction of the relative changes
    change = directions[-1] / lengths
    change /= change[np.argmax(np.abs(change))]
    terms = " ".join(f"{part:+.3g} * {name}" for name, part in zip(parameters, change) if abs(part) > 1e-3)
    return f"the data do not determine the common relative change {terms}; fix one of these parameters"


def fit(
    scene: SceneLike,
    data: npt.ArrayLike | Mapping[str, Any] | pd.DataFrame,
    parameters: Sequence[str],
    columns: Sequence[str] | None = None,
    *,
    times: npt.ArrayLike | None = None,
    weights: npt.ArrayLike | None = None,
    tolerance: float = 1e-10,
    max_evaluations: int = 100,
) -> Fit:
    """Fits numbers of a scene to measured motion by least squares (Levenberg-Marquardt, SciPy).

    Parameters
    ----------
    scene : scene, str, path or mapping
        The scene; its numbers are the initial guess.
    data : array_like, shape (n, columns), mapping or DataFrame
        The measured motion. A mapping or a DataFrame has the columns by name, and ``t``.
    parameters : sequence of str
        JSON pointers of the numbers to fit; see `sensitivity`.
    columns : sequence of str, optional
        Columns to use: "wx", "wy", "wz" (angular velocity, world axes), "wx_B", .. (body axes, as a gyroscope
        measures), "px", .., "vx", .., "qw", "qx", ..; with several bodies "lower.px". Default: those of a mapping or
        DataFrame with such a name.
    times : array_like, shape (n,), optional
        Times of the data, s, if `data` is an array.
    weights : array_like, optional
        One over the standard deviation of the noise: a number, one per column, or of the shape of the data.
        Default: equal weights; the variance of the noise is then estimated from the residuals.
    tolerance : float, optional
        Relative tolerance of the motion and its derivatives.
    max_evaluations : int, optional
        Largest number of evaluations of the motion.

    Returns
    -------
    Fit

    Raises
    ------
    InputError
        If the scene, the data or the parameters are invalid.
    ImportError
        If SciPy is not installed.

    Examples
    --------
    >>> import polhode
    >>> true = polhode.scene(duration=10, body=polhode.body(mass=1, inertia=[1, 2, 2.5]),
    ...                      initial=polhode.initial(angular_velocity=[0.5, 1, 0.2]))
    >>> motion = polhode.solve(true, samples=50)
    >>> guess = true.copy()
    >>> guess.body.inertia[1] = 1.8
    >>> found = polhode.fit(guess, motion.w_B, ["/body/inertia/1"], ["wx_B", "wy_B", "wz_B"], times=motion.t)
    >>> round(float(found.values[0]), 6)
    2.0
    """
    try:
        from scipy.optimize import least_squares
    except ImportError as error:
        raise ImportError("fit() needs SciPy; install it, or minimise with the derivatives of sensitivity()") from error
    posed = make_scene(scene)
    bodies = posed.body_names
    names, at, measured = _table(data, columns, times, bodies)
    pointers = [str(pointer) for pointer in parameters]
    places = [_column(name, bodies) for name in names]
    weight = np.ones_like(measured) if weights is None else np.broadcast_to(
        np.asarray(weights, dtype=np.float64), measured.shape)
    if not (np.all(np.isfinite(weight)) and np.all(weight >= 0)):
        raise _polhode.InputError("weights must be finite and not negative")
    start = np.array([float(_place(posed, pointer)[0][_place(posed, pointer)[1]]) for pointer in pointers])
    if not pointers:
        raise _polhode.InputError("no parameters; give the JSON pointers of the numbers to fit")
    if posed._compiled().duration < at[-1]:
        posed["duration"] = float(at[-1])
    evaluations = 0
    last: dict[bytes, tuple[Array, Array]] = {}

    def scene_of(values: Array) -> Scene:
        changed = posed
        for pointer, value in zip(pointers, values):
            changed = _with_number(changed, pointer, float(value))
        return changed

    def evaluate(values: Array) -> tuple[Array, Array]:
        nonlocal evaluations
        key = values.tobytes()
        if key not in last:
            evaluations += 1
            last.clear()
            found = sensitivity(scene_of(values), pointers, at, tolerance=tolerance)
            derivatives = [found[pointer] for pointer in pointers]
            R = matrices_of(found.motion.q)
            blocks = {"q": found.motion.q, "w": found.motion.w, "p": found.motion.p, "v": found.motion.v,
                      "w_B": np.einsum("...ji,...j->...i", R, found.motion.w)}
            model = np.stack([_pick(blocks[block], k, body) for block, k, body in places], axis=1)
            jacobian = np.stack([np.stack([_pick(getattr(d, block), k, body) for d in derivatives], axis=1)
                                 for block, k, body in places], axis=1)
            last[key] = (model - measured, jacobian)
        return last[key]

    def residual(values: Array) -> Array:
        try:
            return (evaluate(values)[0] * weight).ravel()
        except _polhode.InputError:
            # numbers that no body has: the iteration takes a smaller step
            return np.full(measured.size, refused)

    def slope(values: Array) -> Array:
        return (evaluate(values)[1] * weight[:, :, None]).reshape(-1, len(pointers))

    first = evaluate(start)[0]
    refused = 1e3 * (1 + float(np.abs(first * weight).max()))
    missing = _undetermined(slope(start), pointers, start)
    if missing:
        nothing = np.full((len(pointers), len(pointers)), np.nan)
        return Fit(posed, pointers, start, nothing, first, float(np.sum((first * weight)**2) / 2), missing, False,
                   evaluations)
    # parameters in units of their size, so that all steps are relative
    sizes = np.where(start != 0, np.abs(start), 1.0)
    found = least_squares(lambda x: residual(x * sizes), start / sizes, lambda x: slope(x * sizes) * sizes,
                          method="lm" if measured.size >= len(pointers) else "trf", xtol=1e-12, ftol=1e-14, gtol=1e-14,
                          max_nfev=max_evaluations)
    values = found.x * sizes
    errors, jacobian = evaluate(values)[0], slope(values)
    missing = _undetermined(jacobian, pointers, values)
    covariance = np.full((len(pointers), len(pointers)), np.nan)
    if not missing:
        # computed for the scaled parameters, which have similar sizes
        covariance = np.linalg.pinv((jacobian * sizes).T @ (jacobian * sizes)) * np.outer(sizes, sizes)
        if weights is None:
            covariance = covariance * (2 * found.cost / max(1, measured.size - len(pointers)))
    return Fit(scene_of(values), pointers, values, covariance, errors, float(found.cost), missing or found.message,
               not missing, evaluations)


def _pick(values: Array, component: int, body: int | None) -> Array:
    return values[..., component] if body is None else values[:, body, component]


def _table(data: Any, columns: Sequence[str] | None, times: npt.ArrayLike | None,
           bodies: list[str]) -> tuple[list[str], Array, Array]:
    """Returns the names of the columns, the times and the numbers of the data. Raises InputError."""
    named = isinstance(data, Mapping) or hasattr(data, "columns")
    if named:
        known = [str(name) for name in data]
        names = list(columns) if columns is not None else [n for n in known if n.rpartition(".")[2] in _COLUMNS]
        for name in [*names, *(["t"] if times is None else [])]:
            if name not in known:
                raise _polhode.InputError(f"the data have no column {name!r}; they have {', '.join(known)}")
        at = np.asarray(data["t"] if times is None else times, dtype=np.float64)
        measured = np.stack([np.asarray(data[name], dtype=np.float64) for name in names], axis=1)
    else:
        if columns is None or times is None:
            raise _polhode.InputError("data is an array; give its columns and times")
        names = list(columns)
        at = np.asarray(times, dtype=np.float64)
        measured = np.asarray(data, dtype=np.float64).reshape(len(at), -1)
    if not names or measured.shape != (len(at), len(names)):
        raise _polhode.InputError(f"the data have the shape {measured.shape}; give {len(at)} rows of {len(names)} "
                                  "columns, at least one")
    if not np.all(np.isfinite(measured)):
        raise _polhode.InputError("the data contain a number that is not finite; remove its row")
    for name in names:
        _column(name, bodies)
    return names, at, measured
