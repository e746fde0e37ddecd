"""Events and modes of contacts with planes and of joints with friction or limits."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from polhode._types import Array


class ContactEvent(NamedTuple):
    """A change of a contact or of a joint.

    `event` is ``impact``, ``lands``, ``rolls``, ``slides``, ``lifts_off``, ``accumulates``, ``stops``,
    ``spin_stops``, ``spin_starts``, ``rolling_stops`` or ``rolling_starts``, for a joint ``impact``, ``rests``,
    ``leaves``, ``sticks`` or ``slips``.
    """

    t: float  #: s
    other: str  #: name of the plane or the joint
    event: str  #: what happens
    normal_impulse: float  #: N s, for a joint N m s or N s; zero unless an impulse acts
    tangential_impulse: Array  #: N s, world axes; zero for a joint
    decimal_t: str  #: the time with all digits of a truth; of a method the shortest decimal


class ContactInterval(NamedTuple):
    """A time interval in which the equations of a contact do not change."""

    begin: float  #: s
    end: float  #: s
    other: str  #: name of the plane; empty in flight
    mode: str  #: ``flight``, ``sliding``, ``rolling``, ..
    largest_ratio: float  #: largest friction over mu N; 0 in flight and without friction


def contact_events(rows: list[tuple[Any, ...]]) -> list[ContactEvent]:
    """Makes events from the rows of the extension."""
    return [ContactEvent(float(t), other, event, float(normal or 0), np.array([float(x or 0) for x in tangential]),
                         str(t)) for t, other, event, normal, tangential in rows]


def contact_intervals(rows: list[tuple[Any, ...]]) -> list[ContactInterval]:
    """Makes intervals from the rows of the extension."""
    return [ContactInterval(float(begin), float(end), *others) for begin, end, *others in rows]
