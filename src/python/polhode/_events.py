"""Events of a motion: times at which a function or a formula of the state passes zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from polhode import _polhode
from polhode._types import Array
from polhode.symbols import Formula

#: Largest number of times at which the signs of the functions are compared.
_MOST_CHECKS = 20_000
#: Limit on the iterations of the root search.
_MOST_ITERATIONS = 200


class Event:
    """An event of `solve`, with the attributes that a text cannot have.

    Parameters
    ----------
    of : str, Formula or callable
        A formula of time and state in the language of formula loads, such as ``"p.z - 1"`` or ``"elbow.angle"``, a
        formula made by `symbols`, or a function of the `Motion` at one time.
    terminal : bool or int, optional
        Whether the event ends the motion, or the number of its occurrence that ends it.
    direction : float, optional
        > 0: only upwards; < 0: only downwards; 0: both.

    Examples
    --------
    >>> import polhode
    >>> falls = polhode.Event("v.z", direction=-1)
    >>> ball = {"name": "ball", "duration": 3, "body": {"mass": 1, "inertia": [1, 1, 1]},
    ...         "initial": {"velocity": [0, 0, 5]}, "loads": [polhode.gravity(acceleration=[0, 0, -10])]}
    >>> polhode.solve(ball, events=[falls, "p.z"]).t_events
    [array([0.5]), array([1.])]
    """

    def __init__(self, of: Any, *, terminal: bool | int = False, direction: float = 0.0) -> None:
        self.of: Any = of.of if isinstance(of, Event) else of
        self.terminal = terminal
        self.direction = direction

    def __repr__(self) -> str:
        of = str(self.of) if isinstance(self.of, Formula) else self.of
        return f"polhode.Event({of!r}, terminal={self.terminal}, direction={self.direction})"


def as_events(given: Any) -> list[Event]:
    """Returns events from functions, texts, formulas and events. Functions keep their attributes."""
    if callable(given) or isinstance(given, (str, Formula, Event)):
        given = [given]
    events = []
    for k, one in enumerate(given):
        of = one.of if isinstance(one, Event) else one
        if not (callable(of) or isinstance(of, (str, Formula))):
            raise _polhode.InputError(f"events[{k}] is {of!r}; give a function of the motion at one time, or a formula "
                                      "such as \"p.z - 1\"")
        event = Event(of)
        event.terminal, event.direction = getattr(one, "terminal", False), getattr(one, "direction", 0.0)
        events.append(event)
    return events


def check_times(begin: float, end: float, samples: Array, steps: int, rate: float) -> Array:
    """Returns the times at which signs are compared.

    These are the samples, about two times per step of the method, and 32 per revolution at `rate` (rad/s).
    """
    revolutions = rate * (end - begin) / (2 * np.pi)
    count = int(min(max(2 * steps, len(samples), 32 * revolutions), _MOST_CHECKS))
    return np.asarray(np.unique(np.concatenate([samples, np.linspace(begin, end, count + 1)])))


def _directions(events: Sequence[Event]) -> Array:
    return np.array([float(event.direction) for event in events])


def _passes(before: Array, after: Array, direction: Array) -> Any:
    """Returns where a value changes sign, or leaves zero towards the other sign, in the given direction."""
    rises = (before < 0) & (after >= 0)
    falls = (before > 0) & (after <= 0)
    return (rises & (direction >= 0)) | (falls & (direction <= 0))


def locate_events(values: Callable[[Array], Array], times: Array, events: Sequence[Event]) -> list[Array]:
    """Locates the zeros of functions along a motion.

    Parameters
    ----------
    values : callable
        Returns the values of all functions at times, shape (times, events).
    times : ndarray
        Times at which signs are compared, s. Two zeros between neighbouring times are not seen.
    events : sequence of Event
        The events, for their directions.

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


def first_terminal(times: Sequence[Array], events: Sequence[Event]) -> tuple[float, int] | None:
    """Returns time and index of the event that ends the motion, or None.

    The attribute ``terminal`` of an event is a bool, or the number of its occurrence that ends the motion.
    """
    ends = []
    for k, event in enumerate(events):
        terminal = int(event.terminal)
        if terminal < 0:
            raise _polhode.InputError(f"event {k}: terminal is {terminal}; give a bool or a number > 0")
        if 0 < terminal <= len(times[k]):
            ends.append((float(times[k][terminal - 1]), k))
    return min(ends) if ends else None
