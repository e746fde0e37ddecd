"""Joints, bodies by name and conversions of trajectories, compared with the program, SciPy and formulas."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import polhode
from conftest import Program

PENDULUM = "mechanisms/double_pendulum"


def test_joints_are_those_of_the_program(program: Program, tmp_path: Any) -> None:
    motion = polhode.solve(PENDULUM, samples=20)
    program("solve", PENDULUM, "--samples", "20", "--joints", str(tmp_path / "j.csv"))
    text = (tmp_path / "j.csv").read_text(encoding="utf-8")
    assert motion.joints.to_pandas().to_csv(index=False).splitlines()[0] == text.splitlines()[0]
    rows = [line.split(",") for line in text.splitlines()[1:]]
    for name in ("shoulder", "elbow"):
        mine = motion.joints[name]
        theirs = np.array([[float(a), float(b)] for _, joint, a, b in rows if joint == name])
        assert np.array_equal(mine.angle, theirs[:, 0]) and np.array_equal(mine.rate, theirs[:, 1])


def test_joints_determine_the_bodies() -> None:
    motion = polhode.solve(PENDULUM, samples=50, reactions=True)
    a = motion.joints["shoulder"].angle
    b = a + motion.joints["elbow"].angle
    # bars of 1 m hang along -z and rotate about y; the point of the lower one is the end of the upper one
    x = -np.sin(a) - np.sin(b) / 2
    z = -np.cos(a) - np.cos(b) / 2
    assert np.abs(motion["lower"].p[:, 0] - x).max() < 1e-13 and np.abs(motion["lower"].p[:, 2] - z).max() < 1e-13
    assert np.array_equal(motion["lower"].q, motion.q[:, 1])
    # Newton's law for the lower bar: the force at the elbow is that of its momentum's rate and its weight; the rate
    # is a central difference
    fine = polhode.solve(PENDULUM, times=[0.9999, 1.0, 1.0001], reactions=True)
    rate = (fine["lower"].v[2] - fine["lower"].v[0]) / 0.0002
    assert np.abs(fine.reactions("elbow")[1, :3] - rate - [0, 0, 9.81]).max() < 1e-3
    assert np.array_equal(motion.reactions("elbow"), motion.reactions[:, 1])


def test_joints_of_other_types() -> None:
    ball = polhode.solve("mechanisms/ball_joint_arm", samples=10).joints
    spherical = next(m for m in ball.values() if m.type == "spherical")
    assert spherical.q.shape == (11, 4) and spherical.angular_velocity.shape == (11, 3)
    assert np.abs(np.linalg.norm(spherical.q, axis=1) - 1).max() < 1e-14
    cart = polhode.solve("mechanisms/cart_pole_tilted", samples=10).joints
    slider = next(m for m in cart.values() if m.type == "prismatic")
    assert slider.displacement.shape == slider.speed.shape == (11,)
    with pytest.raises(AttributeError, match="a prismatic joint has no angle; it has displacement, speed"):
        slider.angle


def test_revolutions_are_counted_between_samples() -> None:
    rotor = {"duration": 2, "bodies": [{"name": "r", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
             "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "r", "axis": [0, 0, 1],
                         "initial": {"rate": 1000}}]}
    for options in ({"samples": 2}, {"times": [0.5, 1.25]}, {"samples": 2, "step": 1e-3}):
        method = "odeint_rk4" if "step" in options else "auto"
        motion = polhode.solve(rotor, method, **options)
        assert np.abs(motion.joints["j"].angle - 1000 * motion.t).max() < 1e-6
    assert motion["r"].q.shape == (3, 4) and motion.frames().shape == (3, 4, 4)


def test_names_that_do_not_exist_are_refused() -> None:
    motion = polhode.solve(PENDULUM, samples=4)
    with pytest.raises(polhode.InputError, match="no joint 'knee'; the names are shoulder, elbow"):
        motion.joints["knee"]
    with pytest.raises(polhode.InputError, match="no body 'hand'; the names are upper, lower"):
        motion["hand"]
    with pytest.raises(polhode.InputError, match="reactions=True"):
        motion.reactions("elbow")
    with pytest.raises(polhode.InputError, match="one body"):
        polhode.solve("free_asymmetric", samples=4)["body"]
    assert "knee" not in motion.joints and len(polhode.solve("free_asymmetric", samples=4).joints) == 0


def test_frames_map_points() -> None:
    motion = polhode.solve(PENDULUM, samples=20)
    frames = motion.frames()
    # the elbow: 0.5 m below the upper bar's origin, 0.5 m above the lower one's
    below, above = np.array([0, 0, -0.5, 1]), np.array([0, 0, 0.5, 1])
    assert np.abs(frames[:, 0] @ below - frames[:, 1] @ above).max() < 1e-13
    # a displaced centre of mass: about a pivot, the origin is at rest
    top = polhode.solve("lagrange_top", samples=20)
    assert np.abs(top.p).max() > 0.1
    assert np.abs(top.frames()[:, :3, 3]).max() < 1e-12
    assert np.array_equal(top.frames("center_of_mass")[:, :3, 3], top.p)
    with pytest.raises(polhode.InputError, match="center_of_mass"):
        top.frames("pivot")


def test_attitudes_are_those_of_scipy() -> None:
    pytest.importorskip("scipy")
    from scipy.spatial.transform import Rotation

    motion = polhode.solve("heavy_asymmetric_top", samples=200)
    rotations = motion.rotations()
    assert np.abs(motion.matrices() - rotations.as_matrix()).max() < 1e-14
    assert np.abs(motion.rotation_vectors() - rotations.as_rotvec()).max() < 1e-13
    for axes in itertools.product("xyz", repeat=3):
        sequence = "".join(axes)
        if axes[0] == axes[1] or axes[1] == axes[2]:
            continue
        for named in (sequence, sequence.upper()):
            angles = motion.euler(named)
            # the same rotation, and the same angles away from the singular middle angle
            assert (Rotation.from_euler(named, angles) * rotations.inv()).magnitude().max() < 1e-7, named
            regular = np.abs(np.sin(angles[:, 1]) if axes[0] == axes[2] else np.cos(angles[:, 1])) > 1e-2
            difference = angles - rotations.as_euler(named)
            assert np.abs(np.sin(difference[regular] / 2)).max() < 1e-12, named
    assert np.allclose(np.degrees(motion.euler("yaw-pitch-roll")), motion.euler("ZYX", degrees=True))
    with pytest.raises(polhode.InputError, match="Euler"):
        motion.euler("xXz")


@pytest.mark.parametrize("named", ["ZYX", "xyz", "ZXZ", "zxz"])
def test_singular_euler_angles(named: str) -> None:
    Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    middle = [np.pi / 2, -np.pi / 2] if len(set(named)) == 3 else [0, np.pi]
    for angle in middle:
        q = np.roll(Rotation.from_euler(named, [0.7, angle, 0.2]).as_quat(), 1)
        back = polhode.trajectory("free_asymmetric", [0.0], [q]).euler(named)[0]
        assert (Rotation.from_euler(named, back).as_matrix() @
                Rotation.from_euler(named, [0.7, angle, 0.2]).as_matrix().T) == pytest.approx(np.eye(3), abs=1e-7)
        assert back[2] == 0


def test_tables() -> None:
    pytest.importorskip("pandas")
    motion = polhode.solve(PENDULUM, samples=10)
    table = motion.to_pandas()
    header, first = motion.csv().splitlines()[:2]
    assert list(table.columns) == header.split(",")
    assert [str(value) for value in table.iloc[0, :2]] == ["0.0", "upper"]
    assert [float(value) for value in first.split(",")[2:]] == list(table.iloc[0, 2:])
    assert list(motion["lower"].to_pandas().columns) == [name for name in table.columns if name != "body"]
    assert list(polhode.solve("free_asymmetric", samples=2).to_pandas().columns)[:2] == ["t", "qw"]


def test_labelled_arrays() -> None:
    motion = polhode.solve(PENDULUM, samples=10)
    try:
        import xarray
    except ImportError:
        with pytest.raises(ImportError, match="to_pandas"):
            motion.to_xarray()
        return
    data = motion.to_xarray()
    assert isinstance(data, xarray.Dataset)
    assert np.array_equal(data.p.sel(body="lower", axis="x"), motion["lower"].p[:, 0])
    assert data.q.dims == ("t", "body", "quaternion")
