"""Solving scenes, and the resulting trajectories."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._animation import animate, cell, save, strobe
from polhode._attitudes import Attitudes, BodyMotion, matrices_of
from polhode._checking import Report, check
from polhode._contacts import ContactEvent, ContactInterval, contact_events, contact_intervals
from polhode._errors import Errors, errors
from polhode._events import Event, as_events, check_times, first_terminal, locate_events
from polhode._html import pairs_html
from polhode._joints import Joints, Reactions, index_of
from polhode._plot import plot_trajectory
from polhode._scenes import Scene, SceneLike, scene as make_scene
from polhode._truth import Truth
from polhode._types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from polhode.symbols import Formula

#: No sample times: samples are equally spaced.
_NO_TIMES = np.empty(0)


class Motion(NamedTuple):
    """The motion of the bodies at some times."""

    t: Array  #: s
    q: Array  #: (.., 4): w, x, y, z, body to world
    w: Array  #: (.., 3): angular velocity, world axes, rad/s
    p: Array  #: (.., 3): position of the centre of mass, m
    v: Array  #: (.., 3): velocity of the centre of mass, m/s

    @property
    def w_B(self) -> Array:
        """Angular velocity, body axes, rad/s."""
        return np.asarray((matrices_of(self.q).swapaxes(-1, -2) @ self.w[..., None])[..., 0])


class Trajectory(Attitudes):
    """The result of a method: the motion at the sample times, the status and the cost of the run.

    Arrays are read-only views of the samples. For several bodies each array except ``t`` has a second axis, of bodies,
    and ``motion["lower"]`` is the motion of the body named "lower".

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times of the samples, s.
    q : ndarray, shape (n, 4)
        Attitude (w, x, y, z), body to world, as the method computed it (not normalised).
    w_B : ndarray, shape (n, 3)
        Angular velocity, body axes, rad/s.
    p, v : ndarray, shape (n, 3)
        Position and velocity of the centre of mass, world axes, m and m/s.
    joints : Joints
        The motions of the joints of several bodies by name: ``motion.joints["elbow"].angle``.
    reactions : Reactions
        The reactions of joints and loops, an array of shape (n, joints, 6), and by name:
        ``motion.reactions("elbow")``. Pass ``reactions=True`` to `solve`.
    scene : Scene
        The scene that was solved.
    method : str
        Name of the method.
    status : str
        ``ok``, ``unsupported``, ``diverged``, ``tolerance_not_met`` or ``failed``.
    message : str
        The reason if the status is not ``ok``.
    steps : int
        Number of accepted steps.
    rhs_evaluations : int
        Evaluations of the right-hand side by the whole run, including those for samples between steps. For a torque
        added by `Scene.add_torque` that acts all the time, this is the number of its calls, apart from those made to
        pose the scene. Methods without a right-hand side count another unit of work (``polhode.describe(METHOD)``).
    sample_evaluations : int
        The part of ``rhs_evaluations`` that was caused by samples only.
    seconds : float
        Wall clock time of the integration alone, s.
    t_events : list of ndarray
        Times of each of the ``events`` passed to `solve`, s.
    y_events : list of Motion or None
        The motion at these times; None for an event that does not occur.
    ended_by : int or None
        Index of the terminal event that ended the motion.
    """

    t_events: list[Array]
    y_events: list[Motion | None]
    ended_by: int | None

    def __init__(self, native: _polhode.SolvedScene, scene: Scene, limits: dict[str, Any] | None = None,
                 full: bool = False) -> None:
        self._native = native
        self._full = full
        self._limits = limits or {}
        self.scene = scene
        self.method: str = native.method
        self.status: str = native.status
        self.steps: int = native.steps
        self.rhs_evaluations: int = native.rhs_evaluations
        self.sample_evaluations: int = native.sample_evaluations
        self.seconds: float = native.seconds
        self.t_events, self.y_events, self.ended_by = [], [], None

    def __getattr__(self, name: str) -> Any:
        # arrays are created on first access and stored
        if name in ("t", "q", "w_B", "p", "v", "message", "step", "tolerance", "counts", "impact_times"):
            value = getattr(self._native, name)
        elif name == "w":
            value = self._native.w()
            value.flags.writeable = False
        elif name == "reactions":
            value = Reactions(self._native.reactions(), len(self.t), self._native.scene.joints, self.method)
        elif name == "joints":
            value = Joints(self.t, self._native.joints())
        else:
            raise AttributeError(f"a trajectory has no attribute {name}")
        self.__dict__[name] = value
        return value

    if TYPE_CHECKING:
        t: Array
        q: Array
        w: Array
        w_B: Array
        p: Array
        v: Array
        message: str
        step: float
        tolerance: float | None
        counts: dict[str, int | None]
        impact_times: list[float]
        reactions: Reactions
        joints: Joints

    def __getitem__(self, name: str) -> BodyMotion:
        """Returns the motion of one of several bodies.

        Parameters
        ----------
        name : str
            Name of a body.

        Returns
        -------
        BodyMotion
            Its arrays are views of those of the trajectory.

        Raises
        ------
        InputError
            If there is no body of this name.

        Examples
        --------
        >>> import polhode
        >>> polhode.solve("mechanisms/double_pendulum", samples=10)["lower"].q.shape
        (11, 4)
        """
        names = self._bodies()
        if not names:
            raise _polhode.InputError("a scene of one body has no names of bodies; use the arrays q, w, p and v")
        b = index_of(name, names, "body")
        if self.q.ndim < 3:  # a single body of a mechanism
            return BodyMotion(name, self.t, self.q, self.w, self.w_B, self.p, self.v, self._centers())
        return BodyMotion(name, self.t, self.q[:, b], self.w[:, b], self.w_B[:, b], self.p[:, b], self.v[:, b],
                          self._centers()[b])

    def _bodies(self) -> list[str]:
        return self._native.scene.bodies

    def _centers(self) -> Array:
        centers: Array = self._native.scene.centers_of_mass()
        return centers if self.q.ndim > 2 else centers[0]  # type: ignore[no-any-return]

    @cached_property
    def _contacts(self) -> tuple[list[ContactEvent], list[ContactInterval]]:
        events, intervals = _polhode.events_of_run(self._native)
        return contact_events(events), contact_intervals(intervals)

    @property
    def contact_events(self) -> list[ContactEvent]:
        """Impacts and changes of contacts with planes, or of joints with friction or limits, by time (method taylor).

        Raises
        ------
        InputError
            If the scene has neither, or if the method does not record events.
        """
        return self._contacts[0]

    @property
    def modes(self) -> list[ContactInterval]:
        """The modes of the contact with planes over time (method taylor)."""
        return self._contacts[1]

    @property
    def ok(self) -> bool:
        """Whether the status is ``ok``."""
        return self.status == "ok"

    @property
    def why(self) -> str:
        """The reason why `auto` selected the method; empty for a method given by name."""
        return self._native.why

    def at(self, times: npt.ArrayLike) -> Motion:
        """Computes the motion at any times, with the method's own evaluation between its steps.

        The run is repeated with these sample times. Steps do not depend on sample times, so the steps and the cost are
        the same. Pass all times in one call.

        Parameters
        ----------
        times : array_like
            Times, s, in any order and shape, from 0 to the scene's duration.

        Returns
        -------
        Motion
            Arrays of the shape of `times` with one more axis.

        Raises
        ------
        InputError
            If the method uses a fixed step, whose samples are at whole steps only, or a time is out of range.

        Examples
        --------
        >>> import polhode
        >>> motion = polhode.solve("lagrange_top", "taylor", samples=2)
        >>> motion.at([0.25, 0.5]).q.shape
        (2, 4)
        """
        asked = np.asarray(times, dtype=np.float64)
        ordered, places = np.unique(asked.ravel(), return_inverse=True)
        found, shape = self._again(ordered), asked.shape
        return Motion(asked.copy(), *(a[places].reshape(shape + a.shape[1:]) for a in
                                      (found.q, found.w, found.p, found.v)))

    def _again(self, times: Array) -> Trajectory:
        """Repeats the run with other sample times, in increasing order."""
        if self._native.step > 0:
            raise _polhode.InputError(
                f"{self.method} uses a fixed step and has no values between steps; pass the times to solve()"
            )
        settings = _polhode.Settings(tolerance=self._native.tolerance, times=times, **self._limits)
        found = Trajectory(_polhode.solve(self._native.scene, self.method, settings, self._full, False), self.scene)
        if len(found.t) != len(times):
            raise _polhode.InputError(f"there is no motion at these times: {found.message}")
        return found

    def errors(self, truth: Truth | None = None, *, digits: int = 25) -> Errors:
        """Computes the errors of this trajectory against the truth; see `polhode.errors`."""
        return errors(self, truth, digits=digits)

    def check(self, **options: Any) -> Report:
        """Compares this trajectory with the truth and diagnoses known faults; see `polhode.check`."""
        return check(self, **options)

    def csv(self) -> str:
        """Returns the text of a trajectory file: the shortest decimals that read back to the same numbers."""
        return self._native.csv()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a trajectory file (CSV)."""
        Path(path).write_text(self.csv(), encoding="utf-8")

    def plot(self, **options: Any) -> Figure:
        """Draws attitude, angular velocity and, if it moves, the centre of mass over time.

        Parameters
        ----------
        **options
            Arguments of ``matplotlib.pyplot.figure``.

        Returns
        -------
        matplotlib.figure.Figure
        """
        return plot_trajectory(self, **options)

    def strobe(self, count: int = 6, *, size: tuple[float, float] = (5.0, 5.0)) -> Figure:
        """Draws the bodies at several times in one picture, the earlier the paler, with the path of a point.

        Parameters
        ----------
        count : int, optional
            Number of times, at equal numbers of samples, including the first and the last.
        size : (float, float), optional
            Width and height, inches.

        Returns
        -------
        matplotlib.figure.Figure
            Bodies that would be invisible beside their path are enlarged; the heading states by how much.
        """
        return strobe(self, count=count, size=size)

    def animate(self, *, frames: int = 100, fps: float = 25, size: tuple[float, float] = (5.0, 5.0),
                beside: Sequence[Trajectory] = ()) -> Any:
        """Makes an animation for a notebook: an HTML cell that needs no network.

        Parameters
        ----------
        frames : int, optional
            Number of pictures, at equal times, each of the sample nearest to it.
        fps : float, optional
            Pictures per second.
        size : (float, float), optional
            Width and height of each motion, inches.
        beside : sequence of Trajectory, optional
            Other motions, drawn beside this one in the same cube of space.

        Returns
        -------
        IPython.display.HTML or str
            The cell; its text if IPython is not installed.

        Raises
        ------
        InputError
            If there are fewer than 2 samples or frames.
        """
        text = cell(animate(self, frames=frames, fps=fps, size=size, beside=beside), fps)
        try:
            from IPython.display import HTML
        except ImportError:
            return text
        return HTML(text)

    def animation(
        self,
        path: str | os.PathLike[str],
        *,
        frames: int = 100,
        fps: float = 25,
        size: tuple[float, float] = (5.0, 5.0),
        dpi: float = 80,
        beside: Sequence[Trajectory] = (),
    ) -> Path:
        """Writes an animated picture of the bodies, without a browser.

        Parameters
        ----------
        path : str or path
            NAME.gif, NAME.png (animated) or, if ffmpeg is installed, NAME.mp4.
        frames : int, optional
            Number of pictures, at equal times, each of the sample nearest to it.
        fps : float, optional
            Pictures per second.
        size : (float, float), optional
            Width and height of each motion, inches.
        dpi : float, optional
            Pixels per inch.
        beside : sequence of Trajectory, optional
            Other motions, drawn beside this one in the same cube of space.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If the ending is unknown, ffmpeg is missing, or there are fewer than 2 samples or frames.
        """
        file = Path(path)
        save(animate(self, frames=frames, fps=fps, size=size, beside=beside), file, fps, dpi)
        return file

    def __len__(self) -> int:
        return len(self.t)

    # not a sequence of bodies: __getitem__ takes names only
    __iter__ = None

    def _told(self) -> list[tuple[str, object]]:
        pairs: list[tuple[str, object]] = [
            ("scene", self.scene.get("name", "")),
            ("method", f"{self.method} (auto: {self.why})" if self.why else self.method),
            ("status", f"{self.status}: {self.message}" if self.message else self.status),
            ("samples", len(self)),
            ("steps", self.steps),
            ("right-hand sides", self.rhs_evaluations),
            ("seconds", f"{self.seconds:.3g}"),
        ]
        if self.tolerance is not None:
            pairs.insert(2, ("tolerance", self.tolerance))
        if self.step > 0:
            pairs.insert(2, ("step (s)", self.step))
        return pairs

    def __repr__(self) -> str:
        return "<polhode.Trajectory " + ", ".join(f"{name} {value}" for name, value in self._told()) + ">"

    def _repr_html_(self) -> str:
        return pairs_html("trajectory", self._told())


def solve(
    scene: SceneLike,
    method: str | Callable[..., Any] = "auto",
    *,
    step: float | None = None,
    tolerance: float | None = None,
    samples: int | None = None,
    times: npt.ArrayLike | None = None,
    duration: float | None = None,
    full: bool = False,
    reactions: bool = False,
    events: Sequence[Callable[[Motion], float] | str | Formula | Event] = (),
    max_steps: int = 1_000_000_000,
    max_evaluations: int = 10_000_000_000,
    max_seconds: float = 3600,
) -> Trajectory:
    """Solves a scene.

    Parameters
    ----------
    scene : scene, str, path or mapping
        A scene or what `polhode.scene` makes one from.
    method : str or callable, optional
        Name of a method (see `methods`), or a function registered by `method` or `solver`. ``auto`` selects a method
        for the scene; `describe` prints which and why.
    step : float, optional
        Fixed step, s, rounded down so that whole steps meet every sample. Default: duration / 10^4.
    tolerance : float, optional
        Relative tolerance. The absolute tolerance is this times each component's scale. Default: 1e-10.
    samples : int, optional
        Number of sample intervals N: samples at k T / N, k = 0..N. Default: 100.
    times : array_like, optional
        Sample times instead of `samples`, s, increasing from 0 or later. The run ends at the last of them.
    duration : float, optional
        Duration T, s. Default: the scene's.
    full : bool, optional
        Integrate all 13 variables instead of the reduced formulation (one body).
    reactions : bool, optional
        Compute the reactions of joints at the samples, if the method supports it.
    events : sequence of str, Formula, Event or callable, optional
        Formulas of time and state in the language of formula loads, such as ``"p.z - 1"`` or ``"elbow.angle"``, with
        the parameters, tables and definitions of the scene; or functions of the `Motion` at one time, such as
        ``lambda motion: motion.p[2] - 1``. Times at which a value passes zero are located to the accuracy of the
        method, between its steps. `Event` adds ``terminal`` (True, or the number of the occurrence that ends the
        motion) and ``direction`` (> 0: only upwards, < 0: only downwards); as in SciPy, a function may also have
        these attributes. Signs are compared at the samples, about twice per step, and 32 times per revolution
        of the fastest body. Methods with a fixed step are refused.
    max_steps, max_evaluations : int, optional
        The run ends as ``failed`` after this many steps or right-hand-side evaluations.
    max_seconds : float, optional
        The run ends as ``failed`` after this CPU time of the thread, s.

    Returns
    -------
    Trajectory
        Failed runs also return a trajectory; its `status` reports the failure.

    Raises
    ------
    InputError
        If the scene or a setting is invalid.

    Examples
    --------
    >>> import polhode
    >>> motion = polhode.solve("free_asymmetric", "dop853", tolerance=1e-9, samples=4)
    >>> motion.status, motion.w.shape
    ('ok', (5, 3))
    >>> swing = polhode.solve("mechanisms/double_pendulum", duration=2, events=["elbow.angle - 1"])
    >>> len(swing.t_events[0])
    3
    """
    if samples is not None and times is not None:
        raise _polhode.InputError("both samples and times; give one of them")
    at = _NO_TIMES if times is None else np.ascontiguousarray(times, dtype=np.float64)
    posed = scene if isinstance(scene, Scene) else make_scene(scene)
    if times is not None and duration is None and at.size:
        duration = float(at[-1])
    if duration is not None and posed.get("duration") != duration:
        posed = posed.copy(duration=duration)
    settings = _polhode.Settings(step, tolerance, 100 if samples is None else samples, at, max_steps, max_evaluations,
                                 max_seconds)
    name = method if isinstance(method, str) else getattr(method, "__polhode_method__", str(method))
    native = _polhode.solve(posed._compiled(), name, settings, full, reactions)
    limits = {"max_steps": max_steps, "max_evaluations": max_evaluations, "max_seconds": max_seconds}
    motion = Trajectory(native, posed, limits, full)
    located = as_events(events)
    return _with_events(motion, located, reactions) if located else motion


def _values_of(motion: Trajectory, events: list[Event]) -> Callable[[Array], Array]:
    """Returns the function that computes all events at times, shape (times, events)."""
    written = [k for k, event in enumerate(events) if not callable(event.of)]
    formulas = _polhode.EventFormulas(motion._native.scene, [str(events[k].of) for k in written])

    def values(times: Array) -> Array:
        found = motion._again(times)
        all_ = np.empty((len(times), len(events)))
        if written:
            all_[:, written] = formulas.values(found._native)
        for k in set(range(len(events))) - set(written):
            for i, t in enumerate(found.t):
                all_[i, k] = float(events[k].of(Motion(t, found.q[i], found.w[i], found.p[i], found.v[i])))
        return all_

    return values


def _with_events(motion: Trajectory, events: list[Event], reactions: bool) -> Trajectory:
    """Returns the motion up to the first terminal event, with ``t_events`` and ``y_events``."""
    if motion._native.step > 0:
        raise _polhode.InputError(f"events lie between steps, and {motion.method} uses a fixed step; give a method "
                                  "with a tolerance")
    values = _values_of(motion, events)
    if len(motion.t) < 2:
        return motion
    fastest = float(np.linalg.norm(motion.w_B, axis=-1).max())
    checks = check_times(motion.t[0], motion.t[-1], motion.t, motion.steps, fastest)
    times = locate_events(values, checks, events)
    end = first_terminal(times, events)
    if end is not None:
        kept = np.append(motion.t[motion.t < end[0]], end[0])
        settings = _polhode.Settings(tolerance=motion._native.tolerance, times=kept, **motion._limits)
        native = _polhode.solve(motion._native.scene, motion.method, settings, motion._full, reactions)
        cut = Trajectory(native, motion.scene, motion._limits, motion._full)
        cut.ended_by = end[1]
        motion, times = cut, [of_one[of_one <= end[0]] for of_one in times]
    motion.t_events = times
    motion.y_events = [motion.at(of_one) if len(of_one) else None for of_one in times]
    return motion


def rows_of(q: npt.ArrayLike, *others: npt.ArrayLike | None) -> Array:
    """Returns rows of 13 numbers: q, w, p, v. Missing blocks (None) are zero."""
    blocks = [np.asarray(q, dtype=np.float64).reshape(-1, 4)]
    for block in others:
        blocks.append(np.zeros((len(blocks[0]), 3)) if block is None else
                      np.asarray(block, dtype=np.float64).reshape(-1, 3))
    if len({len(block) for block in blocks}) > 1:
        raise _polhode.InputError("q, w, p and v have different lengths; give one row of each per time and body")
    return np.hstack(blocks)


def trajectory(
    scene: SceneLike,
    t: npt.ArrayLike,
    q: npt.ArrayLike,
    w: npt.ArrayLike | None = None,
    p: npt.ArrayLike | None = None,
    v: npt.ArrayLike | None = None,
    *,
    made_by: str = "own",
) -> Trajectory:
    """Makes a trajectory from arrays that another program computed, for `errors` and figures.

    Parameters
    ----------
    scene : scene, str, path or mapping
        The scene of the trajectory.
    t : array_like, shape (n,)
        Times, s, increasing.
    q : array_like, shape (n, 4) or (n, bodies, 4)
        Attitudes (w, x, y, z), body to world.
    w, p, v : array_like, shape (n, 3) or (n, bodies, 3), optional
        Angular velocity (rad/s), position (m) and velocity (m/s) of the centre of mass, world axes. Default: zero.
    made_by : str, optional
        Value of the trajectory's `method`.

    Returns
    -------
    Trajectory
        The trajectory with these samples.
    """
    posed = make_scene(scene)
    times = np.ascontiguousarray(t, dtype=np.float64)
    return Trajectory(_polhode.trajectory_of(posed._compiled(), made_by, times, rows_of(q, w, p, v)), posed)


class OdeResult:
    """Result of `solve_ivp`, with the attributes of SciPy's result.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Sample times, s.
    y : ndarray, shape (13 bodies, n)
        q, w (world axes), p, v of each body.
    sol : callable or None
        Function that returns the motion at other times, shape (13 bodies, m).
    t_events, y_events : list of ndarray
        Times and states of each event, shapes (k,) and (k, 13 bodies).
    status : int
        0 if the run reached the end, 1 if an event ended it, -1 if it failed.
    success : bool
        Whether the run reached the end.
    message : str
        Why the run ended.
    nfev : int
        Evaluations of the right-hand side.
    trajectory : Trajectory
        The result as polhode's trajectory.
    """

    def __init__(self, trajectory: Trajectory, dense: bool) -> None:
        self.trajectory = trajectory
        self.t = trajectory.t
        self.y = self._columns(trajectory)
        self.status = -1 if not trajectory.ok else 0 if trajectory.ended_by is None else 1
        self.t_events = trajectory.t_events
        self.y_events = [np.empty((0, len(self.y))) if motion is None else self._columns(motion).T
                         for motion in trajectory.y_events]
        self.success = trajectory.ok
        self.message = trajectory.message or (
            "The solver successfully reached the end of the integration interval." if trajectory.ended_by is None
            else "A termination event occurred.")
        self.nfev = trajectory.rhs_evaluations
        self.sol: Callable[[npt.ArrayLike], Array] | None = (
            (lambda times: self._columns(trajectory.at(times))) if dense else None
        )

    @staticmethod
    def _columns(motion: Trajectory | Motion) -> Array:
        rows = np.concatenate([motion.q, motion.w, motion.p, motion.v], axis=-1)
        return np.asarray(rows.reshape(np.shape(motion.t) + (-1,)).T)


def solve_ivp(
    scene: SceneLike,
    t_span: tuple[float, float] | None = None,
    method: str | Callable[..., Any] = "auto",
    t_eval: npt.ArrayLike | None = None,
    dense_output: bool = False,
    events: Callable[[float, Array], float] | str | Sequence[Callable[[float, Array], float] | str | Event] = (),
    *,
    rtol: float | None = None,
) -> OdeResult:
    """Solves a scene with the interface of ``scipy.integrate.solve_ivp``; the scene replaces the function.

    Parameters
    ----------
    scene : scene, str, path or mapping
        The scene, including the initial state at t = 0.
    t_span : (float, float), optional
        (0, end), s. Default: the scene's duration.
    method : str or callable, optional
        Method as for `solve`.
    t_eval : array_like, optional
        Sample times, s. Default: 101 equally spaced times.
    dense_output : bool, optional
        Whether the result has ``sol``.
    events : callable or sequence of callable, optional
        Functions of t and y, with the attributes ``terminal`` and ``direction``, and formulas as for `solve`.
    rtol : float, optional
        Relative tolerance. Default: 1e-10.

    Returns
    -------
    OdeResult
        The samples and the status of the run.

    Examples
    --------
    >>> import polhode
    >>> found = polhode.solve_ivp("free_asymmetric", (0, 10), rtol=1e-9, dense_output=True)
    >>> found.y.shape, found.sol(2.5).shape
    ((13, 101), (13,))
    """
    posed = make_scene(scene)
    if t_span is not None:
        if t_span[0] != 0:
            raise _polhode.InputError(f"t_span starts at {t_span[0]}, and scenes start at 0; give (0, end)")
        posed.duration = float(t_span[1])
    settings: dict[str, Any] = {}
    if rtol is not None:
        settings["tolerance"] = rtol
    if t_eval is not None:
        settings["times"], settings["duration"] = t_eval, posed.duration
    settings["events"] = [_of_state(event) for event in as_events(events)]
    return OdeResult(solve(posed, method, **settings), dense_output)


def _of_state(event: Event) -> Event:
    """Returns an event whose function is of t and y as an event of the motion."""
    if not callable(event.of):
        return event
    function: Callable[[float, Array], float] = event.of
    return Event(lambda motion: function(float(motion.t), OdeResult._columns(motion)), terminal=event.terminal,
                 direction=event.direction)
