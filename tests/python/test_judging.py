"""Truths, errors, checks, ensembles, experiments, user-defined methods, figures."""

import json

import matplotlib.pyplot as plt
import mpmath
import numpy as np
import pandas as pd
import polhode
import pytest
from hypothesis import given, settings, strategies as st


def test_truths_are_the_programs_decimals(program):
    lines = [line for line in program("truth", "lagrange_top", "--samples", "3", "--digits", "30").splitlines()
             if not line.startswith("#")]
    names, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    truth = polhode.truth("lagrange_top", samples=3, digits=30)
    for name in truth.decimals:
        assert truth.decimals[name] == [row[names.index(name)] for row in rows], name
    assert truth.bound <= 1e-30 and truth.q.shape == (4, 4)
    assert float(truth.decimals["qx"][2]) == truth.q[2, 1]


def test_truth_at_times_of_ones_own():
    few = polhode.truth("free_asymmetric", [0.5, 2.0], digits=20)
    many = polhode.truth("free_asymmetric", [0.25, 0.5, 1, 2.0], digits=20)
    with mpmath.workdps(30):
        assert abs(few.mpmath["qw"][0] - many.mpmath["qw"][1]) < mpmath.mpf(10) ** -20
    with pytest.raises(polhode.NoTruthError, match="digits"):
        polhode.truth("free_asymmetric", digits=200)
    with pytest.raises(ValueError, match="increase"):
        polhode.truth("free_asymmetric", [2, 1])


def test_certified_radii_hold_the_truth():
    proven = polhode.truth("free_asymmetric", [0.5, 3.0], digits=30, certified=True)
    agreed = polhode.truth("free_asymmetric", [0.5, 3.0], digits=40)
    assert proven.certified and proven.digits >= 30 and proven.bound < 1e-29
    with mpmath.workdps(60):
        for name, column in proven.decimals.items():
            for k, value in enumerate(column):
                radius = mpmath.mpf(proven.radii[name][k]) + mpmath.mpf(10) ** -38
                assert abs(mpmath.mpf(value) - mpmath.mpf(agreed.decimals[name][k])) <= radius, name


def test_several_bodies_have_a_truth_each():
    truth = polhode.truth("mechanisms/double_pendulum", samples=2, digits=20)
    assert truth.q.shape == (3, 2, 4) and len(truth.decimals["qw"][1]) == 2


def test_errors_are_the_angle_between_attitudes():
    motion = polhode.solve("free_asymmetric", "odeint_rk4", step=0.2, samples=20)
    truth = polhode.truth(motion.scene, motion.t)
    off = polhode.errors(motion, truth)
    cosine = np.abs(np.sum(motion.q * truth.q, axis=1)) / np.linalg.norm(motion.q, axis=1)
    angle = 2 * np.arccos(np.minimum(cosine, 1))
    seen = off.attitude > 1e-6
    assert seen.any() and np.allclose(off.attitude[seen], angle[seen], rtol=1e-2)
    assert off.max["attitude"] == off.attitude.max() and off.final["attitude"] == off.attitude[-1]
    assert np.allclose(off.norm, np.abs(np.linalg.norm(motion.q, axis=1) - 1), atol=1e-15)
    with pytest.raises(polhode.InputError, match="times"):
        polhode.errors(motion, polhode.truth(motion.scene, samples=5))


def test_check_says_what_the_program_says(program, tmp_path):
    motion = polhode.solve("t_handle", "article_as_written", step=0.01)
    path = tmp_path / "mine.csv"
    motion.save(path)
    found = polhode.check(path, "t_handle")
    assert found.text == program("check", "t_handle", str(path)) and not found.ok
    assert json.dumps(found.data) == json.dumps(json.loads(program("check", "t_handle", str(path), "--format", "json")))
    columns = {"t": motion.t, **dict(zip(("qw", "qx", "qy", "qz"), motion.q.T))}
    assert not polhode.check(columns, "t_handle").ok
    assert polhode.check(pd.DataFrame(columns), "t_handle").text == polhode.check(columns, "t_handle").text
    assert polhode.check(polhode.solve("t_handle"), limits={"attitude": 1e-6}).ok
    with pytest.raises(polhode.InputError, match="no scene"):
        polhode.check(path)
    with pytest.raises(polhode.InputError, match="cannot be read"):
        polhode.check(tmp_path / "none.csv", "t_handle")
    with pytest.raises(ValueError, match="fortnights"):
        polhode.check(motion, convention="fortnights")


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.integers(1, 40), st.integers(0, 2**32 - 1), st.sampled_from(["free_asymmetric", "driven_damped_top"]))
def test_ensembles_are_their_bodies_alone(count, seed, name):
    scene = polhode.scene("free_asymmetric" if name == "free_asymmetric" else "lagrange_top", duration=1)
    rng = np.random.default_rng(seed)
    w = rng.normal(size=(count, 3))
    found = polhode.ensemble(scene, w=w)
    k = int(rng.integers(count))
    one = scene.copy()
    one.initial.angular_velocity = w[k]
    alone = polhode.solve(one, samples=1)
    assert found.ok and np.abs(found.q[k] - alone.q[-1]).max() < 1e-8
    assert np.abs(found.w[k] - alone.w[-1]).max() < 1e-8 * max(1, np.abs(w).max())


def test_ensembles_have_the_programs_bits(program, tmp_path):
    rng = np.random.default_rng(5)
    w, mass = rng.normal(size=(50, 3)), rng.uniform(1, 2, 50)
    table = tmp_path / "bodies.csv"
    table.write_text("wx,wy,wz,mass\n" + "".join(f"{a!r},{b!r},{c!r},{m!r}\n" for (a, b, c), m in
                                                 zip(w.tolist(), mass.tolist())))
    lines = program("ensemble", "lagrange_top", "--initial", str(table)).splitlines()
    names = lines[0].split(",")
    wanted = np.array([[float(line.split(",")[names.index(n)]) for n in ("qw", "qx", "qy", "qz", "wx", "wy", "wz")]
                       for line in lines[1:]])
    found = polhode.ensemble("lagrange_top", w=w, mass=mass, threads=2)
    assert np.array_equal(np.hstack([found.q, found.w]), wanted)


def test_ensembles_of_mechanisms_have_the_programs_bits(program, tmp_path):
    rng = np.random.default_rng(6)
    table = np.zeros(40, [("shoulder.angle", "<f8"), ("elbow.rate", "<f8")])
    for name in table.dtype.names:
        table[name] = rng.uniform(-1, 1, 40)
    table["elbow.rate"][7] = np.nan
    np.save(tmp_path / "starts.npy", table)
    program("ensemble", "mechanisms/double_pendulum", "--initial", str(tmp_path / "starts.npy"), "--samples", "2",
            "--duration", "1", "--output", str(tmp_path / "out.npy"))
    wanted = np.load(tmp_path / "out.npy")
    found = polhode.ensemble("mechanisms/double_pendulum", {name: table[name] for name in table.dtype.names}, samples=2,
                             duration=1)
    ok = wanted["status"] == 0
    assert wanted["row"][~ok].tolist() == [8] and [row for row, _, _ in found.failures] == [7]
    kept = np.arange(40) != 7
    for block, names in [("q", ("qw", "qx", "qy", "qz")), ("w", ("wx", "wy", "wz")), ("p", ("px", "py", "pz")),
                         ("v", ("vx", "vy", "vz"))]:
        columns = np.stack([wanted[name][ok] for name in names], axis=-1)
        assert np.array_equal(columns.reshape(39, 2, 2, -1), getattr(found, block)[kept])
    assert np.array_equal(wanted["body"][ok].reshape(39, 2, 2)[0, 0], [b"upper", b"lower"])


def test_ensembles_tell_what_is_wrong():
    bad = polhode.ensemble("free_asymmetric", inertia=[[1, 1, 1], [1, 1, 5], [1, 2, 2]])
    assert len(bad) == 3 and [row for row, _, _ in bad.failures] == [1] and not bad.ok
    for wrong, words in [({"w": np.zeros((3, 2))}, "shape"), ({"x": [1]}, "a body has no column x"), ({}, "no arrays"),
                         ({"w": np.zeros((3, 3)), "mass": [1]}, "rows")]:
        with pytest.raises(polhode.InputError, match=words):
            polhode.ensemble("free_asymmetric", wrong)
    pendulums = polhode.ensemble("mechanisms/double_pendulum", {"shoulder.angle": [0.1, 0.2, 0.3]}, samples=2)
    assert pendulums.q.shape == (3, 2, 2, 4) and pendulums.ok


def test_a_method_of_ones_own_is_a_row_like_any_other(tmp_path):
    @polhode.method(name="midpoint_here", order=2)
    def midpoint(f, t, y, h):
        "The explicit midpoint rule."
        return y + h * f(t + h / 2, y + h / 2 * f(t, y))

    found = polhode.run({"name": "mine", "scenes": ["free_asymmetric"], "methods": [midpoint, "odeint_rk4"],
                         "settings": {"steps": [0.02, 0.01, 0.005]}, "repeats": 1}, tmp_path)
    rows = found.table[found.table.method == "midpoint_here"]
    assert list(rows.status) == ["ok"] * 3 and (rows.rhs_evaluations == 2 * rows.steps).all()
    order = np.log2(rows.attitude_error_max.to_numpy()[:-1] / rows.attitude_error_max.to_numpy()[1:])
    assert np.allclose(order, 2, atol=0.2)
    assert "<table" in found._repr_html_() and (tmp_path / "provenance.json").exists()
    assert polhode.methods()["midpoint_here"].documentation == "The explicit midpoint rule."
    for x in ("seconds_median", "rhs_evaluations"):
        assert len(found.plot(x).axes[0].lines) >= 2
    # on every system: rotation about one axis, 13 variables, several bodies
    for scene in ("lagrange_top", "every_load", "mechanisms/double_pendulum"):
        motion = polhode.solve(scene, midpoint, step=1e-3, duration=1, samples=4)
        assert motion.status == "ok" and motion.errors().max["attitude"] < 0.05, scene
    with pytest.raises(ValueError, match="already"):
        polhode.method(midpoint, name="taylor")


def test_an_exception_in_a_method_of_ones_own():
    @polhode.method
    def broken_here(f, t, y, h):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        polhode.solve("free_asymmetric", broken_here)
    rows = polhode.run({"scenes": ["free_asymmetric"], "methods": [broken_here], "repeats": 1,
                        "settings": {"steps": [0.1]}}).table
    assert list(rows.status) == ["failed"] and "KeyError" in rows.message[0]

    @polhode.method
    def short_here(f, t, y, h):
        return y[:2]

    with pytest.raises(ValueError, match="numbers"):
        polhode.solve("free_asymmetric", short_here)


def test_scenes_of_ones_own_in_experiments():
    spin = polhode.scene({"name": "spin", "duration": 2, "body": {"mass": 1, "inertia": [1, 2, 3]},
                          "initial": {"angular_velocity": [0.1, 1, 0.1]}})
    found = polhode.run({"scenes": spin, "methods": "dop853", "settings": {"tolerances": [1e-6, 1e-9]}, "repeats": 1})
    assert list(found.table.scene) == ["spin"] * 2 and (found.table.status == "ok").all()
    with pytest.raises(polhode.InputError, match="no truth"):
        polhode.run({"scenes": spin.add_torque(lambda now: (0, 0, 0)), "methods": "dop853"})
    with pytest.raises(polhode.InputError, match="methds"):
        polhode.run({"scenes": ["t_handle"], "methods": ["dop853"], "methds": 1})


def test_pictures():
    for scene in ("lagrange_top", "mechanisms/double_pendulum"):
        motion = polhode.solve(scene, samples=20)
        assert motion.plot().axes and motion.errors().plot().axes
    assert len(polhode.solve("thrown_hammer", samples=20).plot().axes) >= 2
    plt.close("all")
