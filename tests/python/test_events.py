"""Events of motions against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest
from polhode import symbols


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
@pytest.mark.parametrize("event", [lambda at: at.w_B[1], "w.y", symbols.w.y, polhode.Event("half*w.y")],
                         ids=["function", "text", "symbols", "event"])
def test_zeros_of_a_free_body_are_half_periods_of_the_elliptic_function(event: Any) -> None:
    I, w = np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.0, 1.0])
    scene = {"name": "free", "duration": 40, "body": {"mass": 1, "inertia": list(I)},
             "initial": {"angular_velocity": list(w), "angular_velocity_frame": "body"}, "parameters": {"half": 0.5}}
    energy, momentum = float(I @ w**2), float(I**2 @ w**2)
    above = momentum - I[0] * energy
    assert momentum > I[1] * energy  # rotation about the axis of the largest moment
    rate = np.sqrt((I[2] - I[1]) * above / I.prod())
    m = (I[1] - I[0]) * (energy * I[2] - momentum) / ((I[2] - I[1]) * above)
    half = 2 * _complete_integral(m) / rate
    motion = polhode.solve(scene, "taylor", tolerance=1e-13, samples=7, events=[event])
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
    written = polhode.solve_ivp(_thrown(), rtol=1e-10, events=[polhode.Event("p.z", terminal=True), "t - 0.5"])
    assert written.status == 1
    assert written.t_events[0] == pytest.approx(found.t_events[0], abs=1e-14)
    assert written.t_events[1] == pytest.approx([0.5], abs=1e-15)
    assert polhode.solve_ivp(_thrown(), events=lambda t, y: y[9] - 1e3).y_events[0].shape == (0, 13)


def test_formulas_end_a_motion_beside_functions() -> None:
    ground = polhode.Event("height", terminal=True, direction=-1)
    scene = _thrown()
    scene["let"] = {"height": "p.z"}
    motion = polhode.solve(scene, events=["v.z", ground, lambda at: at.p[2] - 2, polhode.Event("p.z - 2", direction=1)])
    landing = (5 + np.sqrt(45)) / 10
    assert motion.ended_by == 1 and motion.t[-1] == pytest.approx(landing, abs=1e-14)
    assert motion.t_events[0] == pytest.approx([0.5], abs=1e-14)
    assert motion.t_events[2] == pytest.approx([(5 - np.sqrt(5)) / 10, (5 + np.sqrt(5)) / 10], abs=1e-14)
    assert motion.t_events[3] == pytest.approx([(5 - np.sqrt(5)) / 10], abs=1e-14)
    assert polhode.solve(scene, events="v.z").t_events[0] == pytest.approx([0.5], abs=1e-14)


# A body that hangs from a pivot: formulas read the position of its centre of mass, which a method does not integrate.
def test_formulas_read_the_centre_of_mass_of_a_body_with_a_pivot() -> None:
    scene = {"name": "turning", "duration": 6, "pivot": [0, 0, 0],
             "body": {"mass": 1, "inertia": [1, 1, 1], "center_of_mass": [2, 0, 0]},
             "initial": {"angular_velocity": [0, 0, 1]}}
    motion = polhode.solve(scene, events=["p.y - 1", "v.y", "p.x - sqrt(2)"])
    assert motion.t_events[0] == pytest.approx([np.pi / 6, 5 * np.pi / 6], abs=1e-8)
    assert motion.t_events[1] == pytest.approx([np.pi / 2, 3 * np.pi / 2], abs=1e-8)
    assert motion.t_events[2] == pytest.approx([np.pi / 4, 7 * np.pi / 4], abs=1e-8)


def _wheel(rate: float) -> dict[str, Any]:
    wheel = {"mass": 1, "inertia": [1, 2, 3], "center_of_mass": [0.5, 0, 0]}
    return {"name": "wheel", "duration": 10, "bodies": [{"name": "disc", "body": wheel}],
            "joints": [{"name": "main axle", "type": "revolute", "parent": "world", "child": "disc", "axis": [0, 0, 1],
                        "initial": {"angle": 0.25, "rate": rate}}]}


# Without loads the rate is constant. The angle counts full revolutions; the position does not.
def test_formulas_read_joints_and_bodies() -> None:
    motion = polhode.solve(_wheel(4), "taylor", samples=3, tolerance=1e-13,
                           events=['"main axle".angle - 30', "at(disc, [0, 0, 0]).x - 1", "disc.p.y", "disc.w.z - 5"])
    assert motion.t_events[0] == pytest.approx([29.75 / 4], abs=1e-11)
    assert motion.t_events[1].size == 0
    turns = np.arange(1, 13) * np.pi
    assert motion.t_events[2] == pytest.approx((turns - 0.25) / 4, abs=1e-11)
    assert motion.t_events[3].size == 0
    assert motion.y_events[0] is not None
    assert motion.y_events[0].w.shape == (1, 3)


@pytest.mark.parametrize("formula, message", [
    ("w[2] - 0.5", r'events\[1\]: "w\[2\] - 0.5": column 2: components are not numbered; use .x, .y or .z'),
    ("p - 1", r'events\[1\]: "p - 1": column 3: a vector and a scalar cannot be added or subtracted'),
    ("p", r"column 1: the formula is a vector, but an event is a scalar; give a component such as w.x"),
    ("heights", r"column 1: unknown name .heights.; did you mean height"),
    ("", r"column 1: the formula is empty"),
    ("late - 1", r"column 1: the event depends on a held value, which is not supported"),
])
def test_faults_in_formulas_are_located(formula: str, message: str) -> None:
    scene = _thrown()
    scene["let"] = {"height": "p.z", "late": "hold(p.z, 0.1)"}
    with pytest.raises(polhode.InputError, match=message):
        polhode.solve(scene, events=["height", formula])


def test_formulas_of_several_bodies_name_the_body() -> None:
    with pytest.raises(polhode.InputError, match=r'events\[0\]: "w.x": column 1: unknown name'):
        polhode.solve(_wheel(1), events=["w.x"])
    with pytest.raises(polhode.InputError, match='has no quantity "rat"; give one of angle, rate'):
        polhode.solve(_wheel(1), events=['"main axle".rat'])


def test_bad_events_are_refused() -> None:
    with pytest.raises(polhode.InputError, match="events lie between steps, and odeint_rk4 uses a fixed step"):
        polhode.solve(_thrown(), "odeint_rk4", step=0.01, events=[lambda at: at.p[2]])
    with pytest.raises(polhode.InputError, match="event 0 is nan at t = 0.0 s"):
        polhode.solve(_thrown(), events=[lambda at: float("nan")])
    with pytest.raises(polhode.InputError, match=r"events\[1\] is 3; give a function of the motion at one time, or a "):
        polhode.solve(_thrown(), events=["p.z", 3])  # type: ignore[list-item]
    with pytest.raises(polhode.InputError, match="event 0: terminal is -1"):
        polhode.solve(_thrown(), events=[_with(lambda at: at.p[2], terminal=-1)])
