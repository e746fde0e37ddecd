"""Trajectories: the same bits as from the program, without copies; agreement with independent solvers."""

import sys

import mpmath
import numpy as np
import polhode
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

COLUMNS = {"q": ("qw", "qx", "qy", "qz"), "w": ("wx", "wy", "wz"), "p": ("px", "py", "pz"), "v": ("vx", "vy", "vz")}


@pytest.mark.parametrize(
    ("scene", "method", "how"),
    [
        ("free_asymmetric", "exact", {}),
        ("lagrange_top", "taylor", {"tolerance": 1e-12}),
        ("every_load", "dop853", {"tolerance": 1e-9}),
        ("stiff_drag", "cvode_bdf", {"tolerance": 1e-8}),
        ("heavy_asymmetric_top", "odeint_rk4", {"step": 0.01}),
        ("mechanisms/double_pendulum", "extrapolation", {"tolerance": 1e-10}),
    ],
)
def test_numbers_are_the_programs(program, scene, method, how):
    options = [word for name, value in how.items() for word in (f"--{name}", repr(value))]
    wanted = program.table("solve", scene, "--method", method, "--samples", "20", *options)
    found = polhode.solve(scene, method, samples=20, **how)
    assert found.status == "ok"
    times = np.repeat(found.t, found.q.shape[1]) if found.q.ndim == 3 else found.t
    assert np.array_equal(times, wanted["t"])
    for block, names in COLUMNS.items():
        numbers = getattr(found, block).reshape(-1, len(names))
        assert np.array_equal(numbers, np.column_stack([wanted[name] for name in names])), block


def test_arrays_lie_over_one_memory():
    motion = polhode.solve("free_asymmetric", samples=1000)
    begins = {name: getattr(motion, name).__array_interface__["data"][0] for name in ("t", "q", "w_B", "p", "v")}
    assert [begins[name] - begins["q"] for name in ("w_B", "p", "v", "t")] == [32, 56, 80, 104]
    assert motion.q.strides == (112, 8) and not motion.q.flags.owndata
    with pytest.raises(ValueError, match="read-only"):
        motion.q[0, 0] = 1
    assert motion.w is motion.w and motion.q is motion.q
    q = motion.q
    del motion
    assert np.allclose(np.linalg.norm(q, axis=1), 1)


def test_world_and_body_rates_agree():
    motion = polhode.solve("heavy_asymmetric_top", samples=50)
    w, x, y, z = motion.q.T
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    assert np.allclose(np.einsum("ijn,nj->ni", turn, motion.w_B), motion.w, atol=1e-13)


def test_times_of_ones_own(program):
    times = np.sort(np.random.default_rng(2).uniform(0, 20, 30))
    for method, how in [("exact", {}), ("cvode_adams", {"tolerance": 1e-11}), ("taylor", {"tolerance": 1e-13}),
                        ("splitting4", {"step": 0.002}), ("odeint_dopri5", {"tolerance": 1e-11}),
                        ("extrapolation", {"tolerance": 1e-12}), ("truth", {})]:
        motion = polhode.solve("free_asymmetric", method, times=times, **how)
        assert motion.status == "ok" and np.array_equal(motion.t, times), method
        assert motion.errors().max["attitude"] < 1e-6, method
    assert polhode.solve("free_asymmetric", times=[0, 1, 2.5]).t.tolist() == [0, 1, 2.5]
    with pytest.raises(polhode.InputError, match="both samples and times"):
        polhode.solve("free_asymmetric", samples=3, times=[1])
    wrong = polhode.solve("free_asymmetric", times=[2, 1])
    assert wrong.status == "failed" and "2" in wrong.message


def test_between_the_samples():
    coarse = polhode.solve("lagrange_top", "cvode_adams", tolerance=1e-10, samples=4)
    fine = polhode.solve("lagrange_top", "cvode_adams", tolerance=1e-10, samples=40)
    between = coarse.at(fine.t[::-1])
    assert np.array_equal(between.q[::-1], fine.q) and np.array_equal(between.w[::-1], fine.w)
    full = polhode.solve("free_asymmetric", "cvode_adams", tolerance=1e-8, samples=4, full=True)
    assert np.array_equal(full.at(full.t).q, full.q)
    assert coarse.at(1.5).q.shape == (4,) and coarse.at([[1.0, 2.0]]).p.shape == (1, 2, 3)
    with pytest.raises(polhode.InputError, match="fixed step"):
        polhode.solve("lagrange_top", "odeint_rk4", step=0.01).at(1.5)
    with pytest.raises(polhode.InputError, match="times"):
        coarse.at(1e9)


def test_failures_are_statuses():
    refused = polhode.solve("stiff_drag", "exact")
    assert refused.status == "unsupported" and refused.message and len(refused) == 0 and refused.q.shape == (0, 4)
    stopped = polhode.solve("lagrange_top", "taylor", max_steps=3)
    assert stopped.status == "failed" and "3 steps" in stopped.message
    for wrong in ({"step": -1}, {"tolerance": float("nan")}):
        with pytest.raises(polhode.InputError, match="give a finite number > 0"):
            polhode.solve("lagrange_top", **wrong)
    with pytest.raises(polhode.InputError, match="does not take a step"):
        polhode.solve("lagrange_top", "dop853", step=0.1)


def rates(inertia, torque=None):
    """Euler's equations and the quaternion equation, independent of polhode's code."""

    def f(t, y):
        w, x, y_, z = y[:4]
        a, b, c = y[4:]
        turn = [(-x * a - y_ * b - z * c) / 2, (w * a + y_ * c - z * b) / 2, (w * b + z * a - x * c) / 2,
                (w * c + x * b - y_ * a) / 2]
        A, B, C = inertia
        M = torque(t, y) if torque else (0, 0, 0)
        return turn + [((B - C) * b * c + M[0]) / A, ((C - A) * c * a + M[1]) / B, ((A - B) * a * b + M[2]) / C]

    return f


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    st.tuples(*[st.floats(1, 2)] * 3),
    st.tuples(*[st.floats(-2, 2)] * 3).filter(lambda w: max(map(abs, w)) > 0.1),
)
def test_scipys_dop853_agrees(moments, rate):
    scene = polhode.scene({"duration": 3, "body": {"mass": 1, "inertia": list(moments)},
                           "initial": {"angular_velocity": list(rate)}})
    here = polhode.solve(scene, samples=6)
    there = solve_ivp(rates(moments), (0, 3), [1, 0, 0, 0, *rate], "DOP853", here.t, rtol=1e-12, atol=1e-12)
    assert np.abs(there.y[:4].T - here.q).max() < 1e-9
    assert np.abs(there.y[4:].T - here.w_B).max() < 1e-9


def test_mpmaths_series_agrees_to_twenty_digits():
    moments, rate = (1, 2, 3), (0.5, 0.25, 1)
    scene = {"duration": 1, "body": {"mass": 1, "inertia": moments}, "initial": {"angular_velocity": rate}}
    truth = polhode.truth(scene, samples=1, digits=25)
    with mpmath.workdps(30):
        found = mpmath.odefun(rates([mpmath.mpf(m) for m in moments]), 0, [1, 0, 0, 0, *map(mpmath.mpf, rate)])(1)
        for name, value in zip(("qw", "qx", "qy", "qz"), found):
            assert abs(truth.mpmath[name][1] - value) < mpmath.mpf(10) ** -22


def test_a_torque_of_ones_own():
    body = {"duration": 2, "body": {"mass": 1, "inertia": [1, 2, 3]}, "initial": {"angular_velocity": [1, 2, 3]}}
    drag = polhode.scene(body)
    drag["loads"] = [{"type": "drag", "rotational": [0.1, 0.2, 0.3]}]
    own = polhode.scene(body).add_torque(lambda now: -np.array([0.1, 0.2, 0.3]) * now.w_B, name="friction")
    for method in ("dop853", "cvode_adams", "odeint_dopri5"):
        a, b = (polhode.solve(scene, method, tolerance=1e-11, samples=5) for scene in (drag, own))
        assert np.abs(a.q - b.q).max() < 1e-9, method
    window = polhode.scene(body).add_torque(lambda now: (0, 0, 1), start=0.5, until=1.0)
    torque = polhode.scene(body)
    torque["loads"] = [{"type": "torque", "vector": [0, 0, 1], "frame": "body", "from": 0.5, "until": 1.0}]
    assert np.abs(polhode.solve(window).q - polhode.solve(torque).q).max() < 1e-8
    with pytest.raises(polhode.NoTruthError, match="user-defined torque"):
        polhode.solve(own).errors()


@pytest.mark.parametrize("method", ["dop853", "extrapolation", "cvode_adams", "arkode_erk8", "odeint_dopri5"])
@pytest.mark.parametrize("samples", [1, 10, 1000])
def test_evaluations_are_the_calls_of_a_torque(method, samples):
    calls = []
    scene = polhode.scene("free_asymmetric", duration=2).add_torque(lambda now: calls.append(now.t) or -0.1 * now.w_B)
    polhode.solve(scene, method, samples=1)  # poses the scene, which also calls the torque
    calls.clear()
    motion = polhode.solve(scene, method, tolerance=1e-8, samples=samples)
    assert motion.rhs_evaluations == len(calls) and motion.sample_evaluations <= motion.rhs_evaluations
    if method == "dop853":
        # at most nine per step that contains samples
        assert motion.sample_evaluations <= (0 if samples == 1 else 9 * motion.steps)


@pytest.mark.parametrize("method", ["dop853", "cvode_adams", "radau", "arkode_erk8", "odeint_dopri5"])
def test_an_exception_in_a_torque_comes_through(method):
    def broken(now):
        raise ZeroDivisionError("mine")

    scene = polhode.scene("free_asymmetric").add_torque(broken)
    if polhode.methods()[method].control == "step":
        pytest.skip("by tolerance")
    try:
        motion = polhode.solve(scene, method)
    except ZeroDivisionError as thrown:
        assert str(thrown) == "mine"
    else:
        assert motion.status == "unsupported", method
    with pytest.raises(ValueError, match="three numbers"):
        polhode.solve(polhode.scene("free_asymmetric").add_torque(lambda now: "x"), "dop853")


def test_solve_ivps_shape():
    found = polhode.solve_ivp("free_asymmetric", (0, 5), rtol=1e-10, t_eval=[0, 1, 5], dense_output=True)
    assert found.success and found.status == 0 and found.y.shape == (13, 3) and found.t.tolist() == [0, 1, 5]
    assert found.sol(1.0).shape == (13,) and np.array_equal(found.sol([1.0])[:, 0], found.y[:, 1])
    with pytest.raises(polhode.InputError, match="t_span"):
        polhode.solve_ivp("free_asymmetric", (1, 5))


def test_several_bodies():
    motion = polhode.solve("mechanisms/double_pendulum", samples=10, reactions=True)
    assert motion.q.shape == (11, 2, 4) and motion.p.shape == (11, 2, 3) and motion.t.shape == (11,)
    assert motion.reactions.shape[0] == 11 and motion.reactions.shape[2] == 6
    assert motion.errors().max["attitude"] < 1e-5
    assert len(motion.csv().splitlines()) == 23


def test_arrays_of_ones_own_are_trajectories():
    motion = polhode.solve("heavy_asymmetric_top", samples=20)
    again = polhode.trajectory("heavy_asymmetric_top", motion.t, motion.q, motion.w, motion.p, motion.v)
    assert np.abs(again.w - motion.w).max() < 1e-12 and again.errors().max["attitude"] < 1e-9
    with pytest.raises(polhode.InputError, match="lengths"):
        polhode.trajectory("heavy_asymmetric_top", motion.t, motion.q, motion.w[1:])


def test_the_import_stays_light():
    heavy = {"pandas", "matplotlib", "mpmath", "scipy"}
    code = f"import sys, polhode; print(sorted({heavy!r} & set(sys.modules)))"
    import subprocess

    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"
