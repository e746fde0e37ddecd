"""Derivatives of motions, compared with differences of the truth in 35 digits, and fits to noisy data."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import polhode

mpmath = pytest.importorskip("mpmath")

BLOCKS = {"w": ["wx", "wy", "wz"], "p": ["px", "py", "pz"], "v": ["vx", "vy", "vz"]}


def numbers(scene: polhode.Scene, times: list[float]) -> dict[str, Any]:
    """The truth as an array of mpmath numbers for each block, (n, bodies, components)."""
    bodies = max(1, len(scene.body_names))
    decimals = polhode.truth(scene, times, digits=35).decimals
    blocks = {"q": ["qw", "qx", "qy", "qz"], **BLOCKS}
    return {name: np.array([[mpmath.mpf(x) for x in np.ravel(np.array(decimals[c], dtype=object))] for c in columns],
                           dtype=object).T.reshape(len(times), bodies, len(columns)) for name, columns in blocks.items()}


def with_number(scene: polhode.Scene, pointer: str, change: float) -> polhode.Scene:
    changed = scene.copy()
    place: Any = changed
    *outer, last = [int(name) if name.isdigit() else name for name in pointer.split("/")[1:]]
    for name in outer:
        place = place[name]
    place[last] = place[last] + change
    return changed


def differences(scene: polhode.Scene, pointer: str, times: list[float]) -> dict[str, np.ndarray]:
    """Central differences of the truth with a step of 2^-36, about 1e-11: their error is 1e-22 of the third derivative,
    and that of the truth is 1e-35 / 1e-11."""
    h = 2.0**-36
    with mpmath.workdps(50):
        ahead, behind = (numbers(with_number(scene, pointer, by), times) for by in (h, -h))
        found = {name: (ahead[name] - behind[name]) / (2 * mpmath.mpf(h)) for name in BLOCKS}
        rotations = np.empty(ahead["q"].shape[:2] + (3,), dtype=object)
        for place in np.ndindex(rotations.shape[:2]):
            (a, *u), (b, *v) = ahead["q"][place], behind["q"][place]
            if a * b + sum(x * y for x, y in zip(u, v)) < 0:
                b, v = -b, [-x for x in v]
            # vector part of ahead behind*
            cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            for i in range(3):
                rotations[place + (i,)] = 2 * (b * u[i] - a * v[i] - cross[i]) / (2 * mpmath.mpf(h))
        return {name: block.astype(float) for name, block in {"rotation": rotations, **found}.items()}


def tumbling(duration: float = 2) -> polhode.Scene:
    """A body under every load with a closed description: impulse, windows, drag, spring, force, torque, gravity."""
    return polhode.scene(
        duration=duration, body=polhode.body(mass=2, inertia=[[1, 0.125, 0], [0.125, 1.5, 0.25], [0, 0.25, 2]],
                                      center_of_mass=[0.1, 0, 0.2]),
        initial=polhode.initial(angular_velocity=[0.5, 1, -0.25], velocity=[1, 0, 2], orientation=[0.8, 0, 0.6, 0],
                                position=[0, 0, 0], angular_velocity_frame="world"),
        loads=[polhode.gravity([0, 0, -9.75]),
               polhode.impulse([0.5, 0, 1], "world", [0.5, 0.25, 0], 0.75),
               polhode.drag(rotational=[0.1, 0.2, 0.1], translational=0.25),
               polhode.spring(3, from_=0.25, until=1.5),
               polhode.force([0, 1, 0], "body", [0.5, 0, 0], until=1),
               polhode.torque([0.1, 0, 0.2], "world", from_=0.5)])


CASES = [
    (tumbling, ["/body/mass", "/body/inertia/1/1", "/body/center_of_mass/2", "/initial/angular_velocity/1",
                "/initial/orientation/2", "/loads/1/vector/0", "/loads/1/point/1", "/loads/2/rotational/1",
                "/loads/3/stiffness", "/loads/5/vector/2"]),
    (lambda: polhode.scene("heavy_asymmetric_top", duration=2),
     ["/body/inertia/0", "/loads/0/acceleration/2", "/initial/angular_velocity/2"]),
    (lambda: polhode.scene("mechanisms/double_pendulum", duration=1),
     ["/bodies/1/body/mass", "/bodies/0/body/shape/half_extents/2", "/joints/1/initial/angle"]),
    (lambda: polhode.scene("mechanisms/ball_joint_arm", duration=0.25), ["/joints/1/parent_point/2"]),
    (lambda: polhode.scene("mechanisms/four_bar", duration=0.125), ["/bodies/2/body/mass"]),
    (lambda: polhode.scene("formulas/curved_ball", duration=1), ["/parameters/drag", "/body/mass", "/parameters/lift"]),
    (lambda: polhode.scene("formulas/flywheel_servo", duration=2), ["/parameters/k", "/parameters/target", "/bodies/0/body/inertia/2"]),
    (lambda: polhode.scene("formulas/saturated_regulator", duration=40),
     ["/body/inertia/0/0", "/parameters/limit", "/parameters/c", "/initial/angular_velocity/1"]),
    # no sample at the time of an event, where the derivative jumps
    (lambda: tumbling(1.875), ["/loads/1/at", "/loads/3/from", "/loads/5/from", "/loads/3/until"]),
]


@pytest.mark.parametrize("make, pointers", CASES)
def test_derivatives_are_those_of_the_truth(make: Any, pointers: list[str]) -> None:
    scene = make()
    times = [scene.duration * part for part in (0.375, 1)]
    found = polhode.sensitivity(scene, pointers, times)
    worst = 0.0
    for c, pointer in enumerate(pointers):
        for name, expected in differences(scene, pointer, times).items():
            computed = getattr(found, name)[..., c].reshape(expected.shape)
            size = max(1e-3, np.abs(expected).max())
            worst = max(worst, np.abs(computed - expected).max() / size)
            assert np.abs(computed - expected).max() < 1e-10 * size, (pointer, name)
    print(f"{scene.name}: {worst:.1e}")


def test_the_motion_is_that_of_solve() -> None:
    for scene in (tumbling(), polhode.scene("lagrange_top", duration=2), polhode.scene("mechanisms/four_bar")):
        found = polhode.sensitivity(scene, [], samples=4)
        motion = polhode.solve(scene, tolerance=1e-12, samples=4)
        assert np.abs(found.motion.p - motion.p).max() < 1e-9 and np.abs(found.motion.w - motion.w).max() < 1e-9


def test_quaternions_and_body_rates_follow() -> None:
    scene, h = tumbling(), 2.0**-16
    times = [1.0, 2.0]
    found = polhode.sensitivity(scene, ["/body/mass"], times)["/body/mass"]
    ahead, behind = (polhode.solve(with_number(scene, "/body/mass", by), times=times, tolerance=1e-13)
                     for by in (h, -h))
    assert np.abs((ahead.q - behind.q) / (2 * h) - found.q).max() < 1e-7
    assert np.abs((ahead.w_B - behind.w_B) / (2 * h) - found.w_B).max() < 1e-7


def test_more_parameters_than_a_pass_has() -> None:
    scene = tumbling()
    pointers = [f"/body/inertia/{i}/{j}" for i in range(3) for j in range(3)] + ["/body/mass", "/loads/0/acceleration/2"]
    together = polhode.sensitivity(scene, pointers, samples=3)
    alone = polhode.sensitivity(scene, pointers[-1:], samples=3)
    assert np.abs(together[pointers[-1]].p - alone[pointers[-1]].p).max() < 1e-10
    # both off-diagonal numbers change the same product of inertia
    assert np.abs(together["/body/inertia/0/1"].w - together["/body/inertia/1/0"].w).max() < 1e-10


@pytest.mark.parametrize("pointer, words", [
    ("/body/masses", "the scene has no /body/masses"), ("body/mass", "JSON pointer"), ("/body", "not a number"),
    ("/name", "not a number"),
])
def test_bad_pointers_are_refused(pointer: str, words: str) -> None:
    with pytest.raises(polhode.InputError, match=words):
        polhode.sensitivity(tumbling(), [pointer], [1.0])


def bouncing_ball(restitution: float = 0.75) -> polhode.Scene:
    return polhode.scene(duration=1, body=polhode.body(shape=polhode.sphere(0.25), mass=1),
                         initial=polhode.initial(position=[0, 0, 1.25]), loads=[polhode.gravity([0, 0, -8])],
                         planes=[polhode.plane([0, 0, 1], restitution=restitution)])


def test_a_restitution_from_the_path_of_a_ball() -> None:
    # height e g T s - g s^2 / 2 with T = 1/2 and s = t - T
    found = polhode.sensitivity(bouncing_ball(), ["/planes/0/restitution"], [0.25, 1.0])
    assert abs(found.p[0, 2, 0]) < 1e-13 and abs(found.p[1, 2, 0] - 2) < 1e-13
    times = np.linspace(0.05, 0.95, 7)
    motion = polhode.solve(bouncing_ball(), times=times, tolerance=1e-13)
    fitted = polhode.fit(bouncing_ball(0.7), motion.p[:, 2:], ["/planes/0/restitution"], ["pz"], times=times)
    assert abs(fitted.values[0] - 0.75) < 1e-11


def test_unsupported_scenes_are_refused() -> None:
    with pytest.raises(polhode.InputError, match="user-defined torques"):
        polhode.sensitivity(polhode.scene("free_asymmetric").add_torque(lambda now: -now.w_B), ["/body/mass"])
    # the impact is at t = 0.5, where a change of the height moves it
    with pytest.raises(polhode.InputError, match="no derivative"):
        polhode.sensitivity(bouncing_ball(), ["/initial/position/2"], [0.5])
    with pytest.raises(polhode.InputError, match="times"):
        polhode.sensitivity(tumbling(), ["/body/mass"], [1.0, 0.5])


def satellite() -> polhode.Scene:
    """A satellite of the size of a refrigerator, with a known torque of its wheels."""
    return polhode.scene(duration=60, body=polhode.body(mass=100, inertia=[[9, 0.5, 0.2], [0.5, 12, -0.3],
                                                                          [0.2, -0.3, 15]]),
                         initial=polhode.initial(angular_velocity=[0.05, 0.1, -0.02]),
                         loads=[polhode.torque([0.02, 0.01, -0.03], "body", from_=10, until=40)])


GYROSCOPE = ["wx_B", "wy_B", "wz_B"]
MOMENTS = ["/body/inertia/0/0", "/body/inertia/1/1", "/body/inertia/2/2"]


def test_inertia_from_a_gyroscope_within_its_error_bars() -> None:
    pytest.importorskip("scipy")
    true = satellite()
    motion = polhode.solve(true, samples=40, tolerance=1e-12)
    guess = true.copy()
    for k, value in enumerate((8, 13, 16)):
        guess.body.inertia[k][k] = value
    sigma = 1e-3
    inside = np.zeros(3)
    for seed in range(100):
        noise = sigma * np.random.default_rng(seed).standard_normal((41, 3))
        found = polhode.fit(guess, motion.w_B + noise, MOMENTS, GYROSCOPE, times=motion.t, weights=1 / sigma,
                            tolerance=1e-8)
        assert found.determined
        inside += np.abs(found.values - [9, 12, 15]) < 1.96 * found.errors
    # 95 of 100 are expected, with a standard deviation of 2.2
    assert np.all(inside >= 89) and np.all(inside <= 99), inside


def test_a_fit_without_noise_is_exact_and_reports_its_covariance() -> None:
    pytest.importorskip("scipy")
    true = satellite()
    motion = polhode.solve(true, samples=60, tolerance=1e-12)
    guess = true.copy()
    guess.body.inertia = [[8, 0, 0], [0, 13, 0], [0, 0, 16]]
    names = [*MOMENTS, "/body/inertia/0/1", "/body/inertia/0/2", "/body/inertia/1/2"]
    data = dict(zip(GYROSCOPE, motion.w_B.T), t=motion.t)
    found = polhode.fit(guess, data, names)
    assert np.abs(found.values - [9, 12, 15, 0.5, 0.2, -0.3]).max() < 1e-6
    assert found.scene.body.inertia[1][0] == found.scene.body.inertia[0][1] and found.scene.name == true.name
    assert np.abs(found.residuals).max() < 1e-8
    assert np.allclose(np.diag(found.correlation), 1) and found.covariance.shape == (6, 6)
    # the covariance is s^2 (J^T J)^-1 with the derivatives of the angular velocity
    exact = polhode.sensitivity(found.scene, names, motion.t)
    J = np.stack([exact[name].w_B.ravel() for name in names], axis=1)
    s2 = 2 * found.cost / (found.residuals.size - 6)
    assert np.allclose(found.covariance, s2 * np.linalg.inv(J.T @ J), rtol=1e-4, atol=0)


def test_undetermined_parameters_are_named() -> None:
    pytest.importorskip("scipy")
    free = polhode.scene(duration=20, body=polhode.body(mass=1, inertia=[1, 2, 2.5]),
                         initial=polhode.initial(angular_velocity=[0.5, 1, 0.2]))
    motion = polhode.solve(free, samples=20)
    moments = [f"/body/inertia/{k}" for k in range(3)]
    found = polhode.fit(free, motion.w_B, moments, GYROSCOPE, times=motion.t)
    assert not found.determined and np.isnan(found.errors).all()
    # a common factor of all moments does not change the motion of a free body
    assert "+1 * /body/inertia/0 +1 * /body/inertia/1 +1 * /body/inertia/2" in found.message
    assert "do not depend on /body/mass" in polhode.fit(free, motion.w_B, ["/body/mass"], GYROSCOPE,
                                                          times=motion.t).message
    assert polhode.fit(free, motion.w_B, moments[:2], GYROSCOPE, times=motion.t).determined


def test_a_mechanism_is_fitted() -> None:
    pytest.importorskip("scipy")
    true = polhode.scene("mechanisms/double_pendulum", duration=1)
    motion = polhode.solve(true, samples=30, tolerance=1e-12)
    guess = true.copy()
    guess.bodies[1].body.mass = 1.2
    guess.joints[1].initial.angle = 0.45
    found = polhode.fit(guess, motion["lower"].p[:, [0, 2]], ["/bodies/1/body/mass", "/joints/1/initial/angle"],
                        ["lower.px", "lower.pz"], times=motion.t)
    assert np.abs(found.values - [1, 0.5]).max() < 1e-6
    with pytest.raises(polhode.InputError, match="column"):
        polhode.fit(guess, motion["lower"].p[:, [0]], ["/bodies/1/body/mass"], ["px"], times=motion.t)


def test_bad_data_are_refused() -> None:
    pytest.importorskip("scipy")
    scene = satellite()
    with pytest.raises(polhode.InputError, match="shape"):
        polhode.fit(scene, [[1.0, 2.0]], MOMENTS, GYROSCOPE, times=[0.0])
    with pytest.raises(polhode.InputError, match="not finite"):
        polhode.fit(scene, [[1.0, 2.0, np.nan]], MOMENTS, GYROSCOPE, times=[0.0])
    with pytest.raises(polhode.InputError, match="columns and times"):
        polhode.fit(scene, [[1.0, 2.0, 3.0]], MOMENTS)
    with pytest.raises(polhode.InputError, match="no column 't'"):
        polhode.fit(scene, {"wx": [1.0]}, MOMENTS)
