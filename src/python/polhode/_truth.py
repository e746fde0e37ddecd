"""The reference solution (truth) with agreed or proven digits."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from polhode import _polhode
from polhode._contacts import ContactEvent, ContactInterval, contact_events, contact_intervals
from polhode._html import pairs_html
from polhode._scenes import Scene, SceneLike, scene as make_scene
from polhode._types import Array

_COLUMNS = ("qw", "qx", "qy", "qz", "wx", "wy", "wz", "px", "py", "pz", "vx", "vy", "vz")
_BLOCKS = {"q": slice(0, 4), "w": slice(4, 7), "p": slice(7, 10), "v": slice(10, 13)}


class Truth:
    """The reference motion: decimals, the nearest binary64 numbers, and an error bound.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Times of the samples, s.
    q, w, p, v : ndarray, shape (n, 4) or (n, 3), for several bodies (n, bodies, ..)
        The binary64 numbers nearest to the decimals; w in world axes.
    decimals : dict of str to list
        By column of trajectory files, "qw" to "vz": one decimal string per sample, or a list of them (several bodies).
    radii : dict of str to list, or None
        For a certified truth: the radius about each decimal that encloses the exact value.
    bound : float
        Error bound: attitude in rad, other blocks relative to their largest length. For a certified truth: the largest
        radius.
    digits : int
        Requested digits. For a certified truth: proven digits.
    certified : bool
        Whether the digits are proven.
    message : str
        The method that computed the truth.
    """

    def __init__(self, scene: Scene, native: Any, digits: int, certified: bool) -> None:
        self.scene = scene
        self.message: str = native.message
        self.certified = certified
        self.t: Array = np.array(native.times)
        bodies: int = native.bodies
        rows: list[list[Any]] = native.columns
        values: list[list[Any]] = [[number.value for number in row] for row in rows] if certified else rows
        self.decimals = self._by_column(values, bodies)
        self.radii = self._by_column([[n.radius for n in row] for row in rows], bodies) if certified else None
        self.bound: float = float(native.radius) if certified else native.bound
        self.digits: int = native.digits if certified else digits
        self._contacts: tuple[list[Any], list[Any]] = (
            ([], []) if certified else _polhode.events_of_truth(native, scene._compiled()))
        numbers = np.array([[float(value) for value in row] for row in values])
        shape = (len(self.t),) if bodies == 1 else (len(self.t), bodies)
        self.q: Array
        self.w: Array
        self.p: Array
        self.v: Array
        self.q, self.w, self.p, self.v = (numbers[:, place].reshape((*shape, -1)) for place in _BLOCKS.values())

    @staticmethod
    def _by_column(rows: list[list[Any]], bodies: int) -> dict[str, list[Any]]:
        by_column: dict[str, list[Any]] = {}
        for place, name in enumerate(_COLUMNS):
            column = [row[place] for row in rows]
            by_column[name] = (
                column if bodies == 1 else [column[k : k + bodies] for k in range(0, len(column), bodies)]
            )
        return by_column

    @property
    def contact_events(self) -> list[ContactEvent]:
        """Impacts and changes of contacts with planes, or of joints with friction or limits, by time.

        ``decimal_t`` of each has all digits. Empty if the motion was computed without contact modes.
        """
        return contact_events(self._contacts[0])

    @property
    def modes(self) -> list[ContactInterval]:
        """The modes of the contact with planes over time."""
        return contact_intervals(self._contacts[1])

    @cached_property
    def mpmath(self) -> dict[str, list[Any]]:
        """The decimals as mpmath numbers (``mpf``) with all their digits.

        Examples
        --------
        >>> import mpmath, polhode
        >>> end = polhode.truth("free_asymmetric", samples=1, digits=30).mpmath
        >>> length = mpmath.sqrt(sum(end[c][1] ** 2 for c in ("qw", "qx", "qy", "qz")))
        >>> abs(length - 1) < mpmath.mpf(10) ** -15
        True
        """
        import mpmath

        with mpmath.workdps(self.digits + 5):

            def number(value: Any) -> Any:
                return [number(one) for one in value] if isinstance(value, list) else mpmath.mpf(value)

            return {name: number(column) for name, column in self.decimals.items()}

    def __len__(self) -> int:
        return len(self.t)

    def _told(self) -> list[tuple[str, object]]:
        return [
            ("scene", self.scene.get("name", "")),
            ("digits", f"{self.digits} proven" if self.certified else self.digits),
            ("bound", f"{self.bound:.2e}"),
            ("samples", len(self)),
            ("computed by", self.message),
        ]

    def __repr__(self) -> str:
        return "<polhode.Truth " + ", ".join(f"{name} {value}" for name, value in self._told()) + ">"

    def _repr_html_(self) -> str:
        return pairs_html("truth", self._told())


def truth(
    scene: SceneLike,
    times: npt.ArrayLike | None = None,
    *,
    samples: int | None = None,
    digits: int = 17,
    certified: bool = False,
    max_seconds: float = 3600,
) -> Truth:
    """Computes the reference motion of a scene.

    It is computed in two formulations with different orders and steps until they agree. With ``certified`` it is
    enclosed by ball arithmetic, which proves each digit. Agreed truths are cached on disk (``$POLHODE_CACHE``).

    Parameters
    ----------
    scene : scene, str, path or mapping
        A scene or what `polhode.scene` makes one from.
    times : array_like, optional
        Sample times, s, increasing from 0 or later; for a certified truth at most the scene's duration.
    samples : int, optional
        Number of sample intervals N: times k T / N, k = 0..N, instead of ``times``. Default: 100.
    digits : int, optional
        Correct digits, relative to the largest length of each block; at most 80 without ``certified``.
    certified : bool, optional
        Whether to prove the digits.
    max_seconds : float, optional
        Limit of the CPU time, s.

    Returns
    -------
    Truth
        The truth at the sample times.

    Raises
    ------
    NoTruthError
        If the truth is not available. The message states the reason and, if known, the available digits.

    Examples
    --------
    >>> import polhode
    >>> proven = polhode.truth("free_asymmetric", [1.0], digits=30, certified=True)
    >>> proven.digits >= 30, proven.bound < 1e-30
    (True, True)
    """
    if samples is not None and times is not None:
        raise _polhode.InputError("both samples and times; give one of them")
    posed = make_scene(scene)
    if posed._torques:
        raise _polhode.NoTruthError("no truth: user-defined torques are not supported")
    at = _polhode.SampleTimes(
        100 if samples is None else samples,
        np.empty(0) if times is None else np.atleast_1d(np.asarray(times, dtype=np.float64)),
    )
    make = _polhode.certified if certified else _polhode.decimals
    native = make(posed._compiled(), at, digits, max_seconds)
    if not native.available:
        raise _polhode.NoTruthError(native.message)
    return Truth(posed, native, digits, certified)
