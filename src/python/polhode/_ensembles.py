"""Ensembles: one scene solved for many bodies or many initial states."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._html import pairs_html
from polhode._scenes import SceneLike, scene as make_scene
from polhode._types import Array

_WIDTHS = {"q": 4, "w": 3, "p": 3, "v": 3, "inertia": 3, "mass": 1}


class Ensemble:
    """The final state of each body of an ensemble, or the samples of each mechanism.

    Attributes
    ----------
    q : ndarray, shape (n, 4), for mechanisms (n, samples, bodies, 4)
        Attitudes (w, x, y, z), body to world.
    w, p, v : ndarray, shape (n, 3), for mechanisms (n, samples, bodies, 3)
        Angular velocity (rad/s), position (m) and velocity (m/s) of the centre of mass, world axes.
    failures : list of (int, str, str)
        Row, status and reason of each failed run. Its arrays hold the last computed state or NaN.
    seconds : float
        Wall clock time of the solution, s.
    """

    q: Array
    p: Array
    v: Array

    def __init__(self, arrays: dict[str, Any], failures: list[tuple[int, str, str]], seconds: float,
                 native: _polhode.SolvedBodies | None = None) -> None:
        self.__dict__.update(arrays)
        self.failures = failures
        self.seconds = seconds
        self._native = native

    @cached_property
    def w(self) -> Array:
        """Angular velocities in world axes, rad/s; computed on first access."""
        assert self._native is not None, "the arrays of mechanisms include w"
        return self._native.w()

    @property
    def ok(self) -> bool:
        """Whether every run succeeded."""
        return not self.failures

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return f"<polhode.Ensemble of {len(self)}, {len(self.failures)} failed, {self.seconds:.3g} s>"

    def _repr_html_(self) -> str:
        pairs: list[tuple[str, object]] = [("runs", len(self)), ("failed", len(self.failures)),
                                           ("seconds", f"{self.seconds:.3g}")]
        return pairs_html("ensemble", pairs + [(f"row {row}", f"{status}: {why}")
                                               for row, status, why in self.failures[:10]])


def ensemble(
    scene: SceneLike,
    arrays: Mapping[str, npt.ArrayLike] | None = None,
    *,
    tolerance: float | None = None,
    duration: float | None = None,
    samples: int = 1,
    threads: int = 0,
    max_steps: int = 1_000_000,
    max_seconds: float = 3600,
    **columns: npt.ArrayLike,
) -> Ensemble:
    """Solves a scene for many bodies with different inertia and initial states, or a mechanism from many states.

    Parameters
    ----------
    scene : scene, str, path or mapping
        Its loads act on all bodies. Columns that are not given take the scene's values.
    arrays : mapping of str to array_like, optional
        One body: ``q`` (n, 4), ``w`` (n, 3, in the scene's angular_velocity_frame), ``p``, ``v`` (n, 3), ``inertia``
        (n, 3) moments or (n, 3, 3) tensors, ``mass`` (n,). Several bodies: the columns that ``polhode ensemble``
        reads, each (n,): "JOINT.angle", "JOINT.rate", "BODY.mass", ..
    tolerance : float, optional
        Relative tolerance. Default: 1e-10.
    duration : float, optional
        Duration T, s. Default: the scene's.
    samples : int, optional
        Number of samples N at k T / N, k = 1..N (several bodies).
    threads : int, optional
        Number of threads; 0: all cores. The result does not depend on it.
    max_steps, max_seconds : int and float, optional
        A body that needs more steps or more CPU time (s) fails. The other bodies are still solved.
    **columns : array_like
        Columns as keywords, in addition to `arrays`.

    Returns
    -------
    Ensemble

    Examples
    --------
    >>> import numpy as np, polhode
    >>> ends = polhode.ensemble("free_asymmetric", w=np.random.default_rng(1).normal(size=(1000, 3)))
    >>> ends.q.shape, ends.ok
    ((1000, 4), True)
    """
    posed = make_scene(scene)
    if duration is not None:
        posed.duration = duration
    given = {name: np.asarray(values, dtype=np.float64) for name, values in {**(arrays or {}), **columns}.items()}
    if not given:
        raise _polhode.InputError(f"no arrays; give at least one of {', '.join(_WIDTHS)}")
    lengths = {len(np.atleast_1d(values)) for values in given.values()}
    if len(lengths) > 1:
        raise _polhode.InputError(f"the arrays have {sorted(lengths)} rows; give arrays of equal length")
    settings = _polhode.EnsembleSettings(tolerance, threads, max_steps, max_seconds)
    read = posed._compiled()
    if read.bodies:
        return _mechanisms(read, given, samples, settings)
    for name, values in given.items():
        if name not in _WIDTHS:
            raise _polhode.InputError(f"a body has no column {name}; give {', '.join(_WIDTHS)}")
        rows = lengths.copy().pop()
        shapes: list[tuple[int, ...]] = [(rows, _WIDTHS[name])]
        if name == "inertia":
            shapes.append((rows, 3, 3))
        elif name == "mass":
            shapes = [(rows,)]
        if values.shape not in shapes:
            raise _polhode.InputError(f"{name} has the shape {values.shape}; give {' or '.join(map(str, shapes))}")
    solved = _polhode.solve_bodies(read, lengths.pop(), _polhode.Columns(*(given.get(name) for name in _WIDTHS)), settings)
    arrays = {"q": solved.q, "w_B": solved.w_B, "p": solved.p, "v": solved.v}
    return Ensemble(arrays, solved.failures(), solved.seconds, solved)


def _mechanisms(read: Any, given: dict[str, Array], samples: int, settings: Any) -> Ensemble:
    from time import perf_counter

    lines = [",".join(given)] + [",".join(map(repr, row)) for row in zip(*(v.tolist() for v in given.values()))]
    begin = perf_counter()
    numbers, statuses, messages = _polhode.solve_mechanisms(read, "\n".join(lines) + "\n", samples, settings)
    seconds = perf_counter() - begin
    failures = [(row, status, why) for row, (status, why) in enumerate(zip(statuses, messages)) if status != "ok"]
    arrays = {"t": numbers[..., 0], "q": numbers[..., 1:5], "w": numbers[..., 5:8], "p": numbers[..., 8:11],
              "v": numbers[..., 11:14]}
    return Ensemble(arrays, failures, seconds)
