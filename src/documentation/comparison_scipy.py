"""Solves a free asymmetric body and Lagrange's top with SciPy's solve_ivp; compares with the truth of polhode."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Vector = NDArray[np.float64]


def rates(moments: tuple[float, float, float], weight: float) -> Callable[[float, Vector], tuple[float, ...]]:
    """Returns the right-hand side for y = (w, q): Euler's equations in body axes. `weight` is m g l."""
    I1, I2, I3 = moments

    def derivative(t: float, y: Vector) -> tuple[float, ...]:
        w1, w2, w3, qw, qx, qy, qz = y
        up1, up2 = 2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx)  # the vertical in body axes
        return (
            ((I2 - I3) * w2 * w3 + weight * up2) / I1,
            ((I3 - I1) * w3 * w1 - weight * up1) / I2,
            (I1 - I2) * w1 * w2 / I3,
            -(qx * w1 + qy * w2 + qz * w3) / 2,
            (qw * w1 + qy * w3 - qz * w2) / 2,
            (qw * w2 + qz * w1 - qx * w3) / 2,
            (qw * w3 + qx * w2 - qy * w1) / 2,
        )

    return derivative


def angle(p: Vector, q: Vector) -> float:
    """Returns the angle (rad) between two attitudes; p and q need not be normalised."""
    vector = p[0] * q[1:] - q[0] * p[1:] - np.cross(p[1:], q[1:])
    return float(2 * np.arctan2(np.linalg.norm(vector), abs(p @ q)))


SCENES = {  # moments, m g l, initial (w, q), end (s), and q at the end by `polhode truth`
    "free_asymmetric": (
        (1, 2, 3), 0, (1, 1, 1, 1, 0, 0, 0), 100,
        (-0.7543620159814325776, 0.6111927854801947043, -0.1860544358049817802, -0.1508809952866147802),
    ),
    "lagrange_top": (
        (1, 1, 0.5), 5, (0, 0, 20, 0.9689124217106447, 0.24740395925452294, 0, 0), 20,
        (0.9216743465845293629, -0.05110036213405188677, -0.2422340545694777346, -0.2987102519910906679),
    ),
}  # fmt: skip

print(f"{'scene':16} {'rtol':>6} {'evaluations':>12} {'seconds':>8} {'attitude error (rad)':>21}")
for scene, (moments, weight, start, end, truth) in SCENES.items():
    for rtol in (1e-6, 1e-9, 1e-12):
        begin = time.perf_counter()
        motion = solve_ivp(rates(moments, weight), (0, end), start, method="DOP853", rtol=rtol, atol=rtol)
        seconds = time.perf_counter() - begin
        error = angle(np.array(truth), motion.y[3:, -1])
        print(f"{scene:16} {rtol:6.0e} {motion.nfev:12} {seconds:8.2f} {error:21.1e}")
