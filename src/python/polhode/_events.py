"""Events of a motion: times at which a function of the state passes zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from polhode import _polhode
from polhode._types import Array

#: Largest number of times at which the signs of the functions are compared.
_MOST_CHECKS = 20_000
#: Limit on the iterations of the root search.
_MOST_ITERATIONS = 200


def check_times(begin: float, end: float, samples: Array, steps: int) -> Array:
    """Returns the times at which signs are compared: samples, and about two times per step of the method."""
    count = min(max(2 * steps, len(samples)), _MOST_CHECKS)
    return np.asarray(np.unique(np.concatenate([samples, np.linspace(begin, end, count + 1)])))


def _directions(events: Sequence[Any]) -> Array:
    return np.array([float(getattr(event, "direction", 0.0)) for event in events])


def _passes(before: Array, after: Array, direction: Array) -> Any:
    """Returns where a value changes sign, or leaves zero towards the other sign, in the given direction."""
    rises = (before < 0) & (after >= 0)
    falls = (before > 0) & (after <= 0)
    return (rises & (direction >= 0)) | (falls & (direction <= 0))


def locate_events(values: Callable[[Array], Array], times: Array, events: Sequence[Any]) -> list[Array]:
    """Locates the zeros of functions along a motion.

    Parameters
    ----------
    values : callable
        Returns the values of all functions at times, shape (times, events).
    times : ndarray
        Times at which signs are compared, s. Two zeros between neighbouring times are not seen.
    events : sequence
        The functions, for their attributes ``direction``.

    Returns
    -------
    list of ndarray
        The times of each event, s, to the rounding of t where the function changes sign once.
    """
    at_checks = values(times)
    if not np.isfinite(at_checks).all():
        row, which = np.argwhere(~np.isfinite(at_checks))[0]
        raise _polhode.InputError(f"event {which} is {at_checks[row, which]} at t = {times[row]} s; it must be finite")
    starts, which = np.nonzero(_passes(at_checks[:-1], at_checks[1:], _directions(events)))
    roots = _find_roots(values, which, times[starts], times[starts + 1], at_checks[starts, which],
                        at_checks[starts + 1, which])
    return [np.sort(roots[which == k]) for k in range(len(events))]


def _find_roots(values: Callable[[Array], Array], which: Any, b: Array, a: Array, fb: Array, fa: Array) -> Array:
    """Finds one zero per bracket [b, a] by inverse quadratic interpolation and bisection, all brackets at once.

    Source: T. R. Chandrupatla 1997, Advances in Engineering Software 28, 145-149.
    """
    c, fc = b.copy(), fb.copy()
    x, open_ = np.where(np.abs(fa) < np.abs(fb), a, b), np.ones(len(a), dtype=bool)
    part = np.full(len(a), 0.5)
    for _ in range(_MOST_ITERATIONS):
        best = np.where(np.abs(fa) < np.abs(fb), a, b)
        x = np.where(open_, best, x)
        tolerance = 2 * np.spacing(np.abs(best))
        open_ = open_ & (np.minimum(np.abs(fa), np.abs(fb)) > 0) & (np.abs(b - a) > 2 * tolerance)
        if not open_.any():
            break
        least = np.where(open_, tolerance / np.where(open_, np.abs(b - a), 1.0), 0.5)
        tried = a + np.clip(part, least, 1 - least) * (b - a)
        at, places = np.unique(tried[open_], return_inverse=True)
        ft = np.zeros(len(a))
        ft[open_] = values(at)[places, which[open_]]
        same = np.sign(ft) == np.sign(fa)
        moved = open_ & ~same
        c, fc = np.where(open_, np.where(same, a, b), c), np.where(open_, np.where(same, fa, fb), fc)
        b, fb = np.where(moved, a, b), np.where(moved, fa, fb)
        a, fa = np.where(open_, tried, a), np.where(open_, ft, fa)
        with np.errstate(all="ignore"):
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            quadratic = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            smooth = (phi * phi < xi) & ((1 - phi) * (1 - phi) < 1 - xi) & np.isfinite(quadratic)
        part = np.where(smooth, quadratic, 0.5)
    return x


def first_terminal(times: Sequence[Array], events: Sequence[Any]) -> tuple[float, int] | None:
    """Returns time and index of the event that ends the motion, or None.

    The attribute ``terminal`` of an event is a bool, or the number of its occurrence that ends the motion.
    """
    ends = []
    for k, event in enumerate(events):
        terminal = int(getattr(event, "terminal", False))
        if terminal < 0:
            raise _polhode.InputError(f"event {k}: terminal is {terminal}; give a bool or a number > 0")
        if 0 < terminal <= len(times[k]):
            ends.append((float(times[k][terminal - 1]), k))
    return min(ends) if ends else None
