"""Events of motions against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest


def _complete_integral(m: float) -> float:
    """Returns K(m) by the arithmetic-geometric mean."""
    a, b = 1.0, float(np.sqrt(1 - m))
    while a - b > 1e-15:
        a, b = (a + b) / 2, float(np.sqrt(a * b))
    return float(np.pi / (2 * a))


def _with(event: Any, **attributes: Any) -> Any:
    for name, value in attributes.items():
        setattr(event, name, value)
    return event


# Euler's equations: w about the middle axis is proportional to sn, whose zeros are 2K apart.
def test_zeros_of_a_free_body_are_half_periods_of_the_elliptic_function() -> None:
    I, w = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.0, 1.0])
    scene = {"name": "free", "duration": 40, "body": {"mass": 1, "inertia": list(I)},
             "initial": {"angular_velocity": list(w), "angular_velocity_frame": "body"}}
    energy, momentum = float(I @ w**2), float(I**2 @ w**2)
    above = momentum - I[0] * energy
    assert momentum > I[1] * energy  # rotation about the axis of the largest moment
    rate = np.sqrt((I[2] - I[1]) * above / I.prod())
    m = (I[1] - I[0]) * (energy * I[2] - momentum) / ((I[2] - I[1]) * above)
    half = 2 * _complete_integral(m) / rate
    motion = polhode.solve(scene, "taylor", tolerance=1e-13, samples=7, events=[lambda at: at.w_B[1]])
    times = motion.t_events[0]
    assert len(times) == int(40 / half)
    assert times == pytest.approx(half * np.arange(1, len(times) + 1), abs=1e-11)
    assert motion.y_events[0] is not None
    assert motion.y_events[0].q.shape == (len(times), 4)


def _thrown() -> dict[str, Any]:
    return {"name": "thrown", "duration": 3, "body": {"mass": 1, "inertia": [1, 2, 3]},
            "initial": {"position": [0, 0, 1], "velocity": [2, 0, 5], "angular_velocity": [0.1, 0.2, 0.3]},
            "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}]}


def test_a_terminal_event_ends_the_motion() -> None:
    ground = _with(lambda at: at.p[2], terminal=True)
    motion = polhode.solve(_thrown(), events=[lambda at: at.p[2] - 2, ground])
    landing = (5 + np.sqrt(45)) / 10
    assert motion.ended_by == 1 and motion.ok
    assert motion.t[-1] == pytest.approx(landing, abs=1e-14)
    assert motion.p[-1] == pytest.approx([2 * landing, 0, 0], abs=1e-13)
    assert motion.t_events[0] == pytest.approx([(5 - np.sqrt(5)) / 10, (5 + np.sqrt(5)) / 10], abs=1e-14)
    assert (np.diff(motion.t) > 0).all()


def test_directions_and_counts() -> None:
    up = _with(lambda at: at.p[2] - 2, direction=1)
    second = _with(lambda at: at.p[2] - 2, terminal=2)
    motion = polhode.solve(_thrown(), events=[up, second])
    assert motion.t_events[0] == pytest.approx([(5 - np.sqrt(5)) / 10], abs=1e-14)
    assert motion.t[-1] == pytest.approx((5 + np.sqrt(5)) / 10, abs=1e-14)
    never = polhode.solve(_thrown(), events=[lambda at: at.p[2] + 1e3])
    assert never.t_events[0].size == 0 and never.y_events == [None] and never.ended_by is None
    assert never.t[-1] == 3


# A velocity that jumps at an impulse passes zero at the impulse.
def test_a_jump_is_located() -> None:
    scene = _thrown()
    scene["loads"] = [{"type": "impulse", "at": 1.25, "vector": [0, 0, -7], "frame": "world", "point": [0, 0, 0]}]
    motion = polhode.solve(scene, "dop853", events=[lambda at: at.v[2]])
    assert motion.t_events[0] == pytest.approx([1.25], abs=1e-12)


def test_the_interface_of_scipy() -> None:
    ground = _with(lambda t, y: y[9], terminal=True)
    found = polhode.solve_ivp(_thrown(), rtol=1e-10, events=[ground, lambda t, y: t - 0.5])
    assert found.status == 1 and found.success and found.message == "A termination event occurred."
    assert found.t_events[0] == pytest.approx([(5 + np.sqrt(45)) / 10], abs=1e-14)
    assert found.t_events[1] == pytest.approx([0.5], abs=1e-15)
    assert found.y_events[0].shape == (1, 13)
    assert found.t[-1] == found.t_events[0][0]
    assert polhode.solve_ivp(_thrown(), events=lambda t, y: y[9] - 1e3).y_events[0].shape == (0, 13)


def test_bad_events_are_refused() -> None:
    with pytest.raises(polhode.InputError, match="events lie between steps, and odeint_rk4 uses a fixed step"):
        polhode.solve(_thrown(), "odeint_rk4", step=0.01, events=[lambda at: at.p[2]])
    with pytest.raises(polhode.InputError, match="event 0 is nan at t = 0.0 s"):
        polhode.solve(_thrown(), events=[lambda at: float("nan")])
    with pytest.raises(polhode.InputError, match="events: give functions"):
        polhode.solve(_thrown(), events=["p.z"])  # type: ignore[list-item]
    with pytest.raises(polhode.InputError, match="event 0: terminal is -1"):
        polhode.solve(_thrown(), events=[_with(lambda at: at.p[2], terminal=-1)])
